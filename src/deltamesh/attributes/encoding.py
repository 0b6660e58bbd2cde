"""Attributes to the payload of ATTR; the mirror is `deltamesh.attributes.decoding`.

An attribute is coded in every way that fits what it is, and the smallest is kept.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh.attributes import numbers
from deltamesh.attributes.coded import Coded
from deltamesh.attributes.columns import encode_columns
from deltamesh.attributes.floats import encode_floats
from deltamesh.attributes.places import Places, alone, among, of_classes
from deltamesh.attributes.seams import encode_classes
from deltamesh.elements import Elements
from deltamesh.labels import encode_labels, numbered
from deltamesh.polygons import Sources
from deltamesh_formats.attribute_table import FACES, OWN_CLASSES, TYPES, Entry, write_table
from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh import Attribute, PolyMesh

_Ints = NDArray[np.int64]
_Any = NDArray[Any]

# A palette is tried where there are fewer different rows than that, and these few of all.
_MOST_COLOURS: Final = 4096
_FEW: Final = 4


@dataclass(frozen=True)
class Wanted:
    """How attributes are to be coded.

    Attributes
    ----------
    bits_uv, bits_normal : int
    lossless : bool
    """

    bits_uv: int
    bits_normal: int
    lossless: bool


@dataclass(frozen=True)
class _Units:
    """What the values of an attribute belong to, and the stream of it."""

    classes: int
    of_elements: _Ints
    of_corners: _Ints | None
    elements: Elements
    stream: bytes | None


# Any bits may be numbers, those of a signalling NaN too.
@np.errstate(over="ignore", invalid="ignore")
def encode_attributes(
    mesh: PolyMesh, sources: Sources, places: Places, wanted: Wanted
) -> tuple[bytes, tuple[Coded, ...]]:
    """Return the payload of ATTR, and what is in it.

    Parameters
    ----------
    mesh : PolyMesh
        With attributes.
    sources : Sources
        Of the elements of the file.
    places : Places
    wanted : Wanted

    Raises
    ------
    MeshError
        For an attribute that is not one of this mesh.
    """
    came_from = {"vertex": sources.vertices, "corner": sources.corners, "face": sources.faces}
    coded: list[Coded] = []
    streams: list[bytes] = []
    for attribute in mesh.attributes:
        check_attribute(attribute, mesh)
        rows = attribute.rows()[came_from[attribute.domain]]
        used, rows = _used(rows)
        values = _native(attribute.values[used])
        ways = (
            _encoded(entry, values, rows, places, coded)
            for entry in _entries(attribute, values, wanted)
        )
        one, parts = min(ways, key=lambda way: sum(map(len, way[1])))
        coded.append(one)
        streams += parts
    return write_table(tuple(one.entry for one in coded)) + b"".join(streams), tuple(coded)


def check_attribute(attribute: Attribute, mesh: PolyMesh) -> None:
    """Refuse an attribute whose arrays do not fit the mesh.

    Raises
    ------
    MeshError
    """
    counts = {"vertex": len(mesh.vertices), "corner": len(mesh.corners), "face": len(mesh.sizes)}
    values, index, name = attribute.values, attribute.index, f"attribute {attribute.name!r}"
    count = counts[attribute.domain]
    if values.ndim != 2:
        raise MeshError(f"{name} has values of shape {values.shape}, not (rows, width)")
    if values.dtype.newbyteorder("=") not in TYPES:
        raise MeshError(f"{name} is of type {values.dtype}: numbers of up to 64 bits only")
    rows = len(values if index is None else index)
    if rows != count:
        raise MeshError(f"{name} has {rows} rows for {count} of domain {attribute.domain}")
    if index is not None and count and not -1 <= index.min() <= index.max() < len(values):
        raise MeshError(f"{name} has indices outside -1..{len(values) - 1}")


def _used(rows: _Ints) -> tuple[_Ints, _Ints]:
    """Return the rows that are used, and which of these each element has, -1 for none."""
    used, compact = np.unique(rows, return_inverse=True)
    nothing = int(len(used) > 0 and used[0] < 0)
    return used[nothing:], compact - nothing


def _native(values: _Any) -> _Any:
    return np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("="))


def _entries(attribute: Attribute, values: _Any, wanted: Wanted) -> Iterator[Entry]:
    """Yield the ways in which values (r, width) may be coded; there is at least one."""
    a = attribute
    entry = Entry(a.name, a.domain, a.role, values.dtype, a.width, a.normalized, "exact")
    can_mix = a.role == "colour" and a.width >= 3
    for one in _plain_entries(entry, values, wanted):
        yield one
        if can_mix and one.coding != "exact" and one.limbs == 1:
            yield replace(one, mixed=True)


def _plain_entries(entry: Entry, values: _Any, wanted: Wanted) -> Iterator[Entry]:
    if values.dtype.kind in "bui":
        yield from numbers.integer_entries(entry, values)
        return
    yield entry
    if values.dtype.kind == "c":
        return
    levels = numbers.colour_entry(entry, values) if entry.role == "colour" else None
    if levels is not None and (not wanted.lossless or numbers.is_lossless(levels, values)):
        yield levels
    if entry.role == "uv" and not wanted.lossless:
        grid = numbers.grid_entry(entry, values, wanted.bits_uv)
        if grid is not None:
            yield grid


def _encoded(
    entry: Entry, values: _Any, rows: _Ints, places: Places, before: list[Coded]
) -> tuple[Coded, list[bytes]]:
    """Return an attribute that is coded so, and its streams.

    rows : int64 (count,), into `values`, -1 for none.
    """
    codes, ids = _distinct(numbers.to_codes(entry, values))
    ids = np.where(rows < 0, -1, ids[rows]) if len(ids) else rows
    units = _units(entry, ids, places, before)
    of_units = np.full(units.elements.count, -1, dtype=np.int64)
    of_units[units.of_elements] = ids
    has = of_units >= 0
    streams = [] if units.stream is None else [units.stream]
    entry = replace(entry, classes=units.classes)
    if not has.all():
        streams.append(encode_labels(units.elements, numbered(has.astype(np.int64))[0]))
        entry = replace(entry, partly=True, first_none=not has[0])
    near, labels = among(units.elements, has), of_units[has]
    rows, palette = np.arange(near.count), None
    rest = encode_rows(entry, codes[labels], near)
    if 0 < len(codes) <= min(_MOST_COLOURS, len(labels) // _FEW + 1):
        named, order = numbered(labels)
        other = [encode_labels(near, named), *encode_rows(entry, codes[order], alone(len(order)))]
        if sum(map(len, other)) < sum(map(len, rest)):
            rest, rows, labels, palette = other, named, order, len(order)
    streams += rest
    entry = replace(entry, palette=palette, sizes=tuple(map(len, streams)))
    one = Coded(entry, units.of_elements, units.of_corners, has, rows, codes[labels])
    return one, streams


def encode_rows(entry: Entry, codes: _Ints, elements: Elements) -> list[bytes]:
    """Return the streams of the rows (n, c) of elements."""
    if entry.coding == "exact":
        return encode_floats(elements, codes, entry.number_size)
    return encode_columns(elements, numbers.mixed(codes) if entry.mixed else codes)


def _distinct(codes: _Ints) -> tuple[_Ints, _Ints]:
    """Return the different rows of codes (r, c), and which of these each is."""
    if not codes.size:
        return codes[:1], np.zeros(len(codes), dtype=np.int64)
    keys = np.ascontiguousarray(codes).view(f"V{codes.shape[1] * 8}").ravel()
    _, first, ids = np.unique(keys, return_index=True, return_inverse=True)
    return codes[first], ids


def _units(entry: Entry, ids: _Ints, places: Places, before: list[Coded]) -> _Units:
    """Return what values belong to, where elements have those of these ids (count,)."""
    if entry.domain != "corner":
        elements = places.vertices if entry.domain == "vertex" else places.faces
        return _Units(OWN_CLASSES, places.units(entry.domain), None, elements, None)
    first = places.polygons.offsets[:-1]
    if (ids == ids[first][places.face_of_corners]).all():
        return _Units(FACES, places.face_of_corners, None, places.faces, None)
    stream, classes = encode_classes(places.structure, places.polygons, ids + 1)
    of_elements = classes[places.polygons.corners]
    for k, other in enumerate(before):
        own = other.entry.classes == OWN_CLASSES and other.classes is not None
        if own and np.array_equal(np.asarray(other.classes), classes):
            return _Units(k + 2, of_elements, classes, of_classes(classes), None)
    return _Units(OWN_CLASSES, of_elements, classes, of_classes(classes), stream)
