"""The payload of ATTR to attributes: the mirror of `deltamesh._attributes.encoding`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes import numbers
from deltamesh._attributes.coded import Coded
from deltamesh._attributes.directions import decode_directions
from deltamesh._attributes.domains import Places
from deltamesh._attributes.owners import decode_units
from deltamesh._graph.elements import Elements, alone, among
from deltamesh._limits import PER_BYTE
from deltamesh._streams.columns import decode_columns
from deltamesh._streams.floats import decode_floats
from deltamesh._streams.labels import decode_labels
from deltamesh_formats.container.attribute_table import Entry, read_table
from deltamesh_formats.errors import FormatError, located

_Ints = NDArray[np.int64]


# Any bits may be numbers, those of a signalling NaN too.
@np.errstate(over="ignore", invalid="ignore")
def decode_attributes(payload: memoryview, places: Places) -> tuple[Coded, ...]:
    """Return what is in a payload.

    Raises
    ------
    FormatError
        If no encoder has written it; the offset counts from its beginning.
    """
    entries, at = read_table(payload)
    coded: list[Coded] = []
    for entry in entries:
        coded.append(_decoded(payload, at, entry, places, coded))
        at += entry.size
    return tuple(coded)


def _decoded(
    payload: memoryview, at: int, entry: Entry, places: Places, before: Sequence[Coded]
) -> Coded:
    streams = list(_places_of(entry, at))
    units = decode_units(payload, streams, entry, places, before)
    has = np.ones(units.elements.count, dtype=bool)
    if entry.partly:
        found = _labels(payload, streams.pop(0), units.elements)
        if found.max(initial=0) > 1:
            raise FormatError("elements that have more or less than a value", at)
        has = (found == 1) == entry.first_none
    if entry.coding == "octahedral":
        normals = decode_directions(payload, streams[0], entry, units.elements)
        rows = np.flatnonzero(has)
        return Coded(entry, units.of_elements, units.classes, has, rows, normals.codes, normals)
    near = among(units.elements, has)
    labels, of_rows = np.arange(near.count), near
    if entry.palette is not None:
        labels = _labels(payload, streams.pop(0), near)
        if int(labels.max(initial=-1)) + 1 != entry.palette:
            raise FormatError("a palette of another number of rows", at)
        of_rows = alone(entry.palette)
    codes = _rows(payload, streams, entry, of_rows)
    with located(at):
        numbers.check_codes(entry, codes)
    return Coded(entry, units.of_elements, units.classes, has, labels, codes)


def _rows(
    payload: memoryview, streams: list[tuple[int, int]], entry: Entry, elements: Elements
) -> _Ints:
    """Return the rows (n, c) of elements."""
    width = entry.columns
    if entry.coding == "exact":
        return decode_floats(payload, streams, elements, width, entry.number_size)
    for begin, end in streams:
        if 3 * elements.count > PER_BYTE * (end - begin + 4):
            raise FormatError("more values of an attribute than fit into its bytes", begin)
    found = decode_columns(payload, streams, elements, width)
    return numbers.unmixed(found) if entry.mixed else found


def _labels(payload: memoryview, stream: tuple[int, int], elements: Elements) -> _Ints:
    begin, end = stream
    with located(begin):
        return decode_labels(payload[begin:end], elements)


def _places_of(entry: Entry, at: int) -> Iterator[tuple[int, int]]:
    for size in entry.sizes:
        yield at, at + size
        at += size
