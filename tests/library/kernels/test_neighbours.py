"""Neighbours of vertices, and connected components, against their twins."""

from __future__ import annotations

import numpy as np
import oracle
import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.mesh import neighbours
from deltamesh_formats.array_types import Ints

halfedges = st.integers(0, 12).flatmap(
    lambda n: st.tuples(
        st.just(n),
        st.lists(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)), max_size=60)
        if n
        else st.just([]),
    )
)


def gathered(some: list[tuple[int, int]], n: int) -> tuple[Ints, Ints]:
    a, b = np.array(some, dtype=np.int64).reshape(-1, 2).T.copy()
    return neighbours.gather(a, b, n)


@given(halfedges)
def test_neighbours_and_components_are_those_of_the_oracle(
    case: tuple[int, list[tuple[int, int]]],
) -> None:
    """Whatever the order of the half-edges, one way or both, repeated, with loops among them."""
    n, some = case
    pairs = sorted({(min(e), max(e)) for e in some if e[0] != e[1]})
    indptr, indices = gathered(some, n)
    rows = [indices[indptr[v] : indptr[v + 1]].tolist() for v in range(n)]
    assert rows == oracle.neighbours(pairs, n)
    assert len(indices) == 2 * len(pairs)
    label = np.empty(n, dtype=np.int64)
    count = neighbours.label_components(indptr, indices, label)
    expected = oracle.component_labels(pairs, n)
    assert label.tolist() == expected
    assert count == len(set(expected))


@pytest.mark.parametrize("pairs", [[(0, 3)], [(3, 0)], [(-1, 1)], [(1, -1)], [(0, 1), (2, 2**40)]])
def test_vertices_that_are_none_are_refused(pairs: list[tuple[int, int]]) -> None:
    with pytest.raises(ValueError, match="dm_gather_neighbours"):
        gathered(pairs, 3)


def test_a_hub_has_its_neighbours_in_order() -> None:
    n = 300_000
    a, b = np.zeros(n - 1, dtype=np.int64), np.random.default_rng(0).permutation(n - 1) + 1
    indptr, indices = neighbours.gather(a, b, n)
    np.testing.assert_array_equal(indices, np.concatenate([np.arange(1, n), a]))
    np.testing.assert_array_equal(np.diff(indptr), [n - 1] + [1] * (n - 1))
