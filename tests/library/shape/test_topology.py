"""Closed manifold that the coder of the connectivity visits."""

from __future__ import annotations

import meshes
import numpy as np
import pytest

from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._shape.topology import build_topology


def topology(faces, n=None):
    F = np.array(faces, dtype=np.int64)
    n = int(F.max()) + 1 if n is None else n
    return build_topology(F, pair_halfedges(F), n)


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
