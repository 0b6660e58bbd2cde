"""Elements: polygons and vertices with their neighbours."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import strategies
from elements_of import of_faces, of_rows, rows
from hypothesis import given

from deltamesh._graph import elements
from deltamesh._shape.polygons import Polygons
from deltamesh_formats.array_types import Ints


def fans(F: Ints, seed: int) -> Polygons:
    """Some faces joined to the next one: not always polygons, but neighbours do not mind."""
    joined = np.random.default_rng(seed).random(len(F)) < 0.4
    joined[:1] = False
    begins = np.flatnonzero(~joined)
    of_corners = np.arange(3 * len(F))
    return Polygons(of_corners, np.append(3 * begins, 3 * len(F)), of_corners)


@given(strategies.complexes(), strategies.SMALL)
def test_polygons_are_beside_those_with_an_edge_in_common(mesh: meshes.Arrays, seed: int) -> None:
    F = mesh[1]
    polygons = fans(F, seed)
    sizes = np.diff(polygons.offsets) // 3
    found = of_rows(F, polygons)
    polygon = np.repeat(np.arange(len(sizes)), sizes)
    assert rows(found) == oracle.beside(F.tolist(), polygon.tolist())
    assert found.count == len(sizes) == len(found.first) - 1
    assert len(found.corners) == 0
    assert found.indices.dtype == found.indptr.dtype == np.int32
    assert len(found.indices) <= 6 * len(F)


def test_many_faces_on_one_edge_are_a_chain() -> None:
    pages = 4000
    F = np.stack([np.zeros(pages), np.ones(pages), np.arange(2, pages + 2)], axis=1).astype(int)
    assert rows(of_faces(F))[:3] == [[1], [0, 2], [1, 3]]


def test_vertices_have_the_graph_and_the_parallelograms_of_their_faces() -> None:
    F = meshes.icosphere(1)[1]
    found = elements.of_vertices(F, 45)
    assert found.count == 45
    assert found.indptr[-1] == found.indptr[42] == 2 * 120
    expected = oracle.parallelograms(F)
    corners = np.split(found.corners, found.first[1:-1])
    assert {i: sorted(map(tuple, row.tolist())) for i, row in enumerate(corners) if len(row)} == {
        i: sorted(row) for i, row in expected.items()
    }


@given(strategies.complexes(), strategies.SMALL)
def test_elements_among_some_keep_what_is_among_these(mesh: meshes.Arrays, seed: int) -> None:
    V, F = mesh
    whole = elements.of_vertices(F, len(V))
    keep = np.random.default_rng(seed).random(len(V)) < 0.7
    number = {old: new for new, old in enumerate(np.flatnonzero(keep).tolist())}
    found = elements.among(whole, keep)
    around, predicted = rows(whole), np.split(whole.corners, whole.first[1:-1])
    assert found.count == len(number) == len(found.within)
    assert rows(found) == [[number[u] for u in around[v] if u in number] for v in number] or [[]]
    parts = [part.tolist() for part in np.split(found.corners, found.first[1:-1])]
    assert parts == [
        [[number[u] for u in row] for row in predicted[v].tolist() if {*row} <= {*number}]
        for v in number
    ] or [[]]
    assert elements.among(whole, np.ones(len(V), dtype=bool)) is whole


def test_elements_alone_have_no_neighbours() -> None:
    found = elements.alone(3)
    assert rows(found) == [[], [], []]
    assert found.first.tolist() == [0, 0, 0, 0]
    assert found.within.tolist() == [0, 0, 0]


def test_wedges_are_neighbours_along_the_edges_of_their_triangles() -> None:
    """Two triangles with an edge in common, of which one end is two wedges."""
    found = elements.of_wedges(np.array([0, 1, 2, 1, 0, 3]))
    assert found.count == 4
    assert rows(found) == [[1, 2, 3], [0, 2, 3], [0, 1], [0, 1]]
    assert [(sorted(row[:2]), row[2]) for row in found.corners.tolist()] == [([0, 1], 2)]
    split = elements.of_wedges(np.array([0, 1, 2, 1, 4, 3]))
    assert rows(split) == [[1, 2], [0, 2, 3, 4], [0, 1], [1, 4], [1, 3]]
    assert len(split.corners) == 0
