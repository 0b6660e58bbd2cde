"""Edges, neighbours and components of faces."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest
from graphs import components_of, laplacian_of

from deltamesh._graph import adjacency as laplacian
from deltamesh_formats.errors import LimitError

MESHES = meshes.every()


@pytest.mark.parametrize("name", MESHES)
def test_adjacency_lists_neighbours_in_order(name: str) -> None:
    V, F = MESHES[name]
    indptr, indices = laplacian.adjacency(F, len(V))
    assert indptr.dtype == indices.dtype == np.int32
    dense = oracle.laplacian(F, len(V))
    for v in range(len(V)):
        expected = np.flatnonzero(dense[v] < 0)
        np.testing.assert_array_equal(indices[indptr[v] : indptr[v + 1]], expected)


def test_edges_are_listed_once() -> None:
    # Three faces on edge 0-1, a face twice, and a face that repeats a vertex.
    F = np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4], [0, 1, 4], [2, 2, 4]])
    expected = [[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [1, 3], [1, 4], [2, 4]]
    assert laplacian.edges(F, 5).tolist() == expected


@pytest.mark.parametrize("n", [0, 3])
def test_no_faces(n: int) -> None:
    F = np.empty((0, 3), dtype=np.int64)
    assert laplacian.edges(F, n).shape == (0, 2)
    assert laplacian_of(F, n).shape == (n, n)
    np.testing.assert_array_equal(components_of(F, n), np.arange(n))


def test_components_are_numbered_by_their_lowest_vertex() -> None:
    F = np.array([[5, 2, 6], [0, 4, 3]])
    assert components_of(F, 8).tolist() == [0, 1, 2, 0, 0, 2, 2, 3]


def test_too_many_half_edges_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(laplacian, "MOST", 900)
    with pytest.raises(LimitError, match="960 half-edges of 162 vertices are too many"):
        laplacian.adjacency(meshes.icosphere(2)[1], 162)
