"""Positions of interpolated anchors by a direct solution in double precision."""

from __future__ import annotations

from typing import cast

import numpy as np
from anchored import File

from deltamesh._geometry.cells import Cells
from deltamesh._geometry.interpolation import Interpolation
from deltamesh._geometry.steps import of_vertices
from deltamesh._geometry.systems import Systems
from deltamesh._graph.laplacian import laplacian
from deltamesh_formats.array_types import Floats, Ints


class Direct:
    """Interpolated anchors by a direct solution in double precision: SuperLU, and one refinement.

    It has the matrix in common with `Interpolation`, and nothing of the multigrid solver.
    """

    def __init__(self, cells: Cells) -> None:
        from scipy.sparse.linalg import splu

        L = laplacian(*cells.graph).tocsc()
        self.cells = cells
        self._free = np.ones(len(cells.labels), dtype=bool)
        self._free[cells.anchors] = False
        self._fixed = L[self._free][:, cells.anchors]
        self._matrix = L[self._free][:, self._free]
        # Symmetric and diagonally dominant: no pivoting.
        self._factor = splu(
            self._matrix,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )

    def solve(
        self,
        delta: Floats,
        positions: Floats,
        steps: Floats,
        tolerance: float = 0.0,
        start: Floats | None = None,
    ) -> Floats:
        """Return what `Interpolation.solve` does."""
        shift = self.cells.centres(positions)
        x = np.empty_like(delta)
        x[self.cells.anchors] = positions
        b = delta[self._free] - self._fixed @ (positions - shift[self.cells.anchors])
        found = self._factor.solve(b)
        found += self._factor.solve(b - self._matrix @ found)
        x[self._free] = found + shift[self._free]
        return x


class DirectSystems(Systems):
    """Systems whose Poisson problems are factored."""

    def interpolation(self, anchors: Ints) -> Interpolation:
        """Return the system that goes through the anchors."""
        return cast(Interpolation, Direct(self.cells(anchors)))


def distance_from_direct(file: File, W: Floats) -> float:
    """Return the largest distance of a coordinate from a direct solution, in steps.

    A step is the least of the component, as in the tolerance of the format.
    """
    systems = DirectSystems(file.surface)
    steps = of_vertices(file.parameters.step, file.integers)[: len(W)]
    least = systems.cells(file.integers.anchors).least(steps)
    return float((np.abs(W - file.positions(systems)) / least).max())
