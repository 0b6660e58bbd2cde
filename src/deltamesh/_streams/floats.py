"""Floats of an attribute to the last bit, with every NaN, infinity and zero.

Numbers that no number format holds, those that are not finite among them, are raw.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding.exact import RAW
from deltamesh._mesh import LARGEST
from deltamesh._streams.columns import join_columns, split_columns
from deltamesh._streams.exact import (
    DOUBLE,
    SINGLE,
    decode_indices,
    encode_indices,
    pack_formats,
    parallelogram_errors,
    unpack_formats,
)
from deltamesh._streams.format_choice import choose_formats
from deltamesh._streams.number_formats import RAW_ONLY, ColumnFormats, from_indices, to_indices
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.errors import FormatError, located


def bits_of(values: NDArray[Any]) -> Ints:
    """Return the bit patterns of floats (n, k), or of the parts of complex numbers (n, 2 k)."""
    values = np.ascontiguousarray(values)
    real = values.view(values.real.dtype) if values.dtype.kind == "c" else values
    return real.view(f"i{real.itemsize}").astype(np.int64) & _mask(real.itemsize)


def from_bits(bits: Ints, dtype: np.dtype[Any]) -> NDArray[Any]:
    """Return the floats: the mirror of `bits_of`."""
    size = dtype.itemsize // (2 if dtype.kind == "c" else 1)
    return np.ascontiguousarray(bits.astype(f"i{size}")).view(dtype)


def _mask(size: int) -> int:
    return -1 if size == 8 else (1 << 8 * size) - 1


def encode_floats(elements: Elements, bits: Ints, size: int) -> list[bytes]:
    """Return a stream of every three columns of bit patterns (n, k) of floats of `size` bytes."""
    return [_encoded(elements, three, size) for three in split_columns(bits)]


def _encoded(elements: Elements, bits: Ints, size: int) -> bytes:
    V = from_bits(bits, np.dtype(f"f{size}")).astype(np.float64)
    short = V.astype(np.float32)
    single = size < 8 or bool((short.astype(np.float64).view(np.int64) == bits).all())
    usable = np.abs(V) <= LARGEST
    errors = parallelogram_errors(V, elements)
    raw = bits_of(short) if single and size == 8 else bits
    columns, choices, indices = [], np.empty_like(bits), np.empty_like(bits)
    for a in range(3):
        some, clean = usable[:, a], np.where(usable[:, a], V[:, a], 0.0)
        column = _formats(clean[some], errors[np.isfinite(errors[:, a]), a], single, not some.all())
        choices[:, a], indices[:, a] = to_indices(clean, column, single)
        choices[~some, a] = RAW
        columns.append(column)
    indices = np.where(choices == RAW, raw, indices)
    width = SINGLE if single else DOUBLE
    stream = encode_indices(elements, width, columns, choices, indices)
    return pack_formats(width, columns) + stream


def _formats(values: Floats, errors: Floats, single: bool, raw: bool) -> ColumnFormats:
    """Return the formats of the values that may be in one; `raw` if there are others."""
    if not len(values):
        return RAW_ONLY
    column = choose_formats(values, errors, single)
    return replace(column, raw=column.raw or raw)


def decode_floats(
    payload: memoryview,
    streams: Sequence[tuple[int, int]],
    elements: Elements,
    width: int,
    size: int,
) -> Ints:
    """Return the bit patterns (n, width): the mirror of `encode_floats`.

    Raises
    ------
    FormatError
    """
    found = []
    for begin, end in streams:
        with located(begin):
            found.append(_decoded(payload[begin:end], elements, size))
    return join_columns(found, streams[-1][0] if streams else 0, elements.count, width)


def _decoded(payload: memoryview, elements: Elements, size: int) -> Ints:
    width, columns, at = unpack_formats(payload)
    single = width == SINGLE
    if size < 8 and not single:
        raise FormatError(f"{width}-bit numbers in an attribute of {8 * size} bits", 0)
    choices, indices = decode_indices(payload, at, elements, width, columns)
    is_raw = choices == RAW
    V = np.empty(indices.shape)
    for a, column in enumerate(columns):
        V[:, a] = from_indices(choices[:, a], np.where(is_raw, 0, indices)[:, a], column, single)
    numbers = V.astype(f"f{size}")
    if not (np.abs(V) <= LARGEST).all() or (numbers != V).any():
        raise FormatError(f"value not representable in {8 * size} bits", at)
    raw = indices[is_raw]
    if size == 8 and single:
        raw = bits_of(from_bits(raw, np.dtype("f4")).astype(np.float64))
    elif (raw & ~_mask(size)).any():
        raise FormatError(f"raw value exceeds {8 * size} bits", at)
    bits = bits_of(numbers)
    bits[is_raw] = raw
    return bits
