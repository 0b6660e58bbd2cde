"""Three columns of floats to the last bit, as in section EXAC and in exact attributes.

The number formats of the columns come first; a stream of the indices in these formats follows.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Final

import numpy as np

from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding import exact, grid
from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.models import Model
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh._streams.number_formats import ColumnFormats, NumberFormat, fault_of
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container import layout
from deltamesh_formats.errors import FormatError

SINGLE, DOUBLE = layout.RAW_WIDTHS["binary32"], layout.RAW_WIDTHS["binary64"]
_WIDTH: Final = layout.STRUCT_CODES["u8"]
_COLUMN: Final = layout.struct_of(layout.COLUMN_FIELDS)
_FORMAT: Final = layout.struct_of(layout.FORMAT_FIELDS)
# An element of three numbers of up to 64 + 64 bits takes fewer bytes than two elements of others.
_ELEMENTS: Final = 2


def encode_indices(
    elements: Elements,
    width: int,
    columns: Sequence[ColumnFormats],
    choices: Ints,
    indices: Ints,
) -> bytes:
    """Return the stream of numbers by their indices.

    Parameters
    ----------
    elements : Elements
    width : int
        Bits of a raw number.
    columns : sequence of 3 ColumnFormats
    choices, indices : int64 (n, 3)
        As `number_formats.to_indices` returns them.
    """

    def run(coder: Coder) -> None:
        _code(coder, elements, columns, width, choices.copy(), indices.copy())

    return encode_with(_model(columns), _ELEMENTS * elements.count, run)


def decode_indices(
    payload: memoryview, at: int, elements: Elements, width: int, columns: Sequence[ColumnFormats]
) -> tuple[Ints, Ints]:
    """Return choices and indices, from the stream at `at`: the mirror of `encode_indices`.

    Raises
    ------
    FormatError
    """

    def run(coder: Coder) -> tuple[Ints, Ints]:
        choices, indices = np.zeros((2, elements.count, 3), dtype=np.int64)
        _code(coder, elements, columns, width, choices, indices)
        return choices, indices

    return decode_with(_model(columns), payload[at:], run, at)


def parallelogram_errors(V: Floats, elements: Elements) -> Floats:
    """Return the distance of each parallelogram from the vertex it predicts, float64 (p, 3)."""
    apex = np.repeat(np.arange(len(V)), np.diff(elements.first))
    a, b, o = elements.corners.T
    return np.asarray(np.abs(V[a] + V[b] - V[o] - V[apex]))


def _model(columns: Sequence[ColumnFormats]) -> Model:
    return exact.model_for(sum(len(column.formats) for column in columns))


def _code(
    coder: Coder,
    elements: Elements,
    columns: Sequence[ColumnFormats],
    width: int,
    choices: Ints,
    indices: Ints,
) -> None:
    e = elements
    table: list[tuple[int, ...]] = []
    formats: list[tuple[int, ...]] = []
    for column in columns:
        table.append((len(formats), len(column.formats), int(column.raw), int(column.zeros)))
        for f, usual in zip(column.formats, column.usual, strict=True):
            formats.append((f.base, column.grid - f.places, f.digits, usual))
    tables = np.array(table), np.array(formats, dtype=np.int64).reshape(-1, grid.FORMAT_SIZE)
    around = e.indptr, e.indices, e.first, e.corners
    exact.code_exact(coder, *around, *tables, width, choices, indices)


def pack_formats(width: int, columns: Sequence[ColumnFormats]) -> bytes:
    """Return the bytes of the formats; the mirror is `unpack_formats`."""
    parts = [_WIDTH.pack(width)]
    for column in columns:
        flags = layout.COLUMN_RAW * column.raw | layout.COLUMN_ZEROS * column.zeros
        parts.append(_COLUMN.pack(len(column.formats) | flags, column.grid))
        for f, usual in zip(column.formats, column.usual, strict=True):
            parts.append(_FORMAT.pack(f.base, f.places, f.digits, usual))
    return b"".join(parts)


def unpack_formats(payload: memoryview) -> tuple[int, list[ColumnFormats], int]:
    """Return the width of a raw number, the formats of each column, and where the stream begins.

    Raises
    ------
    FormatError
    """
    (width,), at = _take(payload, 0, _WIDTH)
    if width not in (SINGLE, DOUBLE):
        raise FormatError(f"numbers of {width} bits", 0)
    columns = []
    for _ in range(3):
        start = at
        (flags, grid), at = _take(payload, at, _COLUMN)
        formats, usual = [], []
        for _ in range(flags & layout.COLUMN_FORMATS):
            (*fields, length), at = _take(payload, at, _FORMAT)
            formats.append(NumberFormat(*fields))
            usual.append(length)
        raw, zeros = bool(flags & layout.COLUMN_RAW), bool(flags & layout.COLUMN_ZEROS)
        column = ColumnFormats(tuple(formats), tuple(usual), grid, raw, zeros)
        fault = "reserved bits are set" if flags >= 2 * layout.COLUMN_ZEROS else fault_of(column)
        if fault:
            raise FormatError(fault, start)
        columns.append(column)
    return width, columns, at


def _take(payload: memoryview, at: int, fields: struct.Struct) -> tuple[tuple[int, ...], int]:
    if len(payload) < at + fields.size:
        raise FormatError("truncated: number formats", len(payload))
    return fields.unpack_from(payload, at), at + fields.size
