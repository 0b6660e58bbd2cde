"""Walk over two meshes at once, against its twin."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import strategies
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._kernels.mesh.correspondence import assign, propagate


def maps_of(n: int, m: int) -> tuple[np.ndarray, ...]:
    """Empty maps of vertices and of half-edges with their inverses, and logs."""
    none = (np.full(size, -1, dtype=np.int64) for size in (n, n, m, m))
    return (*none, np.empty(n, dtype=np.int64), np.empty(m, dtype=np.int64))


@strategies.SOME
@given(strategies.surfaces(), strategies.SMALL, st.booleans(), st.booleans())
def test_patches_are_those_of_the_oracle(
    mesh: meshes.Arrays, seed: int, coloured: bool, damaged: bool
) -> None:
    V, F = mesh
    n, m, rng = len(V), len(F), np.random.default_rng(seed)
    other, to = meshes.shuffled(V, F, seed)
    G = other.faces.copy()
    if damaged:
        G[0] = rng.permutation(n)[:3] if n > 3 else G[0, [0, 2, 1]]
    colours = rng.integers(0, 2, n) if coloured else np.zeros(n, dtype=np.int64)
    other_colours = np.empty_like(colours)
    other_colours[to] = colours
    left = F.ravel(), pair_halfedges(F), colours
    right = G.ravel(), pair_halfedges(G), other_colours
    h = int(rng.integers(3 * m))
    a, b = to[F.ravel()[h]], to[np.roll(F, -1, axis=1).ravel()[h]]
    ends = (G.ravel() == a) & (np.roll(G, -1, axis=1).ravel() == b)
    matches = np.flatnonzero(ends).tolist()
    for g in [*matches, int(rng.integers(3 * m))]:
        state = maps_of(n, m)
        same = propagate(*left, *right, h, g, *state)
        lists = [array.tolist() for array in (*left, *right)]
        expected = oracle.patch(*lists, h, g)
        assert same == (expected is not None)
        vertices, inverse, halfedges, inverse_halfedges = state[:4]
        if expected is None:
            assert all((array == -1).all() for array in state[:4])
            continue
        pairs, turned = expected
        assert {v: w for v, w in enumerate(vertices.tolist()) if w >= 0} == pairs
        assert {f: e for f, e in enumerate(halfedges.tolist()) if e >= 0} == {
            h // 3: g for h, g in turned.items() if h % 3 == 0
        }
        assert all(inverse[w] == v for v, w in pairs.items())
        assert all(inverse_halfedges[e // 3] == f for f, e in enumerate(halfedges) if e >= 0)
    if not damaged and not coloured:
        assert matches


def test_a_pair_is_one_to_one() -> None:
    mapping, inverse, log = np.full(3, -1), np.full(3, -1), np.empty(3, dtype=np.int64)
    assert assign(0, 2, mapping, inverse, log, 0) == 1
    assert assign(0, 2, mapping, inverse, log, 1) == 1  # known already
    assert assign(0, 1, mapping, inverse, log, 1) == -1
    assert assign(1, 2, mapping, inverse, log, 1) == -1
    assert log[0] == 0
