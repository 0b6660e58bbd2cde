"""Floats of an attribute to the last bit: every NaN, infinity and zero as it was.

Numbers that no form has, those that are not finite among them, are raw. What is predicted from
them, and they from others, is the rest (`deltamesh._streams.exact`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding.exact import RAW
from deltamesh._mesh import LARGEST
from deltamesh._streams.columns import threes, together
from deltamesh._streams.exact import (
    DOUBLE,
    SINGLE,
    decode_spelled,
    encode_spelled,
    packed,
    parallelogram_errors,
    unpacked,
)
from deltamesh._streams.number_formats import Spelling, spelling, to_integers, to_values
from deltamesh_formats.errors import FormatError, located

_Ints = NDArray[np.int64]
_Floats = NDArray[np.float64]


def bits_of(values: NDArray[Any]) -> _Ints:
    """Return the bit patterns of floats (n, k), or of the parts of complex numbers (n, 2 k)."""
    values = np.ascontiguousarray(values)
    real = values.view(values.real.dtype) if values.dtype.kind == "c" else values
    return real.view(f"i{real.itemsize}").astype(np.int64) & _mask(real.itemsize)


def from_bits(bits: _Ints, dtype: np.dtype[Any]) -> NDArray[Any]:
    """Return the floats: the mirror of `bits_of`."""
    size = dtype.itemsize // (2 if dtype.kind == "c" else 1)
    return np.ascontiguousarray(bits.astype(f"i{size}")).view(dtype)


def _mask(size: int) -> int:
    return -1 if size == 8 else (1 << 8 * size) - 1


def encode_floats(elements: Elements, bits: _Ints, size: int) -> list[bytes]:
    """Return a stream of every three columns of bit patterns (n, k) of floats of `size` bytes."""
    return [_encoded(elements, three, size) for three in threes(bits)]


def _encoded(elements: Elements, bits: _Ints, size: int) -> bytes:
    V = from_bits(bits, np.dtype(f"f{size}")).astype(np.float64)
    short = V.astype(np.float32)
    single = size < 8 or bool((short.astype(np.float64).view(np.int64) == bits).all())
    usable = np.abs(V) <= LARGEST
    errors = parallelogram_errors(V, elements)
    raw = bits_of(short) if single and size == 8 else bits
    axes, classes, values = [], np.empty_like(bits), np.empty_like(bits)
    for a in range(3):
        some, clean = usable[:, a], np.where(usable[:, a], V[:, a], 0.0)
        how = _spelling(clean[some], errors[np.isfinite(errors[:, a]), a], single, not some.all())
        classes[:, a], values[:, a] = to_integers(clean, how, single)
        classes[~some, a] = RAW
        axes.append(how)
    values = np.where(classes == RAW, raw, values)
    width = SINGLE if single else DOUBLE
    return packed(width, axes) + encode_spelled(elements, width, axes, classes, values)


def _spelling(values: _Floats, errors: _Floats, single: bool, raw: bool) -> Spelling:
    """Return the forms of the values that may be in one, and whether others are raw."""
    if not len(values):
        return Spelling((), (), 0, raw=True, zeros=False)
    how = spelling(values, errors, single)
    return Spelling(how.forms, how.usual, how.grid, how.raw or raw, how.zeros)


def decode_floats(
    payload: memoryview,
    streams: Sequence[tuple[int, int]],
    elements: Elements,
    width: int,
    size: int,
) -> _Ints:
    """Return the bit patterns (n, width): the mirror of `encode_floats`.

    Raises
    ------
    FormatError
    """
    found = []
    for begin, end in streams:
        with located(begin):
            found.append(_decoded(payload[begin:end], elements, size))
    return together(found, streams[-1][0] if streams else 0, elements.count, width)


def _decoded(payload: memoryview, elements: Elements, size: int) -> _Ints:
    width, axes, at = unpacked(payload)
    single = width == SINGLE
    if size < 8 and not single:
        raise FormatError(f"numbers of {width} bits for those of {8 * size}", 0)
    classes, values = decode_spelled(payload, at, elements, width, axes)
    V = np.empty(values.shape)
    for a, how in enumerate(axes):
        V[:, a] = to_values(classes[:, a], np.where(classes == RAW, 0, values)[:, a], how, single)
    numbers = V.astype(f"f{size}")
    if not (np.abs(V) <= LARGEST).all() or (numbers != V).any():
        raise FormatError(f"a number that none of {8 * size} bits is", at)
    raw = values[classes == RAW]
    if size == 8 and single:
        raw = bits_of(from_bits(raw, np.dtype("f4")).astype(np.float64))
    elif (raw & ~_mask(size)).any():
        raise FormatError(f"a number of more than {8 * size} bits", at)
    bits = bits_of(numbers)
    bits[classes == RAW] = raw
    return bits
