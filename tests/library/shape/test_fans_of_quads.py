"""Fans that the polygons of a mesh are cut into: quads with parallel diagonals."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from polygon_meshes import quad_torus

from deltamesh._shape.diagonals import cut_polygons, middles
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.polymesh.triangles import fans


def fan(corners: list[int], middle: int) -> list[tuple[int, int, int]]:
    turned = corners[middle:] + corners[:middle]
    return [(turned[0], turned[i], turned[i + 1]) for i in range(1, len(corners) - 1)]


def slow_fans(mesh: PolyMesh) -> list[tuple[int, int, int]]:
    """Polygon by polygon, the fans of all its corners one after the other."""
    found = []
    for begin, end in zip(mesh.offsets[:-1], mesh.offsets[1:], strict=True):
        corners = mesh.corners[begin:end].tolist()

        def score(middle: int, corners: list[int] = corners) -> float:
            V = mesh.vertices
            faces = fan(corners, middle)
            normals = [np.cross(V[b] - V[a], V[c] - V[a]) for a, b, c in faces]
            return min(float(n @ np.sum(normals, axis=0)) for n in normals)

        scores = [score(i) for i in range(len(corners))]
        middle = 0 if scores[0] > 0 or len(corners) > 16 else int(np.argmax(scores))
        found += fan(corners, middle)
    return found


@given(st.data(), st.integers(0, 10**6))
def test_fans_are_the_slow_ones(data: st.DataObject, seed: int) -> None:
    """On a grid of whole numbers, where sums are exact and ties are ties."""
    rng = np.random.default_rng(seed)
    sizes = data.draw(st.lists(st.integers(3, 20), min_size=1, max_size=6))
    vertices = rng.integers(-4, 5, size=(12, 3)).astype(float)
    offsets = np.concatenate(([0], np.cumsum(sizes)))
    mesh = PolyMesh(vertices, rng.integers(0, 12, size=sum(sizes)), offsets)
    around = middles(mesh.vertices, mesh.corners, mesh.offsets)
    cut = fans(mesh.corners, mesh.offsets, around)
    assert list(map(tuple, cut.faces.tolist())) == slow_fans(mesh)


def test_diagonals_of_a_grid_run_in_parallel() -> None:
    mesh = quad_torus(8, 6)
    faces = cut_polygons(mesh).faces
    assert (np.bincount(faces.ravel()) == 6).all()
