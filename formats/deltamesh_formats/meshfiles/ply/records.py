"""Reader of the records of a PLY element, as columns.

Text and bytes are read by the same code: a body is a row of cells, which are its numbers or its
bytes. Records without lists, or whose lists have the same lengths in all records, are one matrix
of cells. Otherwise one pass finds where each record begins, and the records of each length are a
matrix.
"""

from __future__ import annotations

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.ply.body import Ascii, Binary
from deltamesh_formats.meshfiles.ply.header import Element, Property

# Cells at which records are looked for at a time.
_WINDOW: Final = 1 << 16


class Column(NamedTuple):
    """Values of a property, in the order of the records.

    Attributes
    ----------
    values : (n,), or (the sum of the counts,) for a list
    counts : int64 (n,) or None
    """

    values: NDArray[Any]
    counts: Ints | None


def read_rows(body: Binary | Ascii, at: int, element: Element) -> tuple[dict[str, Column], int]:
    """Read the records of an element.

    Parameters
    ----------
    body : Binary or Ascii
    at : int
        First cell of the records.
    element : Element

    Returns
    -------
    columns : dict of str to Column
    end : int
        First cell after them.

    Raises
    ------
    MeshError
        When the body ends before they do.
    """
    n, properties = element.count, element.properties
    if not n or not properties:
        return {p.name: _empty(p) for p in properties}, at
    left = len(body.cells) - at
    if n * _row_width(body, properties, [0] * len(properties)) > left:
        raise MeshError(_cut_short(body, element, left))
    try:
        counts = _counts_of(body, at, properties)
        width = _row_width(body, properties, counts)
        starts = at + width * np.arange(n, dtype=np.int64)
        if n * width <= left and _are_alike(body, starts, properties, counts, width):
            matrix = body.cells[at : at + n * width].reshape(n, width)
            columns = _columns(body, matrix, starts, properties, counts)
            return dict(zip((p.name for p in properties), columns, strict=True)), at + n * width
        starts, lengths, end = _walk(body, at, n, properties)
    except IndexError:
        raise MeshError(_cut_short(body, element, left)) from None
    return _by_length(body, starts, lengths, properties), end


def _empty(prop: Property) -> Column:
    counts = None if prop.count_type is None else np.empty(0, dtype=np.int64)
    return Column(np.empty(0, dtype=prop.type), counts)


def _cut_short(body: Binary | Ascii, element: Element, left: int) -> str:
    message = f"{left} {body.unit} are left for {element.count} records of {element.name}"
    return f"{message}: is it cut short?"


def _row_width(body: Binary | Ascii, properties: list[Property], counts: list[int]) -> int:
    return sum(_cells(body, p, count) for p, count in zip(properties, counts, strict=True))


def _cells(body: Binary | Ascii, prop: Property, count: int) -> int:
    if prop.count_type is None:
        return body.width(prop.type)
    return body.width(prop.count_type) + count * body.width(prop.type)


def _counts_of(body: Binary | Ascii, at: int, properties: list[Property]) -> list[int]:
    """Return the lengths of the lists of a record, 0 for other properties.

    Raises
    ------
    IndexError
        At the end of the body.
    """
    counts = []
    for prop in properties:
        count = 0
        if prop.count_type is not None:
            if at + body.width(prop.count_type) > len(body.cells):
                raise IndexError
            count = body.whole(at, prop.count_type)
            if count < 0:
                raise body.error(at, f"a list of {count} numbers")
        at += _cells(body, prop, count)
        if at > len(body.cells):
            raise IndexError
        counts.append(count)
    return counts


def _are_alike(
    body: Binary | Ascii, starts: Ints, properties: list[Property], counts: list[int], width: int
) -> bool:
    """Return whether the lists of all records are as long as those of the first."""
    offset, first = 0, int(starts[0])
    matrix = body.cells[first : first + len(starts) * width].reshape(len(starts), width)
    for prop, count in zip(properties, counts, strict=True):
        if prop.count_type is not None:
            cells = matrix[:, offset : offset + body.width(prop.count_type)]
            if (cells != cells[0]).any():
                return False
        offset += _cells(body, prop, count)
    return True


def _walk(
    body: Binary | Ascii, at: int, n: int, properties: list[Property]
) -> tuple[Ints, Ints, int]:
    """Return the first cell and the lengths of lists of each record, and the end of the last.

    Where a record would end is found at all cells at once, from window to window: the pass over
    the records is then a look-up in a list for each.
    """
    pieces: list[Ints] = []
    while n:
        window = np.arange(at, min(at + _WINDOW, len(body.cells)), dtype=np.int64)
        ends = _lengths_at(body, window, properties)[1] - at
        found, here = _followed(ends.tolist(), n)
        if not found:  # a record that does not fit: the reason is raised
            found, here = [0], _row_width(body, properties, _counts_of(body, at, properties))
        pieces.append(at + np.array(found, dtype=np.int64))
        n, at = n - len(found), at + here
    starts = np.concatenate(pieces)
    return starts, _lengths_at(body, starts, properties)[0], at


def _followed(ends: list[int], most: int) -> tuple[list[int], int]:
    """Return up to `most` starts of records, one behind the other from 0 on, and the last end.

    `ends` has the end of a record at each cell, below 0 for what is no record.
    """
    found: list[int] = []
    at, size = 0, len(ends)
    while at < size and len(found) < most:
        end = ends[at]
        if end < 0:
            break
        found.append(at)
        at = end
    return found, at


def _lengths_at(body: Binary | Ascii, at: Ints, properties: list[Property]) -> tuple[Ints, Ints]:
    """Return the lengths of the lists of records, and their ends, -1 for what is no record.

    Parameters
    ----------
    body : Binary or Ascii
    at : int64 (k,)
        Their first cells, within the body.
    properties : list of Property

    Returns
    -------
    int64 (k, properties), int64 (k,)
    """
    size, fits = len(body.cells), np.ones(len(at), dtype=bool)
    lengths = np.zeros((len(at), len(properties)), dtype=np.int64)
    ends = at
    for i, prop in enumerate(properties):
        if prop.count_type is not None:
            width = body.width(prop.count_type)
            fits &= ends + width <= size
            counts = np.full(len(at), -1, dtype=np.int64)
            counts[fits] = body.counts(ends[fits], prop.count_type)
            fits &= counts >= 0
            lengths[:, i] = np.where(fits, counts, 0)
            ends = ends + width + lengths[:, i] * body.width(prop.type)
        else:
            ends = ends + body.width(prop.type)
        fits &= ends <= size
    return lengths, np.where(fits, ends, -1)


def _columns(
    body: Binary | Ascii,
    matrix: NDArray[Any],
    starts: Ints,
    properties: list[Property],
    counts: list[int],
) -> list[Column]:
    """Return the columns of records whose lists have the same lengths."""
    columns, offset = [], 0
    for prop, count in zip(properties, counts, strict=True):
        cells, lengths = _cells(body, prop, count), None
        begin = offset
        if prop.count_type is not None:
            begin += body.width(prop.count_type)
            lengths = np.full(len(starts), count, dtype=np.int64)
        block = matrix[:, begin : offset + cells]
        values = body.typed(block, starts + begin, prop.type) if block.size else block
        columns.append(Column(values.ravel().astype(prop.type, copy=False), lengths))
        offset += cells
    return columns


def _by_length(
    body: Binary | Ascii, starts: Ints, lengths: Ints, properties: list[Property]
) -> dict[str, Column]:
    """Return the columns of records whose lists differ in length."""
    ends = np.cumsum(lengths, axis=0)
    values = [
        np.empty(len(starts) if p.count_type is None else ends[-1, i], dtype=p.type)
        for i, p in enumerate(properties)
    ]
    for mine in _alike(lengths):
        counts = lengths[mine[0]].tolist()
        at = starts[mine, None] + np.arange(_row_width(body, properties, counts))
        columns = _columns(body, body.cells[at], starts[mine], properties, counts)
        for i, (prop, column) in enumerate(zip(properties, columns, strict=True)):
            to = mine
            if prop.count_type is not None:
                to = ((ends - lengths)[mine, i, None] + np.arange(counts[i])).ravel()
            values[i][to] = column.values
    return {
        p.name: Column(values[i], None if p.count_type is None else lengths[:, i])
        for i, p in enumerate(properties)
    }


def _alike(lengths: Ints) -> list[Ints]:
    """Return the records, ascending, of each kind: those whose lists have the same lengths."""
    kind = np.zeros(len(lengths), dtype=np.int64)
    for column in lengths.T:
        present = np.bincount(column) > 0
        rank = (np.cumsum(present) - 1)[column]
        if kind.any() and rank.any():
            rank += (int(rank.max()) + 1) * kind
            rank = np.unique(rank, return_inverse=True)[1]
        kind = rank if rank.any() else kind
    sizes = np.bincount(kind)
    if len(sizes) < 1 << 16:
        kind = kind.astype(np.uint16)  # sorts faster
    order = np.argsort(kind, kind="stable")
    return np.split(order, np.cumsum(sizes)[:-1])
