"""Basis functions of anchors beside eigenvectors: section 4 of the paper."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from paper_models import Floats, Ints, Model
from paper_tables import Row, Table, share, small

from deltamesh import differential as dc

COUNTS = (50, 100, 200)


def approximations(m: Model) -> Iterator[tuple[int, dict[str, tuple[Ints, Floats]]]]:
    """Yield, for each number of functions, anchors and positions by the bases.

    Eigenvectors have no anchors. Of the anchors, the first of the greedy ones are taken.
    """
    _, U = dc.eigenvectors(m.L, max(COUNTS))
    greedy = dc.greedy_anchors(m.L, m.V, max(COUNTS))
    zero = np.zeros_like(m.V)
    for k in COUNTS:
        anchors = greedy[:k]
        system = dc.LeastSquares(m.L, anchors)
        fitted = dc.fitted_positions(system, zero, m.V)
        yield (
            k,
            {
                "eigenvectors": (anchors[:0], U[:, :k] @ (U[:, :k].T @ m.V)),
                "f_i, copied": (anchors, system.solve(zero, m.V[anchors])),
                "f_i, fitted": (anchors, system.solve(zero, fitted)),
            },
        )


def _approximation(m: Model) -> Iterator[Row]:
    for k, found in approximations(m):
        errors = [m.errors(x) for _, x in found.values()]
        yield f"{k}", *(small(one.rms) for one in errors), *(small(one.max) for one in errors)


def _locality(m: Model) -> Iterator[Row]:
    """Every tenth of as many functions as one vertex in 40."""
    anchors = dc.greedy_anchors(m.L, m.V, len(m.V) // 40)
    B = dc.basis_functions(dc.LeastSquares(m.L, anchors))
    radius = int(m.hops(anchors).max())
    within, beyond = [], []
    for i in range(0, len(anchors), 10):
        hops, f = m.hops(anchors[i : i + 1]), B[:, i]
        within.append(float((f[hops <= radius] ** 2).sum() / (f**2).sum()))
        beyond.append(float(np.abs(f[hops > 2 * radius]).max(initial=0) / np.abs(f).max()))
    peak = np.mean(B[anchors, np.arange(len(anchors))] / B.max(axis=0))
    yield (
        f"{len(anchors)}",
        f"{radius}",
        share(float(np.mean(within))),
        share(min(within)),
        share(max(beyond)),
        f"{B.min():.2f} to {B.max():.2f}",
        share(float(peak)),
    )


TABLES = (
    Table(
        "locality",
        (
            "mesh",
            "anchors",
            "largest cell's radius (edges)",
            "energy within it, mean",
            "least",
            "beyond twice, of the peak",
            "values",
            "at the anchor, of the peak",
        ),
        _locality,
        ("torus",),
        ("screwdriver", "camelhead"),
    ),
    Table(
        "approximation",
        (
            "mesh",
            "functions",
            "RMS: eigenvectors",
            "f_i, copied",
            "f_i, fitted",
            "max: eigenvectors",
            "f_i, copied",
            "f_i, fitted",
        ),
        _approximation,
        ("torus",),
        ("screwdriver", "camelhead"),
    ),
)
