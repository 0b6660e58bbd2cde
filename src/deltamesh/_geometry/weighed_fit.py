"""Fit of the encoder where anchors are weighed in least squares: where the anchors go.

The least-squares solution is linear in the positions c of the anchors: x(c) = x(0) + B c with
B = M^-1 S^T, a smooth bump for each anchor. The anchors' own positions pull the surface off itself;
a file may have any, and those that minimize |x(c) - V| solve a system in B^T B.

Conjugate gradients solve it, with two solutions of the factored system in each step. The sizes of
the cells are the preconditioner: each row of B sums to 1, so that B^T B has sums of about these.
Anchors are no spikes afterwards: their rows are as soft as before, and a weight on the residuals of
the Laplacian there changes RMS by less than 1 %.
"""

from __future__ import annotations

from itertools import islice
from typing import Final

import numpy as np

from deltamesh._geometry.cells import Cells
from deltamesh._geometry.directions import directions, quotient
from deltamesh._geometry.solve import LeastSquares
from deltamesh_formats.array_types import Floats

# The last step is one that takes less than that share of the squared error, or the sixteenth; it is
# the third to the seventh on most meshes. With more, RMS is 1 or 2 % less.
SHARE: Final = 0.02
STEPS: Final = 16


def moves(system: LeastSquares, cells: Cells, left: Floats) -> tuple[Floats, Floats]:
    """Return by how much to move the anchors, so that the vertices err the least in the mean.

    Parameters
    ----------
    system : LeastSquares
    cells : Cells
        Of its anchors.
    left : float64 (n, 3)
        What quantization has left of the deltas.

    Returns
    -------
    float64 (k, 3)
        The moves from the true positions of the anchors.
    float64 (n, 3)
        The errors of all vertices, about.

    Raises
    ------
    SolveError
    """
    d = np.zeros((len(cells.anchors), left.shape[1]))
    e = -system.solve(left, d)
    r = -_at_anchors(system, cells, e)
    for p, product in islice(directions(r, lambda r: r / cells.sizes), STEPS):
        b = _spread(system, cells, p)
        a = quotient(product, (b * b).sum(axis=0))
        gain, squared = float((a * product).sum()), float((e * e).sum())
        d += a * p
        e += a * b
        if gain <= SHARE * squared:
            break
        r -= a * _at_anchors(system, cells, b)
    return d, e


def _spread(system: LeastSquares, cells: Cells, d: Floats) -> Floats:
    """Return B d: what moves of the anchors do to all vertices."""
    rows = np.zeros((len(cells.labels), d.shape[1]))
    rows[cells.anchors] = d
    return system.solve_normal(rows)


def _at_anchors(system: LeastSquares, cells: Cells, e: Floats) -> Floats:
    """Return B^T e, float64 (k, 3)."""
    return np.asarray(system.solve_normal(e)[cells.anchors])
