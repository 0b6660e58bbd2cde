"""Printed output of the commands: JSON for programs, plain tables for people."""

from __future__ import annotations

import math

import click

from deltamesh_formats.printing import number, printable, table

__all__ = ["display_name", "number", "print_json", "table"]


def display_name(name: str) -> str:
    """Return a file name that is safe in a message: one line without control characters."""
    return "standard input" if name == "-" else printable(name)


def _finite(value: object) -> object:
    """Replace numbers that are not finite, which JSON cannot express, by null."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return value


def print_json(value: dict[str, object]) -> None:
    """Print one object on one line of standard output; several make JSON Lines."""
    import json  # which tables do without

    click.echo(json.dumps(_finite(value), allow_nan=False))
