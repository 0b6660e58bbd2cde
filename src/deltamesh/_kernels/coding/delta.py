"""Quantized delta coordinates: their coding, and the diffusion of their quantization error.

Vertices come in coding order; a neighbour j of i is known when j < i. Nothing is predicted:
subtracting a mean of the neighbours made the numbers larger on every kind of mesh that was tried.
The contexts are the magnitudes and signs around.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.residual import (
    ABSOLUTE,
    HINT,
    HINT_ALL,
    KIND,
    KNOWN,
    LAST,
    NEIGHBOURS,
    SPENT,
    SUM,
    code_vector,
)
from deltamesh._kernels.jit import Int, inlined, kernel
from deltamesh_formats.array_types import Floats, Ints


@kernel
def code_deltas(c: Coder, indptr: Ints, indices: Ints, values: Ints) -> None:
    """Code `values` (n, 3), filled in place when decoding; for the graph, see `adjacency`."""
    known = np.zeros(KNOWN, np.int64)
    for i in range(len(values)):
        known[:] = 0
        for at in range(indptr[i], indptr[i + 1]):
            j = indices[at]
            if j >= i:
                break  # neighbours ascend
            known[NEIGHBOURS] += 1
            for axis in range(3):
                known[SUM + axis] += values[j, axis]
                size = abs(values[j, axis])
                known[ABSOLUTE + axis] += size
                known[HINT + axis] = max(known[HINT + axis], size)
        for axis in range(3):
            known[LAST + axis] = values[i - 1, axis] if i > 0 else 0
        known[KIND] = min(known[NEIGHBOURS], 3)
        known[HINT_ALL] = min(indptr[i + 1] - indptr[i], 15)
        code_vector(c, values[i], known)


@kernel
def code_refinements(c: Coder, indptr: Ints, indices: Ints, deltas: Ints, values: Ints) -> None:
    """Code `values` (n, 1), filled in place when decoding, where the `deltas` (n, 3) are known."""
    known = np.zeros(KNOWN, np.int64)
    for i in range(len(values)):
        known[:] = 0
        around = np.int64(0)
        for at in range(indptr[i], indptr[i + 1]):
            j = indices[at]
            around += abs(deltas[j, 0]) + abs(deltas[j, 1]) + abs(deltas[j, 2])
            if j < i:
                known[NEIGHBOURS] += 1
                known[SUM] += values[j, 0]
                size = abs(values[j, 0])
                known[ABSOLUTE] += size
                known[HINT] = max(known[HINT], size)
        valence = indptr[i + 1] - indptr[i]
        known[ABSOLUTE + 1] = known[NEIGHBOURS] * around // valence
        known[SPENT] = 2 * (abs(deltas[i, 0]) + abs(deltas[i, 1]) + abs(deltas[i, 2]))
        known[LAST] = values[i - 1, 0] if i > 0 else 0
        known[KIND] = min(known[NEIGHBOURS], 3)
        known[HINT_ALL] = min(valence, 15)
        code_vector(c, values[i], known)


@kernel
def diffuse(
    indptr: Ints,
    indices: Ints,
    delta: Floats,
    normals: Floats,
    steps: Floats,
    zone: float,
    tangential: float,
    normal: float,
    out: Ints,
) -> None:
    """Round delta / step into `out` (n, 3), or its component along `normals` into `out` (n, 1).

    Each vertex has its own of the `steps` (n,). Numbers within 0.5 + `zone` steps of 0 become 0.
    The error is passed on, in equal parts, to the neighbours that are still to come, into `delta`
    (n, 3), which is used up: the share `normal` of its component along the normal, the share
    `tangential` of the rest.
    """
    for i in range(len(out)):
        step = steps[i]
        a, n = delta[i], normals[i]  # the rounded part is taken off `a`: the error stays
        if out.shape[1] == 3:
            for axis in range(3):
                out[i, axis] = _round(a[axis] / step, zone)
                a[axis] -= out[i, axis] * step
        else:
            out[i, 0] = _round((a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) / step, zone)
            for axis in range(3):
                a[axis] -= out[i, 0] * step * n[axis]
        waiting = 0
        for at in range(indptr[i], indptr[i + 1]):
            waiting += indices[at] > i
        along = a[0] * n[0] + a[1] * n[1] + a[2] * n[2]
        for axis in range(3):
            share = tangential * (a[axis] - along * n[axis]) + normal * along * n[axis]
            for at in range(indptr[i], indptr[i + 1]):
                if indices[at] > i:
                    delta[indices[at], axis] += share / waiting


@inlined
def _round(steps: float, zone: float) -> Int:
    return np.int64(np.rint(steps)) if abs(steps) > 0.5 + zone else np.int64(0)
