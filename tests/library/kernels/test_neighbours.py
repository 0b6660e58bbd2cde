"""Neighbours of vertices, and connected components, against their twins."""

from __future__ import annotations

import numpy as np
import oracle
import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.mesh import neighbours

edges = st.integers(0, 12).flatmap(
    lambda n: st.tuples(
        st.just(n),
        st.lists(st.tuples(st.integers(0, n), st.integers(0, n)).filter(lambda e: e[0] < e[1] < n)),
    )
)


@given(edges)
def test_neighbours_and_components_are_those_of_the_oracle(
    case: tuple[int, list[tuple[int, int]]],
) -> None:
    n, some = case
    pairs = sorted(set(some))
    indptr, indices = np.empty(n + 1, dtype=np.int64), np.empty(2 * len(pairs), dtype=np.int64)
    neighbours.fill(np.array(pairs, dtype=np.int64).reshape(-1, 2), indptr, indices)
    rows = [indices[indptr[v] : indptr[v + 1]].tolist() for v in range(n)]
    assert rows == oracle.neighbours(pairs, n)
    label = np.empty(n, dtype=np.int64)
    count = neighbours.label_components(indptr, indices, label)
    expected = oracle.component_labels(pairs, n)
    assert label.tolist() == expected
    assert count == len(set(expected))


@pytest.mark.parametrize(
    "pairs",
    [[(0, 3)], [(-1, 1)], [(1, 0)], [(1, 1)], [(0, 1), (0, 1)], [(1, 2), (0, 1)], [(0, 2), (0, 1)]],
)
def test_what_is_no_list_of_edges_is_refused(pairs: list[tuple[int, int]]) -> None:
    indptr, indices = np.empty(4, dtype=np.int64), np.empty(2 * len(pairs), dtype=np.int64)
    with pytest.raises(ValueError, match="dm_fill_neighbours"):
        neighbours.fill(np.array(pairs), indptr, indices)
