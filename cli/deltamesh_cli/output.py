"""What the commands print: JSON for programs, plain tables for people."""

from __future__ import annotations

import json
import math

import click

from deltamesh_formats.printing import number, printable, table

__all__ = ["number", "print_json", "shown", "table"]


def shown(name: str) -> str:
    """Return a file name fit for a message: one line, no control characters."""
    return "standard input" if name == "-" else printable(name)


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
