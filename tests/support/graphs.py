"""The graph of faces, by the functions that the codec calls one after the other."""

from __future__ import annotations

import importlib.util

import numpy as np
import scipy.sparse as sparse

from deltamesh._geometry.integers import Integers
from deltamesh._geometry.solve import LeastSquares
from deltamesh._geometry.steps import ratios
from deltamesh._graph.adjacency import Graph, adjacency, components
from deltamesh._graph.halfedges import weld
from deltamesh._graph.laplacian import laplacian
from deltamesh._measures.metrics import diagonal
from deltamesh._pipeline.decoder import read_content
from deltamesh._shape.surface import Surface
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.container import Parameters
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.polymesh.mesh import PolyMesh

# Those that an installation has without extras.
FREE_SOLVERS = (
    "core",
    *(name for name in ("rslab", "scipy") if importlib.util.find_spec(name)),
)


def laplacian_of(faces: Ints, n: int) -> sparse.csr_array:
    return laplacian(*adjacency(faces, n))


def graph_of(L: sparse.csr_array) -> Graph:
    """The neighbour lists of a Laplacian."""
    A = L - sparse.diags_array(L.diagonal())
    A = sparse.csr_array(A)
    A.eliminate_zeros()
    A.sort_indices()
    return A.indptr.astype(np.int32), A.indices.astype(np.int32)


def components_of(faces: Ints, n: int) -> Ints:
    return components(*adjacency(faces, n))


def least_squares(
    L: sparse.csr_array,
    anchors: Ints,
    delta: Floats,
    positions: Floats,
    solver: str = "auto",
    threads: int | None = None,
) -> Floats:
    return LeastSquares(graph_of(L), anchors, solver, threads).solve(delta, positions)


def tolerances(V: Floats, F: Ints) -> Floats:
    """By how much positions may differ, by vertex (n, 1), where anchors are not interpolated.

    SPEC.md 5.4, with rounding.
    """
    labels = components_of(F, len(V))
    diagonals = np.array([diagonal(V[labels == k]) for k in range(labels.max(initial=-1) + 1)])
    rounding = 4 * np.spacing(np.abs(V).max(axis=1, initial=0))
    return (1e-9 * diagonals[labels] + rounding)[:, None]


def tolerances_of_points(V: Floats, surface: Surface, p: Parameters, integers: Integers) -> Floats:
    """By how much positions V of points may differ, (n, 1): SPEC.md 5.4, with rounding."""
    allowed = tolerances(V, surface.faces)
    if p.interpolated:
        each = p.step * ratios(integers)
        for k in range(surface.labels.max(initial=-1) + 1):
            part = np.flatnonzero(surface.labels == k)
            allowed[part] = np.maximum(allowed[part], 1e-3 * each[part].min())
    return allowed


def tolerances_of(data: bytes, mesh: PolyMesh) -> Floats:
    """By how much positions of what a file decodes to may differ, by vertex (n, 1)."""
    container = read_container(data)
    content = read_content(container, 10**9, 2**40)
    points, kept = content.structure.points, content.order
    order = np.arange(len(points)) if kept is None else kept.vertices
    V = np.zeros((points.max() + 1, 3))
    V[points[order]] = mesh.vertices
    surface = content.structure.surface
    allowed = tolerances_of_points(V, surface, container.parameters, content.integers)
    return allowed[points[order]]


def points_of(V: Floats, F: Ints) -> tuple[Ints, int]:
    """The faces over distinct positions, and how many there are of these."""
    keep, welded = weld(V)
    return welded[F], len(keep)
