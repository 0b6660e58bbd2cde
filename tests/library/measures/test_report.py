"""Report of the worst part, and of faces that are lost."""

from __future__ import annotations

import meshes
import numpy as np

from deltamesh._graph.adjacency import components_of_faces
from deltamesh._measures.measure import Measure
from deltamesh._measures.named_parts import named_parts
from deltamesh._measures.report import report_of
from deltamesh_formats.polymesh.mesh import from_triangles


def report(V, W, F, polygons):
    named = named_parts(from_triangles(V, F), F, polygons, components_of_faces(F, len(V)))
    return report_of(Measure(V, F, named.parts)(W), named)


def test_the_worst_part_is_named_and_its_errors_told() -> None:
    V, F = meshes.union(meshes.icosphere(1), meshes.tetrahedron(), meshes.tetrahedron())
    W = V.copy()
    W[46:] += [0.1, 0, 0]  # the last one is shifted
    found = report(V, W, F, np.arange(len(F)))
    assert (found.parts, found.worst.name) == (3, "component 2")
    assert found.worst.normal_deviation == 0
    assert np.isclose(found.worst.relative_rms, 0.1 / np.sqrt(12))
    assert len(found.lost) == len(found.turned) == 0


def test_faces_have_the_numbers_of_their_polygons() -> None:
    V, F = meshes.grid(3, 3)
    W = V.copy()
    W[F[6]] = W[F[6, 0]]  # a face becomes a point, and its neighbours lines
    found = report(V, W, F, np.arange(len(F)) // 2)
    assert 3 in found.lost.tolist()
    assert (np.diff(found.lost) >= 0).all()
    assert found.worst is None
    assert found.parts == 1
