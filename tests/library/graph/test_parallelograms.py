"""Parallelograms that predict a vertex, and their order."""

from __future__ import annotations

import meshes
import oracle
from coders import corners_of

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
