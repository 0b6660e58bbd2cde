"""Laplacian of the graph of faces."""

import meshes
import numpy as np
import oracle
import pytest
from graphs import laplacian_of

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
