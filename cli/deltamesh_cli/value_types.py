"""Types of the values of options: each reads a text, or refuses it with a usage error."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import click

from deltamesh._options import MAX_COARSE
from deltamesh_formats.polymesh.units import SYMBOLS

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

_UNITS: Final = {"": 0, "K": 1, "M": 2, "G": 3, "T": 4}
# The unit of a length that is a share of the diagonal of the bounding box.
SHARE: Final = "%"
_LENGTH: Final = re.compile(r"([0-9.]+(?:[eE][+-]?[0-9]+)?)\s*(\D*)")
_SIZE: Final = re.compile(r"(\d+(?:\.\d+)?)\s*([KMGT]?)(?:i?B)?", re.IGNORECASE)


def size(text: str) -> int:
    """Read a number of bytes: 1000000, 512M, 8G, 1.5GiB; K, M, G, T are powers of 1024."""
    match = _SIZE.fullmatch(text.strip())
    if match is None:
        raise click.BadParameter(f"{text!r} is not a size, such as 512M or 8G.")
    return int(float(match[1]) * 1024 ** _UNITS[match[2].upper()])


def anchor_count(text: str) -> int | float:
    """Read a number of anchors (int) or their fraction of the vertices (float)."""
    if text.isascii() and text.isdigit() and int(text) > 0:
        return int(text)
    if not 0 < (value := _real(text)) < 1:
        raise click.BadParameter(
            f"{text!r} is neither a count, such as 100, nor a fraction below 1, such as 0.001."
        )
    return value


def positive(text: str) -> float:
    """Read a finite number greater than zero."""
    if not 0 < (value := _real(text)) < math.inf:
        raise click.BadParameter(f"{text!r} is not a positive number.")
    return value


class Length(NamedTuple):
    """A length with a unit of its own, or a share in percent; a tuple, so that JSON can hold it."""

    value: float
    unit: str

    def __str__(self) -> str:
        """Return the length as it is on the command line."""
        return f"{self.value:.15g}{self.unit}"


def length(text: str) -> float | Length:
    """Read a positive length: a bare number, or one with a unit, such as 0.05mm."""
    return _length(text, tuple(SYMBOLS))


def length_or_share(text: str) -> float | Length:
    """Read a positive length, or a share of the diagonal of the bounding box, such as 0.1%."""
    return _length(text, (*SYMBOLS, SHARE))


def _length(text: str, units: tuple[str, ...]) -> float | Length:
    match = _LENGTH.fullmatch(text.strip())
    if match is None or not 0 < (value := _real(match[1])) < math.inf:
        raise click.BadParameter(f"{text!r} is not a positive length, such as 0.05 or 0.05mm.")
    if match[2] and match[2] not in units:
        raise click.BadParameter(f"{match[2]!r} is not one of the units {', '.join(units)}.")
    return Length(value, match[2]) if match[2] else value


def positive_share(text: str) -> float:
    """Read a fraction greater than zero, such as 0.001 or 0.1%."""
    if not (value := fraction(text)) > 0:
        raise click.BadParameter(f"{text!r} is not a fraction above 0, such as 0.001 or 0.1%.")
    return value


def named_error(text: str) -> tuple[str, float]:
    """Read a name and a positive number, such as confidence=0.01."""
    name, equals, error = text.rpartition("=")
    if not (name and equals):
        raise click.BadParameter(f"{text!r} is not NAME=E, such as confidence=0.01.")
    return name, positive(error)


def coarse_factor(text: str) -> float:
    """Read a number from 1 to `MAX_COARSE`."""
    if not 1 <= (value := _real(text)) <= MAX_COARSE:
        raise click.BadParameter(f"{text!r} is not a number from 1 to {MAX_COARSE:g}.")
    return value


def _real(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def whole(low: int, high: float = math.inf) -> Callable[[str], int]:
    """Return a reader of whole numbers from `low` to `high`."""

    def read(text: str) -> int:
        if not (text.isascii() and text.isdigit() and low <= int(text) <= high):
            limits = f"from {low}" if high == math.inf else f"from {low} to {high}"
            raise click.BadParameter(f"{text!r} is not a whole number {limits}.")
        return int(text)

    return read


def fraction(text: str) -> float:
    """Read a fraction that is not negative, such as 0.5% or 0.005."""
    number, percent, rest = text.strip().partition("%")
    value = _real(number) / (100 if percent else 1)
    if rest or not 0 <= value < math.inf:
        raise click.BadParameter(f"{text!r} is not a fraction, such as 0.5% or 0.005.")
    return value


def comma_separated(read_one: Callable[[str], Any]) -> Callable[[str], tuple[Any, ...]]:
    """Return a reader of one or more values that are separated by commas."""

    def read(text: str) -> tuple[Any, ...]:
        return tuple(read_one(part.strip()) for part in text.split(","))

    return read


class PathType(click.types.StringParamType):
    """A path: any text is valid, and a shell completes it from the names that exist.

    Parameters
    ----------
    kind : {"file", "dir"}
    """

    name = "path"

    def __init__(self, kind: str) -> None:
        self.kind = kind

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Leave the completion to the shell."""
        from click.shell_completion import CompletionItem  # for shells alone

        return [CompletionItem(incomplete, type=self.kind)]


FILE: Final = PathType("file")
FOLDER: Final = PathType("dir")
