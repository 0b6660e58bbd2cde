"""Systems that positions are solved from, for the anchors of one surface."""

from __future__ import annotations

import copy
import math
from functools import lru_cache

from deltamesh._geometry import anchors as choice
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.fit import Fit
from deltamesh._geometry.interpolation import Interpolation
from deltamesh._geometry.solve import LeastSquares, factorization, remembered
from deltamesh._shape.surface import Surface
from deltamesh_formats.array_types import Ints


class Systems:
    """What is made once for the anchors of a surface, and used by every trial of a search.

    Each function remembers its last result: a search asks for the same again and again.

    Parameters
    ----------
    surface : Surface
    solver, memory
        Of the least-squares problems, see `LeastSquares`.
    threads : int, optional
        Of all problems. Default: one for each core.

    Attributes
    ----------
    precision : float
        Factor of the tolerances of interpolated anchors; 1 unless `to_precision` says else.
    """

    precision = 1.0

    def __init__(
        self,
        surface: Surface,
        solver: str = "auto",
        threads: int | None = None,
        memory: float = math.inf,
    ) -> None:
        graph, labels = surface.graph, surface.labels
        self._least_squares = factorization(graph, solver, threads, memory)
        self._of_choice = factorization(graph, solver, threads, memory)
        # Not of `self`: a cycle would keep all of it in memory until it is looked for.
        cells = self._cells = remembered(lambda anchors: Cells(graph, labels, anchors))
        self._interpolation = remembered(lambda anchors: Interpolation(cells(anchors), threads))
        self._fit = remembered(lambda anchors: Fit(cells(anchors), threads))
        self._farthest = lru_cache(maxsize=1)(lambda k: choice.farthest(*graph, labels, k))
        self._cells_apart = lru_cache(maxsize=2)(
            lambda count: Cells(graph, labels, choice.farthest(*graph, labels, count))
        )

    def to_precision(self, precision: float) -> Systems:
        """Return the same systems, with another factor of the tolerances."""
        other = copy.copy(self)
        other.precision = precision
        return other

    def farthest(self, k: int) -> Ints:
        """Return so many anchors by farthest-point sampling, int64 (k,); see `anchors.farthest`."""
        return self._farthest(k)

    def least_squares(self, anchors: Ints) -> LeastSquares:
        """Return the system [L; S], factored."""
        return self._least_squares(anchors)

    def of_choice(self, anchors: Ints) -> LeastSquares:
        """Return the system [L; S] of the anchors that a greedy choice begins with, factored."""
        return self._of_choice(anchors)

    def cells(self, anchors: Ints) -> Cells:
        """Return the cells of the anchors."""
        return self._cells(anchors)

    def cells_apart(self, count: int) -> Cells:
        """Return the cells of so many vertices that are the farthest apart."""
        return self._cells_apart(count)

    def interpolation(self, anchors: Ints) -> Interpolation:
        """Return the system that goes through the anchors."""
        return self._interpolation(anchors)

    def fit(self, anchors: Ints) -> Fit:
        """Return the encoder's fit of what the cells have lost."""
        return self._fit(anchors)
