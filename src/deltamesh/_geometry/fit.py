"""Fit of the encoder: what the cells of the anchors have lost, and where their anchors go.

The quantized deltas delta' differ from the true ones by q = delta - delta'. With a vector y added
over each cell (P, the indicators of the cells) and all rows of the Laplacian demanded, those of the
anchors too, positions err by e = L^+ (q - P y): where the anchors go does not matter, and there is
no flux into them that would show as a spike. The mean error of every cell vanishes where

    K y = P^T L^+ q,    K = P^T L^+ P,

which conjugate gradients solve without forming K. They are preconditioned by the fluxes between
the cells, D^-1 L_c D^-1 with the cells' sizes D and the Laplacian L_c of their borders, which is so
near to K^-1 that two steps do, for any number of anchors. Nor need the Poisson problems within be
solved to the end: what they leave is smooth, and y is rounded in any case.
"""

from __future__ import annotations

from itertools import islice
from typing import Final

import numpy as np

from deltamesh._geometry.cells import Cells
from deltamesh._geometry.directions import directions, quotient
from deltamesh._geometry.poisson import Poisson
from deltamesh._graph.adjacency import lowest
from deltamesh._kernels.mesh import laplacian
from deltamesh_formats.array_types import Floats

# Rounds of smoothing before the means of the cells are taken: the sharp edge of a cell is noise.
ROUNDS: Final = 10
# Steps, and iterations of the Poisson problems before the first one and in each.
STEPS: Final = 2
FIRST: Final = 5
FURTHER: Final = 3


class Fit:
    """The Poisson problems of a fit: with one fixed vertex a component, since e is free to move."""

    def __init__(self, cells: Cells, threads: int | None = None) -> None:
        self._cells = cells
        self._poisson = Poisson(cells.graph, lowest(cells.labels), threads)

    def smooth(self, q: Floats) -> Floats:
        """Return a y, float64 (k, 3), that needs no solve: the means of the smoothed q (n, 3)."""
        cells = self._cells
        beside_one = np.pad(q, ((0, 0), (0, 1)), constant_values=1)
        sums = cells.sums(laplacian.smooth(*cells.graph, beside_one, ROUNDS))
        return np.asarray(sums[:, :3] / sums[:, 3:])

    def exact(self, q: Floats) -> tuple[Floats, Floats]:
        """Return y, float64 (k, 3), with which nearly no cell errs in the mean, and e (n, 3)."""
        cells = self._cells
        y = self.smooth(q)
        e = self._inverse(cells.completed(q, -y), FIRST)
        r = cells.sums(e)
        steps = STEPS if len(cells.shared) else 0
        for p, product in islice(directions(r, self._fluxes), steps):
            b = self._inverse(p[cells.of], FURTHER)
            image = cells.sums(b)
            a = quotient(product, (p * image).sum(axis=0))
            b *= a
            e -= b
            y += a * p
            r -= a * image
        return y, e

    def _fluxes(self, r: Floats) -> Floats:
        sizes = self._cells.sizes
        return self._cells.fluxes(r / sizes) / sizes

    def _inverse(self, b: Floats, iterations: int) -> Floats:
        """Return L^+ b, nearly, for a centred b."""
        x = np.zeros_like(b)
        self._poisson.solve(b, x, most=iterations)
        return self._cells.centred(x)
