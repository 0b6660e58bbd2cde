"""What the values of an attribute belong to: vertices, faces, or classes of corners at a point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes.coded import Coded
from deltamesh._attributes.domains import Places
from deltamesh._attributes.seams import decode_classes, encode_classes
from deltamesh._graph.elements import Elements, of_wedges
from deltamesh_formats.container.attribute_table import FACES, OWN_CLASSES, Entry
from deltamesh_formats.errors import FormatError

_Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Units:
    """Where the elements of an attribute's domain have their values from.

    Attributes
    ----------
    of_elements : int64 (count,)
        The unit of each element.
    elements : Elements
        The units.
    classes : int64 (3 m,) or None
        Of the corners of the triangles, where these are the units.
    reference : int
        As `Entry.classes`.
    streams : list of bytes
        What tells the classes, if anything has to.
    """

    of_elements: _Ints
    elements: Elements
    classes: _Ints | None = None
    reference: int = OWN_CLASSES
    streams: list[bytes] = field(default_factory=list)


def encode_units(entry: Entry, rows: _Ints, places: Places, before: Sequence[Coded]) -> Units:
    """Return the units of elements with these rows (count,), -1 for none.

    Corners have the classes of an attribute before if those are the same.
    """
    simple = _simple(entry, places)
    if simple is not None:
        return simple
    first = places.polygons.offsets[:-1]
    if (rows == rows[first][places.face_of_corners]).all():
        return Units(places.face_of_corners, places.faces, reference=FACES)
    stream, classes = encode_classes(places.structure, places.polygons, rows + 1)
    for k, other in enumerate(before):
        own = other.classes if other.entry.classes == OWN_CLASSES else None
        if own is not None and np.array_equal(own, classes):
            return _of_classes(classes, places, k + 2)
    return _of_classes(classes, places, OWN_CLASSES, [stream])


def decode_units(
    payload: memoryview,
    streams: list[tuple[int, int]],
    entry: Entry,
    places: Places,
    before: Sequence[Coded],
) -> Units:
    """Return the units; their stream, the first, is taken off the list.

    Raises
    ------
    FormatError
    """
    simple = _simple(entry, places)
    if simple is not None:
        return simple
    if entry.classes == FACES:
        return Units(places.face_of_corners, places.faces, reference=FACES)
    if entry.classes == OWN_CLASSES:
        begin, end = streams.pop(0)
        classes = decode_classes(payload, begin, end, places.structure)
        p = places.polygons
        if (classes[p.corners][p.of_corners] != classes).any():
            raise FormatError("a corner of a polygon in two classes", begin)
        return _of_classes(classes, places, OWN_CLASSES)
    shared = before[entry.classes - 2].classes
    assert shared is not None  # by the rules of the table
    return _of_classes(shared, places, entry.classes)


def _simple(entry: Entry, places: Places) -> Units | None:
    if entry.domain == "corner":
        return None
    elements = places.vertices if entry.domain == "vertex" else places.faces
    return Units(np.arange(elements.count), elements)


def _of_classes(
    classes: _Ints, places: Places, reference: int, streams: Sequence[bytes] = ()
) -> Units:
    elements = of_wedges(classes)
    return Units(classes[places.polygons.corners], elements, classes, reference, list(streams))
