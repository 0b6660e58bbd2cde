"""Printed output of the commands: JSON for programs, plain tables for people, and messages."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import click

from deltamesh_formats.printing import number, printable, table

__all__ = ["display_name", "duration", "message", "messages_by", "number", "print_json", "table"]


def _echo(text: str) -> None:
    click.echo(text, err=True)


_print_message: Callable[[str], None] = _echo


def message(text: str) -> None:
    """Print a message on standard error, on a line of its own above whatever is drawn there."""
    _print_message(text)


@contextmanager
def messages_by(print_message: Callable[[str], None]) -> Iterator[None]:
    """Print messages by this function inside: something is drawn on standard error."""
    global _print_message
    before, _print_message = _print_message, print_message
    try:
        yield
    finally:
        _print_message = before


def duration(seconds: float) -> str:
    """Return a time in words, such as 19 s, 3 min 20 s or 2 h 5 min."""
    whole = round(seconds)
    minutes, hours = whole // 60, whole // 3600
    if hours:
        return f"{hours} h {minutes % 60} min"
    return f"{minutes} min {whole % 60} s" if minutes else f"{whole} s"


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
