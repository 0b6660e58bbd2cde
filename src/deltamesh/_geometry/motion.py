"""Motion from one frame to another, and the deltas that it predicts.

Around a vertex, a surface that moves is turned, stretched and sheared by about one linear map. Such
a map a cell, of some vertices that follow from connectivity, is stored in integers; smoothed over
the surface, it carries the deltas of the frame before into those of the next:

    sum over the neighbours j of  (T_i + T_j) / 2 (v_i - v_j),

the right-hand side of Laplacian editing (Y. Lipman, O. Sorkine, D. Levin, D. Cohen-Or, "Linear
rotation-invariant coordinates for meshes", SIGGRAPH 2005), with maps instead of rotations. They are
fitted to where the vertices went: an encoder knows that, and a decoder has nothing to fit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh._geometry.cells import Cells
from deltamesh._kernels.mesh import laplacian, rotations
from deltamesh_formats.array_types import Floats, Ints

# Numbers of a map.
NINE: Final = 9
IDENTITY: Final = np.eye(3).reshape(NINE)
# The unit of these numbers: 2^-6. Finer ones cost as many bytes as they save.
UNIT: Final = 6
# Rounds of smoothing over the square of the radius of a cell, in edges.
ROUNDS: Final = 1.5
MOST_ROUNDS: Final = 255
# Rounds of the fit, and how much of a rotation is mixed into it where a cell is flat or straight.
FITS: Final = 5
RIGID: Final = 0.01
# The largest number of a map, beside the identity: none that is larger predicts anything.
LARGEST: Final = 64.0


@dataclass(frozen=True)
class Motion:
    """Linear maps of the cells of some vertices.

    Attributes
    ----------
    rows : int64 (3 k, 3)
        The maps of k cells, row by row, less the identity, in units.
    rounds : int
        Of smoothing.
    unit : int
        The unit is 2^-unit.
    """

    rows: Ints
    rounds: int
    unit: int

    @property
    def count(self) -> int:
        """Number of cells."""
        return len(self.rows) // 3


def carried(positions: Floats, motion: Motion, cells: Cells) -> Floats:
    """Return the deltas that a motion makes of positions, float64 (n, 3).

    Parameters
    ----------
    positions : float64 (n, 3)
    motion : Motion
    cells : Cells
        Those of its maps.
    """
    maps = IDENTITY + np.ldexp(motion.rows.reshape(-1, NINE).astype(np.float64), -motion.unit)
    each = _spread(cells, maps, motion.rounds).reshape(-1, 3, 3)
    return rotations.turned_deltas(*cells.graph, positions, each)


def _spread(cells: Cells, maps: Floats, rounds: int) -> Floats:
    """Return the map of each vertex, float64 (n, 9), from those of the cells (k, 9), smoothed."""
    each = np.pad(maps[cells.of], ((0, 0), (0, 1)), constant_values=1)
    each = laplacian.smooth(*cells.graph, each, rounds)
    return np.asarray(each[:, :NINE] / each[:, NINE:])


def _times(maps: Floats, v: Floats) -> Floats:
    """Return the product of the map of each row with the vector of the row, float64 (n, 3)."""
    a, b, c = v.T
    columns = [maps[:, i] * a + maps[:, i + 1] * b + maps[:, i + 2] * c for i in (0, 3, 6)]
    return np.stack(columns, axis=1)


def fitted_motion(before: Floats, after: Floats, cells: Cells) -> Motion | None:
    """Return the motion that carries positions best; None if nothing turns.

    Parameters
    ----------
    before, after : float64 (n, 3)
        The decoded positions of a frame, and the input's of the next.
    cells : Cells
        Each gets a map.
    """
    count = len(cells.anchors)
    # A cell is a disc of so many edges in radius, squared.
    radius = len(before) / (np.pi * max(count, 1))
    rounds = min(round(ROUNDS * radius), MOST_ROUNDS)
    fit, maps = _EdgeFit(cells, before, after), np.tile(IDENTITY, (count, 1))
    for i in range(FITS):
        maps = maps + fit.step(_spread(cells, maps, rounds), rigid=i == 0)
    rows = np.rint(np.clip(maps - IDENTITY, -LARGEST, LARGEST) * 2.0**UNIT).astype(np.int64)
    return Motion(rows.reshape(-1, 3), rounds, UNIT) if rows.any() else None


class _EdgeFit:
    """Least squares of a map a cell, that takes the edges around its vertices where they went."""

    def __init__(self, cells: Cells, before: Floats, after: Floats) -> None:
        indptr, self._head = cells.graph
        self._tail = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
        self._cells = cells
        self._of_edge = cells.of[self._tail]
        self._before = before[self._tail] - before[self._head]
        self._after = after[self._tail] - after[self._head]
        squares = self._sums(self._before, self._before)
        trace = np.trace(squares, axis1=1, axis2=2)
        self._still = trace == 0
        self._prior = np.where(self._still, 1.0, RIGID * trace / 3)[:, None, None] * np.eye(3)
        self._squares = squares
        self._inverse = np.linalg.inv(squares + self._prior)

    def step(self, each: Floats, *, rigid: bool) -> Floats:
        """Return what to add to the maps, float64 (k, 9), from those of the vertices, (n, 9).

        Where a cell says nothing of a direction, a rigid step takes that from its rotation.
        """
        mean = 0.5 * (each[self._tail] + each[self._head])
        left = self._sums(self._after - _times(mean, self._before), self._before)
        if rigid:
            left += (rotations.nearest(left + self._squares) - np.eye(3)) @ self._prior
        left[self._still] = 0
        return np.asarray((left @ self._inverse).reshape(-1, NINE))

    def _sums(self, a: Floats, b: Floats) -> Floats:
        """Return the sum of the products a b^T of edges over each cell, float64 (k, 3, 3)."""
        k = len(self._cells.anchors)
        columns = [np.bincount(self._of_edge, a[:, i] * b[:, j], k) for i, j in np.ndindex(3, 3)]
        return np.asarray(np.stack(columns, axis=1).reshape(-1, 3, 3), dtype=np.float64)
