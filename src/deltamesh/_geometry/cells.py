"""Cells of the anchors: the vertices that are nearest to each, and what is the same all over one.

A cell has the vertices to which its anchor is the fewest edges away. One small vector a cell, added
to the deltas of its vertices, makes up for what quantization has taken from their sum.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from deltamesh._graph.adjacency import Graph
from deltamesh._kernels.mesh import distance
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.caching import cached_property


@dataclass(frozen=True)
class Cells:
    """The cells of some anchors.

    Attributes
    ----------
    graph : pair of int32 arrays (n + 1,), (2 e,)
    labels : int64 (n,)
        The component of each vertex.
    anchors : int64 (k,)
    """

    graph: Graph
    labels: Ints
    anchors: Ints

    @cached_property
    def of(self) -> Ints:
        """The cell of each vertex, int64 (n,)."""
        return distance.nearest(*self.graph, self.anchors)

    @cached_property
    def sizes(self) -> Floats:
        """The vertices of each cell, float64 (k, 1)."""
        return np.bincount(self.of, minlength=len(self.anchors))[:, None].astype(np.float64)

    @cached_property
    def shared(self) -> Ints:
        """The cells whose component has several, ascending, int64."""
        return np.flatnonzero(np.bincount(self._of_anchors)[self._of_anchors] > 1)

    @cached_property
    def borders(self) -> tuple[Ints, Ints]:
        """The cells at both ends of each half-edge that goes from one to another."""
        indptr, indices = self.graph
        tail, head = np.repeat(self.of, np.diff(indptr)), self.of[indices]
        crossing = tail != head
        return tail[crossing], head[crossing]

    @cached_property
    def _component_sizes(self) -> Floats:
        return np.bincount(self.labels)[:, None].astype(np.float64)

    @cached_property
    def _of_anchors(self) -> Ints:
        """The component of each anchor."""
        return self.labels[self.anchors]

    def least(self, x: Floats) -> Floats:
        """Return the least of x, float64 (n, 1), in the component of each vertex."""
        if not len(x) or (x == x[0]).all():
            return x
        least = np.full(len(self._component_sizes), np.inf)
        np.minimum.at(least, self.labels, x[:, 0])
        return least[self.labels][:, None]

    def centres(self, positions: Floats) -> Floats:
        """Return the mean position of the anchors, (k, 3), in the component of each vertex."""
        count = len(self._component_sizes)
        anchors = np.bincount(self._of_anchors, minlength=count)[:, None]
        centres = _sums(self._of_anchors, positions, count) / anchors
        return self._spread(centres)

    def sums(self, x: Floats) -> Floats:
        """Return the sum of x, float64 (n, c), over each cell, float64 (k, c)."""
        return _sums(self.of, x, len(self.anchors))

    def fluxes(self, x: Floats) -> Floats:
        """Return the Laplacian of x, float64 (k, c), on the graph of the cells' borders."""
        tail, head = self.borders
        return _sums(tail, x[tail] - x[head], len(self.anchors))

    def centred(self, x: Floats) -> Floats:
        """Return x, float64 (n, c), less its mean over each component."""
        return x - self._means(x)

    def completed(self, delta: Floats, y: Floats, out: Floats | None = None) -> Floats:
        """Return the deltas, float64 (n, c), with y (k, c) added over the cells.

        They are centred, as the Laplacian of anything is; `out`, maybe the deltas, takes them.
        """
        result = np.add(delta, y if len(y) == 1 else y[self.of], out=out)
        result -= self._means(result)
        return result

    def _means(self, x: Floats) -> Floats:
        return self._spread(
            _sums(self.labels, x, len(self._component_sizes)) / self._component_sizes
        )

    def _spread(self, rows: Floats) -> Floats:
        """Return the row of the component of each vertex, float64 (n, c), maybe all one row."""
        if len(rows) == 1:
            return np.broadcast_to(rows, (len(self.labels), rows.shape[1]))
        return np.asarray(rows[self.labels])


def _sums(of: Ints, x: Floats, count: int) -> Floats:
    if count == 1:
        return np.asarray(x.sum(axis=0, keepdims=True))
    columns = [np.bincount(of, np.ascontiguousarray(column), count) for column in x.T]
    return np.stack(columns, axis=1) if columns else np.zeros((count, 0))
