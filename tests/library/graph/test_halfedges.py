"""Half-edges: their opposites, and the welding of vertices."""

from __future__ import annotations

import numpy as np

from deltamesh._graph.halfedges import pair_halfedges, weld


def test_weld_keeps_the_first_of_each_position_in_order():
    V = np.array([[1, 0, 0], [0, 0, 0], [1, 0, 0], [0.0, -0.0, 0], [2, 0, 0]])
    keep, welded = weld(V)
    assert keep.tolist() == [0, 1, 4]
    assert welded.tolist() == [0, 1, 0, 1, 2]


def test_weld_against_a_dictionary():
    rng = np.random.default_rng(20)
    V = rng.integers(0, 3, (200, 3)).astype(float)
    keep, welded = weld(V)
    seen: dict[tuple[float, ...], int] = {}
    for i, v in enumerate(map(tuple, V.tolist())):
        seen.setdefault(v, i)
    assert keep.tolist() == sorted(seen.values())
    assert all(keep[welded[i]] == seen[tuple(v)] for i, v in enumerate(V.tolist()))


def test_pairs_on_a_boundary_have_no_opposite():
    assert (pair_halfedges(np.array([[0, 1, 2]])) == -1).all()
