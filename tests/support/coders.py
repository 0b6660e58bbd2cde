"""Arguments of the twins of the coders' kernels: neighbours, parallelograms, slow coders."""

from __future__ import annotations

import numpy as np
import oracle

from deltamesh._graph.adjacency import adjacency
from deltamesh._graph.parallelograms import NO_QUADS, parallelograms
from deltamesh._kernels.coding import coder as coder_kernels
from deltamesh._kernels.coding import signed_integers

TABLES = (coder_kernels.STRETCH, coder_kernels.SQUASH, coder_kernels.RATE)
WEIGHT_SUM = 1.2  # of a mixer of several inputs, at first: SPEC.md, "Entropy coder"


def slow_coder(data, slots, mixers):
    """A slow coder; of `data` it reads, of None it writes."""
    return oracle.RangeCoder(TABLES, slots, mixers, WEIGHT_SUM, data)


def twin_of(data, inputs):
    """A slow coder of signed integers."""
    return slow_coder(data, signed_integers.SLOTS, inputs)


def neighbours_of(F, n):
    indptr, indices = adjacency(F, n)
    return [indices[indptr[i] : indptr[i + 1]].tolist() for i in range(n)]


def corners_of(F, n, quads=NO_QUADS):
    """The parallelograms of each vertex as lists, in their order."""
    first, corners, _ = parallelograms(F, n, quads)
    rows = [corners[first[i] : first[i + 1]].tolist() for i in range(n)]
    return {i: row for i, row in enumerate(rows) if row}


def integers_of(size, seed):
    """Triples of which some are near the bounds, most are small, and many zero."""
    rng = np.random.default_rng(seed)
    scale = 2.0 ** rng.uniform(-1, 30.9, (size, 1))
    values = np.rint(rng.normal(size=(size, 3)) * scale * rng.integers(0, 2, (size, 3)))
    return np.clip(values, 1 - 2**31, 2**31 - 1).astype(np.int64)
