"""Half-edges: their opposites, and the welding of vertices."""

from __future__ import annotations

import collections

import meshes
import numpy as np
import strategies
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._graph.halfedges import by_edge, edges_of_two, ends, pair_halfedges, weld


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


pairs_of_vertices = st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), max_size=30)


def test_halfedges_run_to_the_next_corner() -> None:
    start, end = ends(np.array([[4, 5, 6, 7], [0, 1, 2, 3]]))
    assert start.tolist() == [4, 5, 6, 7, 0, 1, 2, 3]
    assert end.tolist() == [5, 6, 7, 4, 1, 2, 3, 0]


@given(pairs_of_vertices)
def test_groups_by_edge_against_a_dictionary(pairs: list[tuple[int, int]]) -> None:
    start, end = (np.array([pair[i] for pair in pairs], dtype=np.int64) for i in range(2))
    order, bounds = by_edge(start, end)
    groups: dict[tuple[int, int], list[int]] = {}
    for h, (a, b) in enumerate(pairs):
        groups.setdefault((min(a, b), max(a, b)), []).append(h)
    expected = [groups[edge] for edge in sorted(groups)]
    assert [part.tolist() for part in np.split(order, bounds[1:-1])] == (expected or [[]])
    assert bounds.tolist() == np.cumsum([0, *map(len, expected)]).tolist()
    first, second = edges_of_two(order, bounds)
    assert list(map(list, zip(first, second, strict=True))) == [g for g in expected if len(g) == 2]


@given(strategies.complexes())
def test_opposites_are_pairs_on_one_edge(mesh: meshes.Arrays) -> None:
    F = mesh[1]
    opposite = pair_halfedges(F)
    paired = np.flatnonzero(opposite >= 0)
    assert (opposite[opposite[paired]] == paired).all()
    assert (opposite[paired] != paired).all()
    edges = [frozenset(edge) for edge in zip(*(a.tolist() for a in ends(F)), strict=True)]
    assert all(edges[h] == edges[opposite[h]] for h in paired)
    # Of each edge the first two half-edges, and no others.
    count = collections.Counter(edges)
    assert len(paired) == sum(2 for number in count.values() if number >= 2)


def test_exact_positions_have_a_sign_of_zero() -> None:
    V = np.array([[0.0, 0, 0], [-0.0, 0, 0], [0, 0, 0]])
    assert weld(V)[1].tolist() == [0, 0, 0]
    assert weld(V, exact=True)[1].tolist() == [0, 1, 0]
