"""Vectors of three small integers at vertices, predicted to be zero."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding import residual
from deltamesh._kernels.coding.delta import code_deltas
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh_formats.array_types import Ints, Shorts


def encode_vectors(indptr: Shorts, indices: Shorts, values: Ints) -> bytes:
    """Return the stream of vectors.

    Parameters
    ----------
    indptr, indices : int32
        Neighbours of each vertex, as `adjacency.adjacency` returns them.
    values : int64 (n, 3)
        Magnitudes are below 2^31.
    """
    coded = values.copy()
    return encode_with(
        residual.MODEL, len(values), lambda coder: code_deltas(coder, indptr, indices, coded)
    )


def decode_vectors(
    indptr: Shorts, indices: Shorts, payload: bytes | memoryview, offset: int = 0
) -> Ints:
    """Return the vectors (n, 3): the mirror of `encode_vectors`.

    Raises
    ------
    FormatError
        If the stream does not end where it should; it is at `offset` in its section.
    """
    values = np.zeros((len(indptr) - 1, 3), dtype=np.int64)
    decode_with(
        residual.MODEL,
        payload,
        lambda coder: code_deltas(coder, indptr, indices, values),
        offset,
    )
    return values
