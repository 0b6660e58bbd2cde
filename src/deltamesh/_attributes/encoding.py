"""Attributes to the payload of ATTR; the mirror is `deltamesh._attributes.decoding`.

An attribute is coded in every way that fits what it is, and the smallest is kept.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes import numbers
from deltamesh._attributes.coded import Coded
from deltamesh._attributes.codings import Wanted, ways_of
from deltamesh._attributes.directions import encode_directions, surroundings
from deltamesh._attributes.domains import Places
from deltamesh._attributes.owners import Units, encode_units
from deltamesh._graph.elements import Elements, alone, among
from deltamesh._graph.permutations import numbered
from deltamesh._shape.provenance import Provenance
from deltamesh._streams.columns import encode_columns
from deltamesh._streams.floats import encode_floats
from deltamesh._streams.labels import encode_labels
from deltamesh_formats.container.attribute_table import Entry, write_table
from deltamesh_formats.polymesh.mesh import PolyMesh

_Ints = NDArray[np.int64]
_Any = NDArray[Any]

# A palette is tried where there are not more different rows, and at most one for so many of all.
_MOST_DIFFERENT: Final = 4096
_EACH: Final = 4


# Any bits may be numbers, those of a signalling NaN too.
@np.errstate(over="ignore", invalid="ignore")
def encode_attributes(
    mesh: PolyMesh, provenance: Provenance, places: Places, wanted: Wanted
) -> tuple[bytes, tuple[Coded, ...]]:
    """Return the payload of ATTR, and what is in it.

    Parameters
    ----------
    mesh : PolyMesh
        With attributes.
    provenance : Provenance
        Of the elements of the file.
    places : Places
    wanted : Wanted
    """
    p = provenance
    came_from = {"vertex": p.vertices, "corner": p.corners, "face": p.polygons}
    coded: list[Coded] = []
    streams: list[bytes] = []
    for attribute in mesh.attributes:
        used, rows = _used(attribute.rows()[came_from[attribute.domain]])
        values = _native(attribute.values[used])
        ways = (
            _encoded(way, values, rows, places, wanted, coded)
            for way in ways_of(attribute, values, wanted)
        )
        one, parts = min(ways, key=lambda way: way[0].entry.size)
        coded.append(one)
        streams += parts
    return write_table(tuple(one.entry for one in coded)) + b"".join(streams), tuple(coded)


def _used(rows: _Ints) -> tuple[_Ints, _Ints]:
    """Return the rows that are used, and which of these each element has, -1 for none."""
    used, compact = np.unique(rows, return_inverse=True)
    nothing = int(len(used) > 0 and used[0] < 0)
    return used[nothing:], compact - nothing


def _native(values: _Any) -> _Any:
    return np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("="))


def _encoded(
    entry: Entry,
    values: _Any,
    rows: _Ints,
    places: Places,
    wanted: Wanted,
    before: Sequence[Coded],
) -> tuple[Coded, list[bytes]]:
    """Return an attribute that is coded so, and its streams.

    rows : int64 (count,), into `values`, -1 for none.
    """
    codes = numbers.to_codes(entry, values)
    first, ids = _different(codes)
    same = np.append(first[ids], -1)[rows]  # the first row with the same codes
    units = encode_units(entry, same, places, before)
    of_units = np.empty(units.elements.count, dtype=np.int64)
    of_units[units.of_elements] = same
    has, streams = of_units >= 0, units.streams
    entry = replace(entry, classes=units.reference)
    if not has.all():
        streams = [*streams, encode_labels(units.elements, numbered(has.astype(np.int64))[0])]
        entry = replace(entry, partly=True, first_none=not has[0])
    if entry.coding == "octahedral":
        one, rest = _directions(entry, values[of_units[has]], has, units, places, wanted)
    else:
        one, rest = _rows(entry, codes, of_units[has], has, units)
    streams = [*streams, *rest]
    entry = replace(one.entry, sizes=tuple(map(len, streams)))
    return replace(one, entry=entry), streams


def _different(codes: _Ints) -> tuple[_Ints, _Ints]:
    """Return the first of the different rows of codes (r, c), and which of these each is."""
    if not codes.size:
        return np.zeros(min(len(codes), 1), np.int64), np.zeros(len(codes), np.int64)
    keys = np.ascontiguousarray(codes).view(f"V{codes.shape[1] * 8}").ravel()
    _, first, ids = np.unique(keys, return_index=True, return_inverse=True)
    return first, ids


def _directions(
    entry: Entry,
    values: _Any,
    has: NDArray[np.bool_],
    units: Units,
    places: Places,
    wanted: Wanted,
) -> tuple[Coded, list[bytes]]:
    """Return unit normals, those (k, 3) of the units that have one, and their stream."""
    around = surroundings(entry, units.of_elements, len(has), places)
    V, tolerance = wanted.positions, wanted.tolerance
    entry, normals, stream = encode_directions(
        entry, values, has, units.elements, around, V, tolerance
    )
    rows = np.flatnonzero(has)
    one = Coded(entry, units.of_elements, units.classes, has, rows, normals.codes, normals)
    return one, [stream]


def _rows(
    entry: Entry, codes: _Ints, chosen: _Ints, has: NDArray[np.bool_], units: Units
) -> tuple[Coded, list[bytes]]:
    """Return the rows that are chosen of codes, and their streams: by a palette, if smaller."""
    near = among(units.elements, has)
    streams, labels, rows = _streams(entry, codes[chosen], near), np.arange(near.count), chosen
    named, order = numbered(chosen)
    if 0 < len(order) <= min(_MOST_DIFFERENT, len(chosen) // _EACH + 1):
        palette = _streams(entry, codes[order], alone(len(order)))
        other = [encode_labels(near, named), *palette]
        if sum(map(len, other)) < sum(map(len, streams)):
            streams, labels, rows = other, named, order
            entry = replace(entry, palette=len(order))
    return Coded(entry, units.of_elements, units.classes, has, labels, codes[rows]), streams


def _streams(entry: Entry, codes: _Ints, elements: Elements) -> list[bytes]:
    """Return the streams of the rows (n, c) of elements."""
    if entry.coding == "exact":
        return encode_floats(elements, codes, entry.number_size)
    return encode_columns(elements, numbers.mixed(codes) if entry.mixed else codes)
