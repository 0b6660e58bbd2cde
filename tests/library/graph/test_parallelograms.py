"""Parallelograms that predict a vertex, and their order."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import strategies
from coders import corners_of
from hypothesis import given

from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._graph.parallelograms import parallelograms

MESHES = meshes.every()


def test_parallelograms_equal_their_oracle() -> None:
    for V, F in MESHES.values():
        if F is MESHES["three_pages"][1]:
            continue
        first, corners, _ = parallelograms(F, len(V))
        expected = oracle.parallelograms(F)
        for i in range(len(V)):
            rows = corners[first[i] : first[i + 1]].tolist()
            assert sorted(map(tuple, rows)) == sorted(expected.get(i, []))


def test_the_order_of_the_parallelograms() -> None:
    """By their faces: of gates alike, the first counts."""
    V, F = meshes.torus(9, 7)
    for i, rows in corners_of(F, len(V)).items():
        faces = [sorted((a, b, i)) for a, b, _ in rows]
        places = [next(k for k, f in enumerate(F.tolist()) if sorted(f) == face) for face in faces]
        assert places == sorted(places)


def test_quads_come_first_and_predict_their_last_corner() -> None:
    """A quad that is cut into two triangles, and a further triangle beside it."""
    F, quads = np.array([[0, 1, 2], [0, 2, 3], [3, 2, 4]]), np.array([[0, 1, 2, 3]])
    first, corners, within = parallelograms(F, 6, quads)
    assert first.tolist() == [0, 0, 0, 0, 2, 3, 3]
    assert within.tolist() == [0, 0, 0, 1, 0, 0]
    quad, across, last = (row.tolist() for row in corners)
    assert sorted(quad[:2]) == [0, 2]
    assert quad[2] == 1
    assert sorted(across[:2]) == [0, 2]
    assert across[2] == 1
    assert (sorted(last[:2]), last[2]) == ([2, 3], 0)


@given(strategies.surfaces(), strategies.SMALL)
def test_parallelograms_need_no_opposites(mesh: meshes.Arrays, seed: int) -> None:
    V, F = mesh
    quads = np.random.default_rng(seed).integers(0, len(V), (3, 4))
    found = parallelograms(F, len(V), quads), parallelograms(F, len(V), quads, pair_halfedges(F))
    for one, other in zip(*found, strict=True):
        np.testing.assert_array_equal(one, other)
    first, corners, _ = found[0]
    assert (corners.max(axis=1, initial=-1) < np.repeat(np.arange(len(V)), np.diff(first))).all()
