"""Manifolds that are sound or not, and the faces of a complex that is made of one."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import pytest
import strategies
from hypothesis import given

from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._shape.manifold import Manifold, complex_faces, trivial

MANIFOLDS = {name: mesh for name, mesh in meshes.every().items() if name != "three_pages"}


def compact(F):
    """Faces over the vertices that they have, and how many these are."""
    used, faces = np.unique(F, return_inverse=True)
    return faces.reshape(-1, 3), len(used)


@pytest.mark.parametrize("name", MANIFOLDS)
def test_manifolds_are_sound(name: str) -> None:
    assert Manifold(*compact(MANIFOLDS[name][1])).is_sound


@given(strategies.surfaces(), strategies.SMALL)
def test_one_reversed_face_is_not_sound(mesh: meshes.Arrays, at: int) -> None:
    F, n = compact(mesh[1])
    assert Manifold(F, n).is_sound
    turned = F.copy()
    turned[at % len(F)] = turned[at % len(F), ::-1]
    alone = (pair_halfedges(F).reshape(-1, 3)[at % len(F)] < 0).all()
    assert Manifold(turned, n).is_sound == alone


@pytest.mark.parametrize("name", ["hourglass", "bow_tie"])
def test_two_fans_at_a_vertex_are_not_sound(name: str) -> None:
    F, n = compact(meshes.complexes()[name][1])
    assert not Manifold(F, n).is_sound
    assert Manifold(F, n + 1).is_sound  # as many fans as vertices: the vertex is there twice


def test_a_complex_without_stitches_is_its_manifold() -> None:
    F = np.array([[0, 1, 2], [2, 1, 3]])
    assert trivial(4, 2).is_trivial
    assert complex_faces(F, trivial(4, 2)) is F


def test_faces_of_a_complex_by_hand() -> None:
    """Vertices 0 and 4 at one point; a face reversed, two repeats of another, one degenerate."""
    F = np.array([[0, 1, 2], [2, 3, 4]])
    stitches = replace(
        trivial(5, 2),
        points=np.array([0, 1, 2, 3, 0]),
        reversed=np.array([False, True]),
        repeated=np.array([0, 0]),
        against=np.array([False, True]),
        degenerate=np.array([[3, 1]]),
    )
    assert not stitches.is_trivial
    faces = [[0, 1, 2], [2, 0, 3], [0, 1, 2], [0, 2, 1], [3, 3, 1]]
    assert complex_faces(F, stitches).tolist() == faces


@pytest.mark.parametrize(
    "change",
    [
        {"points": np.array([0, 1, 2, 2])},
        {"reversed": np.array([True, False])},
        {"repeated": np.array([1]), "against": np.array([True])},
        {"degenerate": np.array([[0, 0]])},
    ],
    ids=lambda change: next(iter(change)),
)
def test_any_stitch_makes_another_complex(change: dict[str, np.ndarray]) -> None:
    assert not replace(trivial(4, 2), **change).is_trivial
