"""Numbers that are left, and rings of elements, against their twins."""

from __future__ import annotations

import numpy as np
import oracle
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.coding import remaining


@given(st.integers(1, 40), st.integers(0, 2**32))
def test_remaining_against_its_twin(n: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    fast, slow = remaining.all_of(n), oracle.Left(n)
    for index in rng.permutation(n):
        at = int(rng.integers(0, n + 1))
        assert remaining.next_left(fast, at) == slow.next_left(at)
        assert remaining.count_below(fast, at) == slow.count_below(at)
        rank = int(rng.integers(0, len(slow.indices)))
        assert remaining.select(fast, rank) == slow.select(rank)
        remaining.remove(fast, int(index))
        slow.remove(index)


@given(st.lists(st.integers(0, 5), min_size=1, max_size=40), st.integers(0, 2**32))
def test_rings_against_their_twin(groups: list[int], seed: int) -> None:
    fast, slow = remaining.rings_of(np.array(groups), 6), oracle.rings(groups, 6)
    for element in np.random.default_rng(seed).permutation(len(groups)):
        for group in range(6):
            found, e = [], int(fast.start[group])
            while e >= 0 and e not in found:
                found.append(e)
                assert fast.before[fast.after[e]] == e
                e = int(fast.after[e])
            assert found == slow[group]
        group = groups[element]
        remaining.leave_ring(fast, group, int(element))
        slow[group] = oracle.leave_ring(slow[group], element)
