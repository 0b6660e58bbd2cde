"""Welding and the closed manifold."""

from __future__ import annotations

import meshes
import numpy as np
import pytest

from deltamesh._graph.halfedges import pair_halfedges, weld
from deltamesh._shape.topology import build_topology


def topology(faces, n=None):
    F = np.array(faces, dtype=np.int64)
    n = int(F.max()) + 1 if n is None else n
    return build_topology(F, pair_halfedges(F), n)


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


@pytest.mark.parametrize("name", sorted(set(meshes.every()) - {"three_pages"}))
def test_opposites_and_valences(name):
    V, F = meshes.every()[name]
    t = topology(F, len(V))
    start, end = t.faces.ravel(), np.roll(t.faces, -1, axis=1).ravel()
    assert (t.opposite[t.opposite] == np.arange(len(start))).all()
    assert (start[t.opposite] == end).all()
    neighbours = [set() for _ in t.valence]
    for a, b in zip(start.tolist(), end.tolist(), strict=True):
        neighbours[a].add(b)
    assert [len(s) for s in neighbours] == t.valence.tolist()


def test_each_boundary_loop_gets_a_vertex():
    t = topology([[0, 1, 2]])
    assert (t.loop_count, t.boundary_edge_count, t.face_count) == (1, 3, 1)
    V, grid = meshes.grid(6, 6)
    middle = np.argmin(np.linalg.norm(V - V.mean(axis=0), axis=1))
    assert topology(grid[(grid != middle).all(axis=1)], len(V)).loop_count == 2


def test_pairs_on_a_boundary_have_no_opposite():
    assert (pair_halfedges(np.array([[0, 1, 2]])) == -1).all()
