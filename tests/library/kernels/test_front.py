"""Nodes on the fronts of a region: the one that grows next, against its twin."""

from __future__ import annotations

import oracle
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.coding import front as kernels
from deltamesh._kernels.jit import kernel

# Functions that are inlined, as kernels that Python may call.
steps = st.lists(
    st.tuples(
        st.sampled_from(["add", "add", "set", "remove"]),
        st.integers(0, 1000),
        st.integers(0, 5) | st.integers(60, 70),
    ),
    max_size=60,
)


@kernel
def add(front, vertex, free):
    return kernels.add_node(front, vertex, free)


@kernel
def remove(front, node):
    kernels.remove_node(front, node)


@kernel
def change(front, node, free):
    kernels.set_free(front, node, free)


@kernel
def pivot(front):
    return kernels.choose_pivot(front)


@given(steps)
def test_the_pivot_is_that_of_the_oracle(todo: list[tuple[str, int, int]]) -> None:
    front, slow = kernels.new_front(len(todo)), oracle.Waiting()
    assert pivot(front) == slow.pivot() == -1
    for what, which, free in todo:
        live = list(slow.free)
        if what == "add":
            node = add(front, which, free)
            assert front.nodes[node]["vertex"] == which
            slow.set_free(int(node), free)
        elif live:
            node = live[which % len(live)]
            if what == "set":
                change(front, node, free)
                slow.set_free(node, free)
            else:
                remove(front, node)
                slow.remove(node)
        count = int(front.counts[kernels.LIVE])
        assert sorted(front.live[:count].tolist()) == sorted(slow.free)
        assert pivot(front) == slow.pivot()
