"""Reader of the records of a PLY element, as columns.

Text and bytes are read by the same code: a body is a row of cells, which are its numbers or its
bytes. Records without lists, or whose lists have the same lengths in all records, are one matrix
of cells. Otherwise one pass finds where each record begins, and the records of each length are a
matrix.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.ply.body import Ascii, Binary
from deltamesh_formats.meshfiles.ply.header import Element, Property


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
    """Return the first cell and the lengths of lists of each record, and the end of the last."""
    starts, lengths = [], []
    for _ in range(n):
        counts = _counts_of(body, at, properties)
        starts.append(at)
        lengths.append(counts)
        at += _row_width(body, properties, counts)
    return np.array(starts, dtype=np.int64), np.array(lengths, dtype=np.int64), at


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
    kinds, which = np.unique(lengths, axis=0, return_inverse=True)
    ends = np.cumsum(lengths, axis=0)
    values = [
        np.empty(len(starts) if p.count_type is None else ends[-1, i], dtype=p.type)
        for i, p in enumerate(properties)
    ]
    for kind, counts in enumerate(kinds.tolist()):
        mine = np.flatnonzero(which.ravel() == kind)
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
