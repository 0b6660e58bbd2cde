"""The ways in which an attribute may be coded, by what its numbers are and what they mean."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes.numbers import colour_entry, grid_entry, integer_entries, is_lossless
from deltamesh._attributes.octahedral import is_unit
from deltamesh_formats.container.attribute_table import Entry
from deltamesh_formats.polymesh.mesh import Attribute

_Any = NDArray[Any]


@dataclass(frozen=True)
class Wanted:
    """How attributes are to be coded, and what of the mesh they are coded with.

    Attributes
    ----------
    bits_uv : int
        Of the largest extent of texture coordinates.
    bits_normal : int
        Of each of both coordinates of a normal.
    lossless : bool
        Whether every number is to come back bit for bit.
    positions : float64 (n, 3)
        Of the vertices, as a decoder makes them.
    tolerance : float
        How far apart those of two decoders may be.
    """

    bits_uv: int
    bits_normal: int
    lossless: bool
    positions: NDArray[np.float64]
    tolerance: float


def ways_of(attribute: Attribute, values: _Any, wanted: Wanted) -> Iterator[Entry]:
    """Yield the ways in which the values (r, width) of an attribute may be coded.

    There is at least one that loses nothing. Texture coordinates and unit normals, and colours
    within 0 .. 1, may lose something; nobody knows what others are good for.
    """
    a = attribute
    entry = Entry(a.name, a.domain, a.role, values.dtype, a.width, a.normalized, "exact")
    colours = a.role == "colour" and a.width >= 3
    for way in _ways(entry, values, wanted):
        yield way
        if colours and way.coding in ("integer", "grid") and way.limbs == 1:
            yield replace(way, mixed=True)


def _ways(entry: Entry, values: _Any, wanted: Wanted) -> Iterator[Entry]:
    if values.dtype.kind in "bui":
        yield from integer_entries(entry, values)
        return
    yield entry
    if values.dtype.kind == "c" or not values.size:
        return
    if entry.role == "colour":
        levels = colour_entry(entry, values)
        if levels is not None and (not wanted.lossless or is_lossless(levels, values)):
            yield levels
    if entry.role == "uv" and not wanted.lossless:
        grid = grid_entry(entry, values, wanted.bits_uv)
        if grid is not None:
            yield grid
    if entry.role == "normal" and not wanted.lossless and is_unit(values):
        yield replace(entry, coding="octahedral", bits=wanted.bits_normal)
