"""Three columns of floats to the last bit, as in section EXAC and in exact attributes.

The number formats of the columns come first, with their conversions; a stream of the indices in
these formats follows, then one of deviations if there are any.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding import exact, grid
from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.models import Model
from deltamesh._streams.conversions import Conversion, Operation
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh._streams.number_formats import ColumnFormats, NumberFormat, fault_of
from deltamesh._streams.vectors import decode_vectors, encode_vectors
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.fields import STRUCT_CODES, struct_of
from deltamesh_formats.container.payload_layout import (
    COLUMN_DEVIATIONS,
    COLUMN_DOUBLE,
    COLUMN_FIELDS,
    COLUMN_FORMATS,
    COLUMN_OPERATIONS,
    COLUMN_RAW,
    COLUMN_ZEROS,
    FORMAT_FIELDS,
    OPERATION_FIELDS,
    RAW_WIDTHS,
)
from deltamesh_formats.errors import FormatError

SINGLE, DOUBLE = RAW_WIDTHS["binary32"], RAW_WIDTHS["binary64"]
_WIDTH: Final = STRUCT_CODES["u8"]
_COLUMN: Final = struct_of(COLUMN_FIELDS)
_FORMAT: Final = struct_of(FORMAT_FIELDS)
_OPERATION: Final = struct_of(OPERATION_FIELDS)
_SIZE: Final = STRUCT_CODES["u32"]
_OPERATIONS_AT: Final = (COLUMN_OPERATIONS & -COLUMN_OPERATIONS).bit_length() - 1
# An element of three numbers of up to 64 + 64 bits takes fewer bytes than two elements of others.
_ELEMENTS: Final = 2


def encode_numbers(
    elements: Elements,
    width: int,
    columns: Sequence[ColumnFormats],
    choices: Ints,
    indices: Ints,
    deviations: Ints,
) -> bytes:
    """Return the streams of numbers: of their indices, and of their deviations if there are any.

    Parameters
    ----------
    elements : Elements
    width : int
        Bits of a raw number.
    columns : sequence of 3 ColumnFormats
    choices, indices, deviations : int64 (n, 3)
        As `number_formats.to_indices` returns them.
    """

    def run(coder: Coder) -> None:
        _code(coder, elements, columns, width, choices.copy(), indices.copy())

    stream = encode_with(_model(columns), _ELEMENTS * elements.count, run)
    if not _deviate(columns):
        return stream
    other = encode_vectors(elements.indptr, elements.indices, deviations)
    return _SIZE.pack(len(stream)) + stream + other


def decode_numbers(
    payload: memoryview, at: int, elements: Elements, width: int, columns: Sequence[ColumnFormats]
) -> tuple[Ints, Ints, Ints]:
    """Return choices, indices and deviations, from `at` on: the mirror of `encode_numbers`.

    Raises
    ------
    FormatError
    """

    def run(coder: Coder) -> tuple[Ints, Ints]:
        choices, indices = np.zeros((2, elements.count, 3), dtype=np.int64)
        _code(coder, elements, columns, width, choices, indices)
        return choices, indices

    if not _deviate(columns):
        choices, indices = decode_with(_model(columns), payload[at:], run, at)
        return choices, indices, np.zeros_like(choices)
    (size,), begin = _take(payload, at, _SIZE)
    end = begin + size
    if end > len(payload):
        raise FormatError("truncated: stream of numbers", len(payload))
    choices, indices = decode_with(_model(columns), payload[begin:end], run, begin)
    deviations = decode_vectors(elements.indptr, elements.indices, payload[end:], end)
    having = np.array([column.conversion.deviations for column in columns])
    if deviations[~(having & (choices != exact.RAW))].any():
        raise FormatError("deviation of a number that has none", end)
    return choices, indices, deviations


def _deviate(columns: Sequence[ColumnFormats]) -> bool:
    return any(column.conversion.deviations for column in columns)


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
        conversion = column.conversion
        flags = len(column.formats) | len(conversion.operations) << _OPERATIONS_AT
        flags |= COLUMN_RAW * column.raw | COLUMN_ZEROS * column.zeros
        flags |= COLUMN_DOUBLE * conversion.double
        flags |= COLUMN_DEVIATIONS * conversion.deviations
        parts.append(_COLUMN.pack(flags, column.grid))
        parts += [_OPERATION.pack(one.operator, one.operand) for one in conversion.operations]
        pairs = zip(column.formats, column.usual, strict=True)
        parts += [_FORMAT.pack(f.base, f.places, f.digits, usual) for f, usual in pairs]
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
        column, at = _unpack_column(payload, at)
        fault = fault_of(column, width == SINGLE)
        if fault:
            raise FormatError(fault, start)
        columns.append(column)
    return width, columns, at


def _unpack_column(payload: memoryview, at: int) -> tuple[ColumnFormats, int]:
    """Return a column that may be at fault, and where it ends."""
    (flags, grid), at = _take(payload, at, _COLUMN)
    operations: list[Operation] = []
    formats: list[NumberFormat] = []
    usual: list[int] = []
    for _ in range((flags & COLUMN_OPERATIONS) >> _OPERATIONS_AT):
        (operator, operand), at = _take(payload, at, _OPERATION)
        operations.append(Operation(operator, operand))
    for _ in range(flags & COLUMN_FORMATS):
        (*fields, length), at = _take(payload, at, _FORMAT)
        formats.append(NumberFormat(*fields))
        usual.append(length)
    raw, zeros, double, deviations = (
        bool(flags & bit)
        for bit in (
            COLUMN_RAW,
            COLUMN_ZEROS,
            COLUMN_DOUBLE,
            COLUMN_DEVIATIONS,
        )
    )
    conversion = Conversion(tuple(operations), double, deviations)
    return ColumnFormats(tuple(formats), tuple(usual), grid, raw, zeros, conversion), at


def _take(payload: memoryview, at: int, fields: struct.Struct) -> tuple[tuple[Any, ...], int]:
    if len(payload) < at + fields.size:
        raise FormatError("truncated: number formats", len(payload))
    return fields.unpack_from(payload, at), at + fields.size
