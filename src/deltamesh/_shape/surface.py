"""What the two geometry methods share: what they are given, and what they make of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from deltamesh._graph.adjacency import adjacency, adjacency_of_edges, components, edges_between
from deltamesh._graph.halfedges import ends
from deltamesh._graph.laplacian import laplacian
from deltamesh._graph.parallelograms import NO_QUADS, parallelograms

NO_EDGES: Final = np.zeros(0, dtype=bool)


@dataclass(frozen=True)
class Surface:
    """Connectivity in coding order, and what follows from it.

    Attributes
    ----------
    faces : int64 (m, 3)
    graph : pair of int64 arrays
        Neighbours of the vertices of the faces, as of `laplacian.adjacency`, along the edges of
        polygons.
    isolated_count : int
        Vertices without a face; they come after the others.
    quads : int64 (q, 4)
        The polygons of four corners.
    """

    faces: NDArray[np.int64]
    graph: tuple[NDArray[np.int64], NDArray[np.int64]]
    isolated_count: int
    quads: NDArray[np.int64] = field(default_factory=lambda: NO_QUADS)

    @property
    def vertex_count(self) -> int:
        """Number of vertices of the faces."""
        return len(self.graph[0]) - 1

    @cached_property
    def laplacian(self) -> sparse.csr_array:
        """L = D - A of the graph, float64 (n, n)."""
        return laplacian(*self.graph)

    @cached_property
    def labels(self) -> NDArray[np.int64]:
        """The component of each vertex of the faces."""
        return components(*self.graph)

    @cached_property
    def parallelograms(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
        """What predicts each vertex, the isolated ones too, as of `topology.parallelograms`."""
        count = self.vertex_count + self.isolated_count
        return parallelograms(self.faces, count, self.quads)


def surface_of(
    faces: NDArray[np.int64],
    vertex_count: int,
    isolated_count: int,
    hidden: NDArray[np.bool_] = NO_EDGES,
    quads: NDArray[np.int64] = NO_QUADS,
) -> Surface:
    """Return a `Surface` with its graph.

    Half-edges, (3 m,), may be `hidden` within polygons; edges where all are do not count.
    """
    if not len(hidden):
        return Surface(faces, adjacency(faces, vertex_count), isolated_count, quads)
    start, end = ends(faces)
    pairs = edges_between(start[~hidden], end[~hidden], vertex_count)
    return Surface(faces, adjacency_of_edges(pairs, vertex_count), isolated_count, quads)
