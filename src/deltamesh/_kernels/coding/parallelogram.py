"""Quantized positions, predicted by parallelograms and neighbours; `src/core/parallelogram.c`."""

from __future__ import annotations

from ctypes import byref
from typing import NamedTuple

import numpy as np

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.models import model_of
from deltamesh._kernels.core import call, constant, graph, ints, ints_out, number, scratch, shorts
from deltamesh_formats.array_types import Ints, Shorts

# Positions of a file that an encoder has written are below 2^31; extrapolation in a crafted one
# must not leave the integers.
BOUND = constant("DM_GRID_BOUND")

# A vertex has so many predictions; as many positions around that it may have; and is of a class.
PREDICTIONS = constant("DM_PREDICTIONS")
CANDIDATES = constant("DM_CANDIDATES")
CLASSES = constant("DM_CLASSES")

MODEL = model_of("positions")
SLOTS, MIXERS = MODEL


class Prediction(NamedTuple):
    """What is predicted at a vertex.

    Attributes
    ----------
    kind : int
        Its class.
    predictions : int64 (3, PREDICTIONS), positions : int64 (3, CANDIDATES)
    hints : int64 (3,)
        How far the parallelograms lie apart.
    """

    kind: int
    predictions: Ints
    positions: Ints
    hints: Ints


def code_positions(
    c: Coder,
    indptr: Shorts,
    indices: Shorts,
    first: Shorts,
    corners: Shorts,
    within: Shorts,
    values: Ints,
) -> None:
    """Code `values` (n, 3), filled in place when decoding.

    `corners[first[i]:first[i + 1]]` are the vertices (a, b, o), all below i, of the triangles
    (a, b, o) across an edge of a triangle (a, b, i); the first `within[i]` are quads (a, o, b, i)
    of the mesh. The neighbours are as `adjacency.adjacency` returns them.
    """
    n = len(values)
    mesh = _mesh(n, indptr, indices, first, corners, within)
    call("dm_code_positions", c.pointer, *mesh, ints_out(values, n, 3), scratch(n, 3))


def predict(
    indptr: Shorts,
    indices: Shorts,
    first: Shorts,
    corners: Shorts,
    within: Shorts,
    values: Ints,
    i: int,
) -> Prediction:
    """Return what is predicted at vertex i, where those below it are known."""
    n, kind = len(values), number()
    predictions = np.zeros((3, PREDICTIONS), dtype=np.int64)
    positions, hints = np.zeros((3, CANDIDATES), dtype=np.int64), np.zeros(3, dtype=np.int64)
    call(
        "dm_predict",
        *_mesh(n, indptr, indices, first, corners, within),
        ints(values, n, 3),
        i,
        ints_out(predictions, 3, PREDICTIONS),
        ints_out(positions, 3, CANDIDATES),
        ints_out(hints, 3),
        byref(kind),
    )
    return Prediction(kind.value, predictions, positions, hints)


def _mesh(
    n: int, indptr: Shorts, indices: Shorts, first: Shorts, corners: Shorts, within: Shorts
) -> tuple[object, ...]:
    count = len(corners)
    predictors = shorts(first, n + 1), shorts(corners, count, 3), count, shorts(within, n)
    return *graph(indptr, indices, n), *predictors
