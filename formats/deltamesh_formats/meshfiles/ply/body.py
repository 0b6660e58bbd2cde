"""Body of a PLY as a row of cells: numbers if it is text, else bytes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.caching import cached_property
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles import text


@dataclass(frozen=True)
class Binary:
    """Binary body in one byte order, "<" or ">"; a cell is a byte."""

    data: bytes
    order: str
    unit: str = "bytes"

    @cached_property
    def cells(self) -> NDArray[np.uint8]:
        """The bytes, uint8."""
        return np.frombuffer(self.data, dtype=np.uint8)

    def width(self, kind: str) -> int:
        """Return the number of cells of a number of a type."""
        return int(kind[1])

    def whole(self, at: int, kind: str) -> int:
        """Return the whole number at a cell."""
        raw = self.data[at : at + int(kind[1])]
        order = "little" if self.order == "<" else "big"
        return int.from_bytes(raw, order, signed=kind[0] == "i")  # type: ignore[arg-type]

    def counts(self, at: Ints, kind: str) -> Ints:
        """Return the counts at cells, -1 for a number that is none."""
        width = int(kind[1])
        raw = self.cells[at[:, None] + np.arange(width)]
        found = raw.view(self.order + kind).ravel()
        fits = (found >= 0) & (found <= len(self.cells))
        counts: Ints = np.where(fits, found, 0).astype(np.int64) - ~fits
        return counts

    def typed(self, block: NDArray[Any], at: Ints, kind: str) -> NDArray[Any]:
        """Return cells, (records, cells), as numbers, (records, numbers)."""
        raw = np.ascontiguousarray(block).view(self.order + kind)
        return raw.astype(kind)

    def error(self, at: int, message: str) -> MeshError:
        """Return an error about the record that begins at a cell."""
        return MeshError(f"{message} (at byte {at} of its body)")


@dataclass(frozen=True)
class Ascii:
    """Text body; a cell is a number. Integers of 64 bits are read from the text again."""

    lines: text.Lines
    unit: str = "numbers"

    @cached_property
    def cells(self) -> Floats:
        """The numbers, float64."""
        tokens = np.arange(len(self.lines.token_starts))
        found: Floats = text.read_numbers(self.lines.buffer, self.lines, tokens)
        return found

    def width(self, kind: str) -> int:
        """Return the number of cells of a number of a type."""
        return 1

    def whole(self, at: int, kind: str) -> int:
        """Return the whole number at a cell."""
        value = float(self.cells[at])
        if not value.is_integer():
            raise self.error(at, f"{value} is not a count")
        return int(value)

    def counts(self, at: Ints, kind: str) -> Ints:
        """Return the counts at cells, -1 for a number that is none."""
        found = self.cells[at]
        fits = (found >= 0) & (found <= len(self.cells)) & (np.floor(found) == found)
        return np.where(fits, found, -1).astype(np.int64)

    def typed(self, block: NDArray[Any], at: Ints, kind: str) -> NDArray[Any]:
        """Return cells as numbers of a type; those that it cannot hold are refused."""
        if kind[0] == "f":
            with np.errstate(over="ignore"):
                return block.astype(kind)
        if kind[1] == "8":
            tokens = (at[:, None] + np.arange(block.shape[1])).ravel().tolist()
            exact = [self._integer(i) for i in tokens]
            return np.array(exact, dtype=kind).reshape(block.shape)
        limits = np.iinfo(kind)
        bad = ~((block >= limits.min) & (block <= limits.max) & (np.floor(block) == block))
        if bad.any():
            i, j = np.unravel_index(np.argmax(bad), bad.shape)
            token = int(at[i]) + int(j)
            name = f"{8 * limits.dtype.itemsize} bits, {'' if kind[0] == 'i' else 'un'}signed"
            what = text.quoted(self.lines.token(token))
            raise self.error(token, f"{what} is not a whole number of {name}")
        return block.astype(kind)

    def _integer(self, token: int) -> int:
        try:
            return int(self.lines.token(token))
        except ValueError:
            what = text.quoted(self.lines.token(token))
            raise self.error(token, f"{what} is not a whole number") from None

    def error(self, at: int, message: str) -> MeshError:
        """Return an error about a cell, which names the line."""
        at = min(at, len(self.lines.token_starts) - 1)
        line = self.lines.number(int(self.lines.token_starts[at])) if at >= 0 else 1
        return MeshError(f"line {line}: {message}")
