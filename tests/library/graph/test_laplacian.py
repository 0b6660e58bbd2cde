"""Laplacian of the graph of faces."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest
from graphs import laplacian_of

from deltamesh._graph.laplacian import laplacian

MESHES = meshes.every()


@pytest.mark.parametrize("name", MESHES)
def test_laplacian_equals_the_definition(name: str) -> None:
    V, F = MESHES[name]
    L = laplacian_of(F, len(V))
    assert L.dtype == np.float64
    assert L.has_sorted_indices
    np.testing.assert_array_equal(L.toarray(), oracle.laplacian(F, len(V)))


def test_constants_have_no_laplacian() -> None:
    V, F = meshes.with_isolated()
    assert not (laplacian_of(F, len(V)) @ np.ones(len(V))).any()


def test_an_isolated_vertex_has_an_empty_row() -> None:
    L = laplacian(np.array([0, 1, 1, 2]), np.array([2, 0]))
    assert L.indptr.tolist() == [0, 2, 2, 4]
    assert L.indices.tolist() == [0, 2, 0, 2]
    assert L.data.tolist() == [1, -1, -1, 1]
