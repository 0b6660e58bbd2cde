"""Small generated meshes: functions that return (vertices, faces), closed unless they say else.

Vertices are float64 (n, 3), faces int64 (m, 3), counter-clockwise seen from outside.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from deltamesh._mesh import TriangleMesh, triangulated
from deltamesh_formats.meshfiles.files import read_mesh
from deltamesh_formats.meshfiles.formats import EXTENSIONS
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles

Arrays = tuple[NDArray[np.float64], NDArray[np.int64]]


def tetrahedron() -> Arrays:
    vertices = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    return vertices, np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])


def icosphere(levels: int) -> Arrays:
    """Unit sphere: icosahedron with each face split in four, `levels` times; 10 * 4^levels + 2."""
    golden = (1 + 5**0.5) / 2
    near = [(0.0, s, t * golden) for s in (-1.0, 1.0) for t in (-1.0, 1.0)]
    vertices = [np.roll(v, turn) for turn in range(3) for v in near]
    V = np.array(vertices) / np.hypot(1, golden)
    # A face is three vertices at the least distance from each other, turned outwards.
    close = np.linalg.norm(V[:, None] - V[None], axis=2) < 1.1
    faces = [
        (i, j, k) if np.linalg.det(V[[i, j, k]]) > 0 else (i, k, j)
        for i in range(12)
        for j in range(i + 1, 12)
        for k in range(j + 1, 12)
        if close[i, j] and close[j, k] and close[i, k]
    ]
    F = np.array(faces)
    for _ in range(levels):
        V, F = _split(V, F)
        V /= np.linalg.norm(V, axis=1, keepdims=True)
    return V, F


def _split(V: NDArray[np.float64], F: NDArray[np.int64]) -> Arrays:
    halves = np.sort(np.stack((F, np.roll(F, -1, axis=1)), axis=2).reshape(-1, 2), axis=1)
    pairs, inverse = np.unique(halves, axis=0, return_inverse=True)
    middle = len(V) + inverse.reshape(-1, 3)
    a, b, c = F.T
    ab, bc, ca = middle.T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    faces = np.concatenate([np.stack(part, axis=1) for part in parts])
    return np.concatenate((V, V[pairs].mean(axis=1))), faces


def torus(m: int, n: int) -> Arrays:
    """Radii 2 and 1, m x n quads halved; m, n >= 3 (5 and more for a simple neighbourhood)."""
    i, j = (x.ravel() for x in np.meshgrid(np.arange(m), np.arange(n), indexing="ij"))
    u, v = 2 * np.pi * i / m, 2 * np.pi * j / n
    ring = 2 + np.cos(v)
    vertices = np.stack((ring * np.cos(u), ring * np.sin(u), np.sin(v)), axis=1)
    here, right = i * n + j, (i + 1) % m * n + j
    up, both = i * n + (j + 1) % n, (i + 1) % m * n + (j + 1) % n
    return vertices, np.concatenate(
        (np.stack((here, right, both), axis=1), np.stack((here, both, up), axis=1))
    )


def double_torus() -> Arrays:
    """Genus 2: two tori, each without one face, joined along its edges."""
    V, F = torus(7, 6)
    n = len(V)
    a, b, c = F[0]
    mirrored = np.delete(F, 0, axis=0)[:, ::-1] + n
    faces = np.concatenate((np.delete(F, 0, axis=0), mirrored))
    label = np.arange(2 * n)
    label[[n + a, n + b, n + c]] = [a, b, c]
    keep = label == np.arange(2 * n)
    number = np.cumsum(keep) - 1
    vertices = np.concatenate((V, V * [1, -1, 1] + [0, 0, 4]))[keep]
    return vertices, number[label][faces]


def grid(m: int, n: int) -> Arrays:
    """Open disk, a gently curved rectangle of m x n vertices; m, n >= 2."""
    i, j = np.meshgrid(np.arange(m), np.arange(n), indexing="ij")
    x, y = i.ravel() / (m - 1), j.ravel() / (n - 1)
    corner = (i[:-1, :-1] * n + j[:-1, :-1]).ravel()
    lower = np.stack((corner, corner + n, corner + n + 1), axis=1)
    upper = np.stack((corner, corner + n + 1, corner + 1), axis=1)
    return np.stack((x, y, 0.2 * np.sin(5 * x) * y), axis=1), np.concatenate((lower, upper))


def union(*meshes: Arrays) -> Arrays:
    """All of the meshes side by side, as one of several components."""
    starts = np.cumsum([0] + [len(V) for V, _ in meshes])
    faces = [F + start for (_, F), start in zip(meshes, starts, strict=False)]
    return np.concatenate([V for V, _ in meshes]), np.concatenate(faces)


def two_components() -> Arrays:
    V, F = torus(8, 6)
    return union(icosphere(1), (V + np.array([5.0, 0, 0]), F))


def with_isolated(mesh: Arrays | None = None) -> Arrays:
    """A mesh, or a sphere, with four vertices on no face: first, amid, and the last two."""
    V, F = icosphere(1) if mesh is None else mesh
    places = np.array([0, 20, len(V), len(V)])
    number = np.arange(len(V)) + np.searchsorted(places, np.arange(len(V)), side="right")
    extra = np.array([[3.0, 0, 0], [0, 3, 0], [0, 0, 3], [0, 0, 4]])
    return np.insert(V, places, extra, axis=0), number[F]


def wild(mesh: Arrays) -> Arrays:
    """The mesh with random bits and extremes among its positions, of which no two are equal."""
    V, F = mesh
    rng = np.random.default_rng(1985)
    bits = rng.integers(-(2**63), 2**63 - 1, V.shape).view(np.float64)
    random = np.where(np.isfinite(bits) & (np.abs(bits) < 1e150), bits, V)
    extremes = rng.choice([0.0, -0.0, 5e-324, -2.2e-308, 1e150, -1e150], V.shape)
    share = rng.random(V.shape)
    share[:, 0] /= 2  # x stays as it is, or is random
    return np.where(share < 0.2, random, np.where(share > 0.8, extremes, V)), F


def three_pages() -> Arrays:
    """Three triangles on one edge."""
    vertices = np.array([[0.0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, -1, 0]])
    return vertices, np.array([[0, 1, 2], [0, 1, 3], [1, 0, 4]])


def moebius(n: int) -> Arrays:
    """A strip of n quads, turned by a half."""
    i = np.repeat(np.arange(n), 2)
    u, v = 2 * np.pi * i / n, np.tile([-0.4, 0.4], n)
    ring = 1 + v * np.cos(u / 2)
    V = np.stack((ring * np.cos(u), ring * np.sin(u), v * np.sin(u / 2)), axis=1)
    low, high = 2 * np.arange(n), 2 * np.arange(n) + 1
    after, above = np.append(low[1:], 1), np.append(high[1:], 0)
    first, second = np.stack((low, after, above), axis=1), np.stack((low, above, high), axis=1)
    return V, np.concatenate((first, second))


def hourglass() -> Arrays:
    """Two tetrahedra that share a vertex: vertex 0."""
    V, F = tetrahedron()
    return np.concatenate((V, V[1:] + 9.0)), np.concatenate((F, np.where(F > 0, F + 3, 0)))


def bow_tie() -> Arrays:
    """Two triangles that share a vertex: vertex 2."""
    V = np.random.default_rng(2).normal(size=(5, 3))
    return V, np.array([[0, 1, 2], [2, 3, 4]])


def crossing() -> Arrays:
    """Two sheets that cross in a line: edges of four faces."""
    V, F = grid(5, 5)
    upright = np.stack((V[:, 0], V[:, 2] + V[12, 1], V[:, 1] - V[12, 1]), axis=1)
    V = np.concatenate((V * [1, 1, 0], upright * [1, 0, 1] + [0, V[12, 1], 0]))
    F = np.concatenate((F, F + 25))
    first, number = np.unique(np.round(V, 9), axis=0, return_index=True, return_inverse=True)[1:]
    return V[first], number.reshape(-1)[F]


def doubled() -> Arrays:
    """Every face twice, turned over; some three times."""
    V, F = grid(5, 4)
    return V, np.concatenate((F, F[:, ::-1], F[3:7, [1, 2, 0]]))


def with_degenerate() -> Arrays:
    """Faces that repeat vertices, one of them in no other face."""
    V, F = icosphere(0)
    more = [[0, 0, F[0, 1]], [3, 8, 3], [5, 5, 5], [12, 12, 2], [12, 12, 12], [7, 7, 2]]
    return np.concatenate((V, [[2.0, 0, 1]])), np.concatenate((F[:9], more, F[9:]))


def mixed_winding() -> Arrays:
    """A torus with a third of its faces turned over."""
    V, F = torus(8, 6)
    turned = np.random.default_rng(3).random(len(F)) < 0.3
    return V, np.where(turned[:, None], F[:, ::-1], F)


def seams() -> Arrays:
    """A torus with copies of vertices along two circles, and a cut of one; a copy in no face."""
    V, F = torus(8, 6)
    middle = V[F].mean(axis=1)
    part = (middle[:, 1] > 0).astype(int) + 2 * ((middle[:, 0] > 0) & (middle[:, 2] > 0))
    keys, number = np.unique(4 * F + part[:, None], return_inverse=True)
    V = np.concatenate((V[keys // 4], V[[3, 3, 11]], [[3.0, 3, 3], [3, 3, 3]]))
    return V, number.reshape(-1, 3)


def soup() -> Arrays:
    """Every corner a vertex of its own."""
    V, F = icosphere(1)
    return V[F].reshape(-1, 3), np.arange(F.size).reshape(-1, 3)


def collapsed() -> Arrays:
    """No face with an area: one on an edge, one in a point; and an isolated vertex."""
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 2, 0]])
    return V, np.array([[0, 1, 0], [2, 3, 2]])


def complexes() -> dict[str, Arrays]:
    """What is no oriented manifold, or has several vertices at one position, by name."""
    return {
        "moebius": moebius(9),
        "hourglass": hourglass(),
        "bow_tie": bow_tie(),
        "three_pages": three_pages(),
        "crossing": crossing(),
        "doubled": doubled(),
        "with_degenerate": with_degenerate(),
        "mixed_winding": mixed_winding(),
        "seams": seams(),
        "soup": soup(),
        "collapsed": collapsed(),
    }


def every() -> dict[str, Arrays]:
    """All of them by name, for parametrization."""
    return {
        "tetrahedron": tetrahedron(),
        "icosphere": icosphere(2),
        "torus": torus(9, 7),
        "double_torus": double_torus(),
        "grid": grid(7, 9),
        "two_components": two_components(),
        "with_isolated": with_isolated(),
        "three_pages": three_pages(),
    }


def shuffled(
    V: NDArray[np.float64], F: NDArray[np.int64], seed: int
) -> tuple[TriangleMesh, NDArray[np.int64]]:
    """The same mesh with vertices and faces in another order and faces rotated; the map to it."""
    rng = np.random.default_rng(seed)
    to = rng.permutation(len(V))
    turns = (np.arange(3) + rng.integers(0, 3, (len(F), 1))) % 3
    faces = np.take_along_axis(to[F], turns, axis=1)[rng.permutation(len(F))]
    vertices = np.empty_like(V)
    vertices[to] = V
    return TriangleMesh(vertices, faces), to


def as_polymesh(mesh: TriangleMesh) -> PolyMesh:
    return from_triangles(mesh.vertices, mesh.faces)


def folder() -> Path:
    """Where larger meshes are, if anywhere: tests that want one skip without it."""
    beside = Path(__file__).parents[3] / "shared" / "meshes"
    return Path(os.environ.get("DELTAMESH_MESHES", beside))


def names(most_bytes: int) -> list[str]:
    """The mesh files of the folder, but for the largest; none where there is no folder."""
    files = (
        path for path in sorted(folder().rglob("*.*")) if path.suffix[1:].lower() in EXTENSIONS
    )
    return [
        path.relative_to(folder()).as_posix() for path in files if path.stat().st_size <= most_bytes
    ]


def large_are_slow(files: Iterable[str], most_bytes: int = 800_000, place: str = "{}") -> list[Any]:
    """Files of the folder as parameters of a test, which is slow for those of more bytes.

    `place` makes the name of a file of a parameter.
    """
    parameters = []
    for name in files:
        path = folder() / place.format(name)
        large = path.exists() and path.stat().st_size > most_bytes
        parameters.append(pytest.param(name, marks=[pytest.mark.slow] * large))
    return parameters


def real(name: str) -> TriangleMesh:
    """A mesh of the folder; the test that asks is skipped where it is not there."""
    return triangulated(real_whole(name))


def real_whole(name: str) -> PolyMesh:
    """Likewise, with its attributes."""
    path = folder() / name
    if not path.exists():
        pytest.skip(f"no {path}: DELTAMESH_MESHES names the folder of larger meshes")
    return read_mesh(path)
