"""Interpolated anchors: deltas and anchors that no position contradicts.

Where the right-hand side of the rectangular system [L; S] x = [delta'; c] is consistent, its
least-squares solution interpolates the anchors, and one Poisson problem finds it: the rows of the
anchors follow from the others. The encoder makes it so. It stores, beside the quantized deltas,
what each cell of the anchors has lost (`cells`), and positions of the anchors that go with it
(`fit`).
"""

from __future__ import annotations

from typing import Final

import numpy as np

from deltamesh._geometry.cells import Cells
from deltamesh._geometry.poisson import Poisson
from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import SolveError

# Errors of a coordinate that a decoder may make, in steps of the deltas of its component: of what
# it returns, and of the surface whose normals the refinements go along. The bounds are proved ones,
# some hundred times the errors.
TOLERANCE: Final = 1e-3
NORMAL_TOLERANCE: Final = 1e-4
# Where attributes follow, whose normals are predicted from positions, both are so much finer.
FINER: Final = 1e-3
# Where doubles cannot keep that, errors may be those of rounding, up to that share of the extent.
ROUNDING: Final = 1e-6


class Interpolation:
    """The Laplacian of a graph, with anchors that positions go through.

    Parameters
    ----------
    cells : Cells
        Of the anchors; every component has one.
    threads : int, optional
        See `Poisson`.
    """

    def __init__(self, cells: Cells, threads: int | None = None) -> None:
        self.cells = cells
        self._poisson = Poisson(cells.graph, cells.anchors, threads)

    def solve(
        self,
        delta: Floats,
        positions: Floats,
        steps: Floats,
        tolerance: float = TOLERANCE,
        start: Floats | None = None,
    ) -> Floats:
        """Return the positions whose Laplacian is delta, and that go through those of the anchors.

        Parameters
        ----------
        delta : float64 (n, 3)
            Completed, see `Cells.completed`; it is used up.
        positions : float64 (k, 3)
        steps : float64 (n, 1)
            Of the deltas.
        tolerance : float
            The error that a coordinate may have, in the least step of its component.
        start : float64 (n, 3), optional
            Something near the solution, which saves iterations and takes the solution.

        Returns
        -------
        float64 (n, 3)

        Raises
        ------
        SolveError
            If the system is too ill-conditioned for double precision, or overflows it.
        """
        if not len(delta):
            return delta
        cells, anchors = self.cells, self.cells.anchors
        scale, shift = cells.least(steps), cells.centres(positions)
        with np.errstate(over="ignore", invalid="ignore"):
            x = start
            if x is None:
                x = np.zeros_like(delta)
            else:
                x -= shift
                x /= scale
            x[anchors] = (positions - shift[anchors]) / scale[anchors]
            delta /= scale
            bound = self._poisson.solve(delta, x, tolerance)
            if bound <= tolerance or self._is_rounding(bound, delta, x):
                x *= scale
                x += shift
                return x
        raise SolveError("the Poisson problem has no solution in double precision")

    def _is_rounding(self, bound: float, b: Floats, x: Floats) -> bool:
        """Return whether a bound is one that only more digits could better, and tolerable."""
        least = ROUNDING * float(np.abs(x).max(initial=0.0))
        return bound <= min(self._poisson.rounding(b, x), least)
