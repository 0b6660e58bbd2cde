"""Columns of integers at elements, three to a stream, predicted by parallelograms."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding import parallelogram
from deltamesh._kernels.coding.coder import Coder
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import FormatError


def split_columns(columns: Ints) -> list[Ints]:
    """Return columns (n, k) three at a time; the last three are padded with zeros."""
    missing = -columns.shape[1] % 3
    padded = np.pad(columns, ((0, 0), (0, missing)))
    return [padded[:, a : a + 3].copy() for a in range(0, padded.shape[1], 3)]


def join_columns(threes: Sequence[Ints], at: int, count: int, width: int) -> Ints:
    """Return the columns (count, width): the mirror of `split_columns`.

    Raises
    ------
    FormatError
        At `at`, if the padding is not zero.
    """
    columns = np.concatenate([np.zeros((count, 0), dtype=np.int64), *threes], axis=1)
    if columns[:, width:].any():
        raise FormatError("nonzero padding column of an attribute", at)
    return columns[:, :width]


def encode_columns(elements: Elements, columns: Ints) -> list[bytes]:
    """Return a stream of every three columns (n, k) of integers in -2^30 .. 2^30."""
    return [encode_three(elements, three) for three in split_columns(columns)]


def decode_columns(
    payload: memoryview, streams: Sequence[tuple[int, int]], elements: Elements, width: int
) -> Ints:
    """Return the columns (n, width): the mirror of `encode_columns`.

    Parameters
    ----------
    payload : memoryview
    streams : sequence of (begin, end)
        Positions of the streams in it.
    elements : Elements
    width : int

    Raises
    ------
    FormatError
    """
    threes = [decode_three(payload[begin:end], elements, begin) for begin, end in streams]
    return join_columns(threes, streams[-1][0] if streams else 0, elements.count, width)


def encode_three(elements: Elements, values: Ints) -> bytes:
    """Return the stream of three columns (n, 3)."""
    coded = values.copy()
    return encode_with(
        parallelogram.MODEL, elements.count, lambda coder: code_three(coder, elements, coded)
    )


def decode_three(payload: bytes | memoryview, elements: Elements, offset: int = 0) -> Ints:
    """Return three columns (n, 3): the mirror of `encode_three`.

    Raises
    ------
    FormatError
        With `offset` added to the position in the stream.
    """
    values = np.zeros((elements.count, 3), dtype=np.int64)
    decode_with(
        parallelogram.MODEL, payload, lambda coder: code_three(coder, elements, values), offset
    )
    return values


def code_three(coder: Coder, elements: Elements, values: Ints) -> None:
    """Code three columns (n, 3), filled in place when decoding."""
    e = elements
    parallelogram.code_positions(coder, e.indptr, e.indices, e.first, e.corners, e.within, values)
