"""Columns of integers at elements, three to a stream, predicted as grid points are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding import parallelogram
from deltamesh._kernels.coding.coder import Coder
from deltamesh._streams import entropy
from deltamesh_formats.errors import FormatError

_Ints = NDArray[np.int64]


def threes(columns: _Ints) -> list[_Ints]:
    """Return columns (n, k) three at a time; zeros are what is missing to the last three."""
    missing = -columns.shape[1] % 3
    padded = np.pad(columns, ((0, 0), (0, missing)))
    return [padded[:, a : a + 3].copy() for a in range(0, padded.shape[1], 3)]


def together(found: Sequence[_Ints], at: int, count: int, width: int) -> _Ints:
    """Return the columns (n, width): the mirror of `threes`.

    Raises
    ------
    FormatError
        If what is missing is not zero.
    """
    columns = np.concatenate([np.zeros((count, 0), dtype=np.int64), *found], axis=1)
    if columns[:, width:].any():
        raise FormatError("columns beyond those of an attribute that are not zero", at)
    return columns[:, :width]


def encode_columns(elements: Elements, columns: _Ints) -> list[bytes]:
    """Return a stream of every three columns (n, k) of integers in -2^30 .. 2^30."""
    streams = []
    for three in threes(columns):
        coder = entropy.encoder(elements.count, parallelogram.SLOTS, parallelogram.MIXERS)
        _code(coder, elements, three)
        streams.append(entropy.finish(coder))
    return streams


def decode_columns(
    payload: memoryview, streams: Sequence[tuple[int, int]], elements: Elements, width: int
) -> _Ints:
    """Return the columns (n, width): the mirror of `encode_columns`.

    Parameters
    ----------
    payload : memoryview
    streams : sequence of (begin, end)
        Where they are in it.
    elements : Elements
    width : int

    Raises
    ------
    FormatError
    """
    found = []
    for begin, end in streams:
        three = np.zeros((elements.count, 3), dtype=np.int64)
        coder = entropy.decoder(payload[begin:end], parallelogram.SLOTS, parallelogram.MIXERS)
        _code(coder, elements, three)
        entropy.check_end(coder, begin)
        found.append(three)
    return together(found, streams[-1][0] if streams else 0, elements.count, width)


def _code(coder: Coder, e: Elements, values: _Ints) -> None:
    parallelogram.code_positions(coder, e.indptr, e.indices, e.first, e.corners, e.within, values)
