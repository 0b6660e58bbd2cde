"""Diagonals of quads, against their twin."""

from __future__ import annotations

import collections

import numpy as np
import polygon_oracle
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.mesh import diagonals


@given(st.lists(st.tuples(st.integers(0, 11), st.integers(0, 11), st.integers(0, 1)), max_size=40))
def test_diagonals_are_those_of_the_oracle(pairs: list[tuple[int, int, int]]) -> None:
    near = collections.defaultdict(list)
    for a, b, unlike in pairs:
        near[a].append((b, unlike))
    given_ = [-1, 1, 0, -1, -1, -1, 1, -1, -1, -1, -1, 0]
    rows = [near[q] for q in range(12)]
    start = np.cumsum([0] + [len(row) for row in rows])
    flat = np.array([edge for row in rows for edge in row], dtype=np.int64).reshape(-1, 2)
    cut = np.array(given_)
    diagonals.choose(start, flat[:, 0].copy(), flat[:, 1].copy(), cut)
    assert cut.tolist() == polygon_oracle.choose(rows, given_)
