"""Floats of an attribute to the last bit, with every NaN, infinity and zero.

Numbers that no number format holds, those that are not finite among them, are raw.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding.exact import RAW
from deltamesh._mesh import LARGEST
from deltamesh._streams.column_choice import choose_columns, numbers_of
from deltamesh._streams.columns import join_columns, split_columns
from deltamesh._streams.exact import (
    DOUBLE,
    SINGLE,
    decode_numbers,
    encode_numbers,
    pack_formats,
    unpack_formats,
)
from deltamesh._streams.number_formats import from_indices
from deltamesh_formats.array_types import Ints
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
    raw = bits_of(short) if single and size == 8 else bits
    columns = choose_columns(elements, V, usable, raw, single)
    numbers = numbers_of(V, usable, raw, columns, single)
    width = SINGLE if single else DOUBLE
    return pack_formats(width, columns) + encode_numbers(elements, width, columns, *numbers)


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
    choices, indices, deviations = decode_numbers(payload, at, elements, width, columns)
    is_raw = choices == RAW
    V = np.empty(indices.shape)
    for a, column in enumerate(columns):
        clean = np.where(is_raw, 0, indices)[:, a]
        V[:, a] = from_indices(choices[:, a], clean, deviations[:, a], column, single)
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
