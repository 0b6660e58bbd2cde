"""Bounds on the error by the least singular value of [L; S], against measured errors.

After D. Chen, D. Cohen-Or, O. Sorkine, S. Toledo, "Algebraic Analysis of High-Pass Quantization",
ACM Trans. Graph. 24(4), 2005; the constants are our own, docs/paper.md has the proofs.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from paper_models import Floats, Ints, Model
from paper_tables import Row, Table, small
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.sparse.linalg import spsolve

from deltamesh import differential as dc

# Steps of the deltas in the diagonal.
STEPS = 1000
# Iterations of inverse iteration on two vectors; they end earlier at four digits.
_MOST, _DIGITS = 60, 1e-4


def by_paths(m: Model, anchors: Ints) -> float:
    """Return 1 / (sqrt 2 K), K the most that a patch sums of (edges to its anchor + 1)."""
    depth, _, source = dijkstra(
        abs(m.L), indices=anchors, unweighted=True, min_only=True, return_predecessors=True
    )
    sums = np.bincount(np.unique(source, return_inverse=True)[1], depth + 1)
    return 1 / (math.sqrt(2) * float(sums.max()))


def by_barrier(m: Model, anchors: Ints) -> float:
    """Return 1 / (sqrt 2 max y) for the solution of (L + S^T S) y = 1, an M-matrix."""
    S = csr_array((np.ones(len(anchors)), (anchors, anchors)), shape=m.L.shape)
    return 1 / (math.sqrt(2) * float(spsolve((m.L + S).tocsc(), np.ones(len(m.V))).max()))


def least_singular_value(system: dc.LeastSquares) -> float:
    """Return that of [L; S], by inverse iteration with the factor that is there."""
    x: Floats = np.random.default_rng(0).standard_normal((system.count, 2))
    largest = 0.0
    for _ in range(_MOST):
        x = system.normal(np.linalg.qr(x)[0])
        before, largest = largest, float(np.linalg.norm(x, axis=0).max())
        if abs(largest - before) < _DIGITS * largest:
            break
    return 1 / math.sqrt(largest)


def _bounds(m: Model) -> Iterator[Row]:
    step, k = m.diagonal / STEPS, len(m.V) // 100
    delta = m.quantized(step, 0.0)
    for name, anchors in (
        ("random", dc.random_anchors(m.L, k)),
        ("farthest", dc.farthest_anchors(m.L, k)),
        ("greedy", dc.greedy_anchors(m.L, m.V, k, delta)),
    ):
        system = dc.LeastSquares(m.L, anchors)
        sigmas = by_paths(m, anchors), by_barrier(m, anchors), least_singular_value(system)
        rms = m.errors(system.solve(delta, m.V[anchors])).rms
        bounds = [math.sqrt(3) * step / 2 / sigma / m.diagonal for sigma in sigmas]
        yield (
            f"{k}, {name}",
            small(rms),
            *(f"{small(bound)}" for bound in bounds),
            f"{bounds[-1] / rms:.0f}",
        )


TABLES = (
    Table(
        "bounds",
        (
            "mesh",
            "anchors",
            "RMS",
            "(a) by paths",
            "(b) by a barrier",
            "(c) by the singular value",
            "(c) / RMS",
        ),
        _bounds,
        ("torus",),
        ("camelhead", "screwdriver", "horse"),
    ),
)
