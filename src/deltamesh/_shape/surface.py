"""Surface over points: the connectivity on which geometry is coded, and what follows from it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from deltamesh._graph.adjacency import Graph, adjacency, adjacency_between, components
from deltamesh._graph.elements import Elements
from deltamesh._graph.halfedges import ends
from deltamesh._graph.parallelograms import NO_QUADS, parallelograms
from deltamesh._shape.manifold import Manifold
from deltamesh_formats.array_types import Bools, Ints
from deltamesh_formats.caching import cached_property

NO_EDGES: Final = np.zeros(0, dtype=bool)


@dataclass(frozen=True)
class Surface:
    """Triangles in coding order with the neighbours of their vertices.

    Attributes
    ----------
    faces : int64 (m, 3)
    graph : pair of int32 arrays
        Neighbours of the vertices of the faces along the edges of polygons; see
        `adjacency.adjacency`.
    isolated_count : int
        Number of vertices without a face; they come after the others.
    quads : int64 (q, 4)
        The polygons of four corners.
    manifold : Manifold, optional
        The manifold that has these very faces, where one has.
    """

    faces: Ints
    graph: Graph
    isolated_count: int
    quads: Ints = field(default_factory=lambda: NO_QUADS)
    manifold: Manifold | None = None

    @property
    def vertex_count(self) -> int:
        """Number of vertices of the faces."""
        return len(self.graph[0]) - 1

    @cached_property
    def labels(self) -> Ints:
        """The component of each vertex of the faces."""
        return components(*self.graph)

    @cached_property
    def elements(self) -> Elements:
        """The vertices as elements, the isolated ones last, with what predicts each."""
        count = self.vertex_count + self.isolated_count
        indptr, indices = self.graph
        indptr = np.pad(indptr, (0, self.isolated_count), mode="edge")
        opposite = None if self.manifold is None else self.manifold.opposite
        predictors = parallelograms(self.faces, count, self.quads, opposite)
        return Elements(count, indptr, indices, *predictors)


def surface_of(
    faces: Ints,
    vertex_count: int,
    isolated_count: int,
    hidden: Bools = NO_EDGES,
    quads: Ints = NO_QUADS,
    manifold: Manifold | None = None,
) -> Surface:
    """Return a `Surface` with its graph.

    Half-edges, (3 m,), may be `hidden` within polygons; edges where all are do not count.
    """
    if not len(hidden):
        graph = adjacency(faces, vertex_count)
    else:
        start, end = ends(faces)
        graph = adjacency_between(start[~hidden], end[~hidden], vertex_count)
    return Surface(faces, graph, isolated_count, quads, manifold)
