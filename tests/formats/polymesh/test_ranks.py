"""Ranks of an order."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from deltamesh_formats.polymesh.permutations import rank_of


@given(st.integers(0, 40).flatmap(lambda n: st.permutations(range(n))))
def test_an_element_is_at_its_rank(order: list[int]) -> None:
    rank = rank_of(np.array(order, dtype=np.int64)).tolist()
    assert [order[place] for place in rank] == list(range(len(order)))
    assert [rank[element] for element in order] == list(range(len(order)))
