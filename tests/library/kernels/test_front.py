"""Nodes on the fronts of a region: the one that grows next, against its twin."""

from __future__ import annotations

import oracle
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.coding.front import (
    add_node,
    choose_pivot,
    new_front,
    remove_node,
    set_free,
)

steps = st.lists(
    st.tuples(
        st.sampled_from(["add", "add", "set", "remove"]),
        st.integers(0, 1000),
        st.integers(0, 5) | st.integers(60, 70),
    ),
    max_size=60,
)


@given(steps)
def test_the_pivot_is_that_of_the_oracle(todo: list[tuple[str, int, int]]) -> None:
    front, slow = new_front(len(todo)), oracle.Waiting()
    assert choose_pivot(front) == slow.pivot() == -1
    for what, which, free in todo:
        live = list(slow.free)
        if what == "add":
            node = add_node(front, which, free)
            assert front.nodes[node]["vertex"] == which
            slow.set_free(int(node), free)
        elif live:
            node = live[which % len(live)]
            if what == "set":
                set_free(front, node, free)
                slow.set_free(node, free)
            else:
                remove_node(front, node)
                slow.remove(node)
        count = front.counts.live_count
        assert sorted(front.live[:count].tolist()) == sorted(slow.free)
        assert choose_pivot(front) == slow.pivot()
