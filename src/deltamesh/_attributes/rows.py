"""Rows of the codes of an attribute, each at its owner or in a palette."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from deltamesh._attributes.codings import check_codes, mixed, unmixed
from deltamesh._attributes.owners import Owners
from deltamesh._graph.elements import Elements, alone, among
from deltamesh._streams.columns import decode_columns, encode_columns
from deltamesh._streams.floats import decode_floats, encode_floats
from deltamesh._streams.labels import decode_labels, encode_labels
from deltamesh_formats.array_types import Ints
from deltamesh_formats.container.attribute_entry import Entry
from deltamesh_formats.errors import FormatError, located
from deltamesh_formats.polymesh.permutations import numbered

# A palette is tried for at most so many different rows, and at most one for so many of all.
_MOST_DIFFERENT: Final = 4096
_EACH: Final = 4


@dataclass(frozen=True)
class Rows:
    """Rows of codes, and the row of each owner that has a value.

    Attributes
    ----------
    labels : int64 (values,)
    codes : int64 (rows, columns)
    """

    labels: Ints
    codes: Ints


def encode_rows(
    entry: Entry, codes: Ints, rows: Ints, owners: Owners
) -> tuple[Entry, Rows, list[bytes]]:
    """Return the entry, the rows and their streams; there is a palette if that is smaller.

    Parameters
    ----------
    entry : Entry
    codes : int64 (r, columns)
    rows : int64 (values,)
        The row of each owner that has a value.
    owners : Owners
    """
    near = among(owners.elements, owners.has)
    streams, coded = _encode(entry, codes[rows], near), Rows(np.arange(near.count), codes[rows])
    labels, distinct = numbered(rows)
    if 0 < len(distinct) <= min(_MOST_DIFFERENT, len(rows) // _EACH + 1):
        palette = _encode(entry, codes[distinct], alone(len(distinct)))
        other = [encode_labels(near, labels), *palette]
        if sum(map(len, other)) < sum(map(len, streams)):
            entry = replace(entry, palette=len(distinct))
            return entry, Rows(labels, codes[distinct]), other
    return entry, coded, streams


def decode_rows(
    payload: memoryview, streams: list[tuple[int, int]], entry: Entry, owners: Owners, at: int
) -> Rows:
    """Return the rows: the mirror of `encode_rows`.

    Parameters
    ----------
    payload : memoryview
    streams : list of (begin, end)
        Positions of the streams of the rows.
    entry : Entry
    owners : Owners
    at : int
        Position of the first stream of the attribute, which errors name.

    Raises
    ------
    FormatError
    """
    near = among(owners.elements, owners.has)
    labels, of_rows = np.arange(near.count), near
    if entry.palette is not None:
        (begin, end), *streams = streams
        with located(begin):
            labels = decode_labels(payload[begin:end], near)
        found = int(labels.max(initial=-1)) + 1
        if found != entry.palette:
            raise FormatError(f"palette of {entry.palette} rows, of which {found} are used", at)
        of_rows = alone(entry.palette)
    codes = _decode(payload, streams, entry, of_rows)
    with located(at):
        check_codes(entry, codes)
    return Rows(labels, codes)


def _encode(entry: Entry, codes: Ints, elements: Elements) -> list[bytes]:
    if entry.coding == "exact":
        return encode_floats(elements, codes, entry.number_size)
    return encode_columns(elements, mixed(codes) if entry.mixed else codes)


def _decode(
    payload: memoryview, streams: list[tuple[int, int]], entry: Entry, elements: Elements
) -> Ints:
    width = entry.columns
    if entry.coding == "exact":
        return decode_floats(payload, streams, elements, width, entry.number_size)
    found = decode_columns(payload, streams, elements, width)
    return unmixed(found) if entry.mixed else found
