"""Entries of the table of attributes: what is coded of each, by which rules; SPEC.md 5.14."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from deltamesh_formats.container.payload_layout import (
    MAX_LIMB_BITS,
    MAX_NORMAL_BITS,
    MIN_NORMAL_BITS,
    OWN_WEDGES,
    WEDGES_OF,
    Coding,
)
from deltamesh_formats.polymesh.mesh import Domain, Role

# Kinds of numpy types that each coding is for.
_FITTING: Final = {"integer": "bui", "exact": "fc", "grid": "f", "octahedral": "f"}


@dataclass(frozen=True)
class Entry:
    """One attribute of a file.

    Attributes
    ----------
    name : str
    domain, role, normalized
        As those of an `Attribute`.
    dtype : numpy dtype, in the byte order of the machine
    width : int
        Numbers a row.
    coding : {"integer", "exact", "grid", "octahedral"}
    partly : bool
        Whether there are owners (vertices, polygons or wedges) without a value.
    first_none : bool
        Whether the first of them has none.
    palette : int or None
        Number of different rows, where each owner names one of these.
    mixed : bool
        Whether the second column is taken from the first and the third.
    wedges : int
        Of an attribute of corners, the owners of its values: wedges of its own (OWN_WEDGES),
        polygons (POLYGON_OWNERS), or the wedges of attribute k (k + WEDGES_OF).
    origin : tuple
        Of integers, one number; of a grid, one a column.
    bits : int
        Of integers, those of a limb; of a grid what was asked for, or 0; of normals, those of each
        of both coordinates.
    limbs : int
        Columns that a column of integers is cut into.
    density : float
        Grid points a unit.
    error : float
        The largest difference between a number and what becomes of it; of normals, the largest
        angle, in degrees.
    sizes : tuple of int
        Bytes of each stream: of the wedges, of the owners that have a value, of their rows in the
        palette, each if it is there; then of every three columns.
    """

    name: str
    domain: Domain
    role: Role
    dtype: np.dtype[Any]
    width: int
    normalized: bool
    coding: Coding
    partly: bool = False
    first_none: bool = False
    palette: int | None = None
    mixed: bool = False
    wedges: int = OWN_WEDGES
    origin: tuple[float, ...] = ()
    bits: int = 0
    limbs: int = 1
    density: float = 0.0
    error: float = 0.0
    sizes: tuple[int, ...] = ()

    @property
    def numbers(self) -> int:
        """Real numbers a row."""
        return self.width * (2 if self.dtype.kind == "c" else 1)

    @property
    def number_size(self) -> int:
        """Bytes of a real number."""
        return self.dtype.itemsize // (2 if self.dtype.kind == "c" else 1)

    @property
    def columns(self) -> int:
        """Columns that are coded."""
        if self.coding == "octahedral":
            return 3
        return self.numbers * (self.limbs if self.coding == "integer" else 1)

    @property
    def streams(self) -> int:
        """Number of streams."""
        own = self.domain == "corner" and self.wedges == OWN_WEDGES
        return own + self.partly + (self.palette is not None) + -(-self.columns // 3)

    @property
    def size(self) -> int:
        """Bytes of all streams."""
        return sum(self.sizes)


def fault_of(e: Entry) -> str:
    """Return the fault of an entry by the rules of SPEC.md 5.14; "" if it has none."""
    if e.dtype.kind not in _FITTING[e.coding]:
        return f"type {e.dtype} with coding {e.coding}"
    if e.mixed and (e.coding not in ("integer", "grid") or e.width < 3 or e.limbs > 1):
        return f"mixed columns with coding {e.coding}, width {e.width} and {e.limbs} limbs"
    if e.coding == "integer":
        fits = 1 <= e.bits <= MAX_LIMB_BITS and 1 <= e.limbs <= -(-64 // e.bits)
        return "" if fits else f"{e.limbs} limbs of {e.bits} bits"
    if e.coding == "octahedral":
        if e.width != 3:
            return f"octahedral coding with width {e.width}"
        if e.palette is not None:
            return "octahedral coding with a palette"
        if not MIN_NORMAL_BITS <= e.bits <= MAX_NORMAL_BITS:
            return f"normals of {e.bits} bits"
    for field, values in (("error", (e.error,)), ("density", (e.density,)), ("origin", e.origin)):
        for value in values:
            if not math.isfinite(value) or (field == "error" and value < 0):
                return f"{field} {value}"
    if e.coding == "grid" and not e.density > 0:
        return f"density {e.density}"
    return ""


def fault_of_owners(e: Entry, before: Sequence[Entry]) -> str:
    """Return the fault of what an entry says of owners, after other entries; "" if it has none."""
    if e.palette == 0:
        return "empty palette"
    if e.first_none and not e.partly:
        return "first_none without partly"
    if e.domain != "corner" or e.wedges < WEDGES_OF:
        return ""
    other = e.wedges - WEDGES_OF
    if other >= len(before):
        return f"wedges of attribute {other}, which does not come before it"
    if before[other].domain != "corner" or before[other].wedges != OWN_WEDGES:
        return f"wedges of attribute {other}, which has none of its own"
    return ""
