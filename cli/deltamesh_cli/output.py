"""What the commands print: JSON for programs, plain tables for people."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence

import click


def shown(name: str) -> str:
    """Return a file name fit for a message: one line, no control characters."""
    if name == "-":
        return "standard input"
    return name if name.isprintable() else ascii(name)[1:-1]


def _plain(value: object) -> object:
    """Replace what JSON has no word for: a number that is not finite becomes null."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value


def print_json(value: dict[str, object]) -> None:
    """Print one object on one line of standard output (JSON Lines when there are several)."""
    click.echo(json.dumps(_plain(value), allow_nan=False))


def number(value: float) -> str:
    """Return a measured number with four significant digits."""
    return f"{value:.4g}"


def table(rows: Iterable[Sequence[str]], indent: str = "  ") -> str:
    """Return rows as aligned columns: the first to the left, all others to the right."""
    cells = [list(row) for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join((indent + "  ".join(_aligned(row, widths))).rstrip() for row in cells)


def _aligned(row: Sequence[str], widths: Sequence[int]) -> list[str]:
    first = row[0].ljust(widths[0])
    return [first, *(cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True))]
