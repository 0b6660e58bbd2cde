"""Unit normals of an attribute, relative to those of the decoded surface."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes.domains import Places
from deltamesh._attributes.element_normals import Surroundings
from deltamesh._attributes.unit_normals import Normals, decode_normals, smallest, values_of
from deltamesh._graph.elements import Elements
from deltamesh_formats.container.attribute_table import Entry
from deltamesh_formats.errors import FormatError, located

_Ints = NDArray[np.int64]
_Floats = NDArray[np.float64]
_Any = NDArray[Any]


def surroundings(entry: Entry, units: _Ints, count: int, places: Places) -> Surroundings:
    """Return the polygons around units.

    Parameters
    ----------
    entry : Entry
    units : int64
        Of the elements of the domain.
    count : int
        Number of units.
    places : Places
    """
    vertices = places.structure.faces.ravel()[places.polygons.corners]
    at_corners = {"vertex": vertices, "corner": units, "face": places.face_of_corners}
    return Surroundings(vertices, places.polygons.offsets, at_corners[entry.domain], count)


def encode_directions(
    entry: Entry,
    values: _Any,
    has: NDArray[np.bool_],
    elements: Elements,
    around: Surroundings,
    V: _Floats,
    tolerance: float,
) -> tuple[Entry, Normals, bytes]:
    """Return the entry with its largest error, the normals as they are coded, and their stream.

    Parameters
    ----------
    entry : Entry
    values : (values, 3)
        Of the units that have one.
    has : bool (units,)
    elements : Elements
    around : Surroundings
    V : float64 (n, 3)
        Decoded positions.
    tolerance : float
        How far apart the positions of two decoders may be.
    """
    dense = np.zeros((elements.count, 3))
    dense[has] = values
    normals, stream = smallest(dense, V, around, elements, entry.bits, tolerance)
    found = values_of(normals, V, around).astype(entry.dtype)[has]
    return replace(entry, error=_largest_angle(values, found)), normals, stream


def _largest_angle(a: _Any, b: _Any) -> float:
    """Return the largest angle between vectors (k, 3), in degrees; none to a vector of zeros."""
    a, b = a.astype(np.float64), b.astype(np.float64)
    sine = np.linalg.norm(np.cross(a, b), axis=1)
    return float(np.degrees(np.arctan2(sine, (a * b).sum(axis=1))).max(initial=0.0))


def decode_directions(
    payload: memoryview, stream: tuple[int, int], entry: Entry, elements: Elements
) -> Normals:
    """Return the normals as they are coded.

    Raises
    ------
    FormatError
    """
    begin, end = stream
    with located(begin):
        normals = decode_normals(payload[begin:end], elements)
    if normals.bits != entry.bits:
        raise FormatError(f"normals of {normals.bits} bits, not {entry.bits}", begin)
    return normals
