"""Meshes of polygons, made by hand and by hypothesis."""

from __future__ import annotations

import meshes
import numpy as np
import strategies
from hypothesis import strategies as st

from deltamesh_formats.polymesh.mesh import PolyMesh


def mesh_of(V, polygons):
    """A mesh of lists of vertex indices."""
    sizes = [len(p) for p in polygons]
    corners = np.array([v for p in polygons for v in p], dtype=np.int64)
    offsets = np.concatenate(([0], np.cumsum(sizes))).astype(np.int64)
    return PolyMesh(np.asarray(V, dtype=np.float64), corners, offsets)


def lists_of(mesh):
    """The polygons as lists of vertex indices."""
    return [row.tolist() for row in np.split(mesh.corners, mesh.offsets[1:-1])]


def quads(m, n):
    """A curved rectangle of m x n vertices, of quads that begin anywhere."""
    V, _ = meshes.grid(m, n)
    rng = np.random.default_rng(m * n)
    corner = [i * n + j for i in range(m - 1) for j in range(n - 1)]
    polygons = [np.roll([c, c + n, c + n + 1, c + 1], rng.integers(4)).tolist() for c in corner]
    return mesh_of(V, polygons)


def quad_torus(m, n):
    V, F = meshes.torus(m, n)
    lower, upper = np.split(F, 2)
    return mesh_of(V, np.column_stack([lower, upper[:, 2]]).tolist())


def prism(k):
    """Two polygons of k corners, and quads between them."""
    u = 2 * np.pi * np.arange(k) / k
    ring = np.stack([np.cos(u), np.sin(u), 0 * u], axis=1)
    sides = [[i, (i + 1) % k, k + (i + 1) % k, k + i] for i in range(k)]
    ends = [list(range(k))[::-1], list(range(k, 2 * k))]
    return mesh_of(np.concatenate([ring, ring + np.array([0, 0, 1])]), ends + sides)


def moebius(n):
    V, _ = meshes.moebius(n)
    strip = [[2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1] for i in range(n - 1)]
    return mesh_of(V, [*strip, [2 * n - 2, 1, 0, 2 * n - 1]])


def doubled():
    """Each quad twice, turned over, and begun elsewhere: cut along the other diagonal."""
    mesh = quads(5, 4)
    polygons = lists_of(mesh)
    over = [p[::-1] for p in polygons]
    return mesh_of(mesh.vertices, [*polygons, *over, *polygons[:3], *[p[1:] + p[:1] for p in over]])


def tetrahedra():
    """Quads around four points each, through which other quads run, too: edges of many faces."""
    rng = np.random.default_rng(7)
    V = rng.normal(size=(9, 3))
    return mesh_of(V, [rng.permutation(9)[:4].tolist() for _ in range(60)])


def repeated_vertices():
    V = np.random.default_rng(3).normal(size=(7, 3))
    polygons = [[0, 1, 2, 1], [0, 0, 1, 2], [3, 3, 3, 3], [4, 5, 4, 5, 6], [0, 1, 2, 0, 1, 2]]
    return mesh_of(V, [*polygons, *polygons, [1, 2, 1, 0], [6, 5, 3]])


def mixed():
    """Triangles, quads, a pentagon; two pieces; vertices in no face, and at one place."""
    V = np.random.default_rng(5).normal(size=(14, 3))
    V[12] = V[3]
    polygons = [[0, 1, 2, 3], [3, 2, 4], [2, 1, 5, 6, 4], [7, 8, 9, 10], [12, 0, 5]]
    return mesh_of(V, polygons)


MADE = {
    "quads": quads(9, 7),
    "torus": quad_torus(9, 8),
    "prism": prism(7),
    "fan": prism(40),
    "moebius": moebius(9),
    "doubled": doubled(),
    "tetrahedra": tetrahedra(),
    "repeated_vertices": repeated_vertices(),
    "mixed": mixed(),
}


@st.composite
def soups(draw: st.DrawFn) -> PolyMesh:
    """Polygons of any kind: over few vertices, or those of a surface, joined at random."""
    seed = draw(strategies.SMALL)
    rng = np.random.default_rng(seed)
    if draw(st.booleans()):
        n = draw(st.integers(1, 12))
        vertex = st.integers(0, n - 1)
        some = st.lists(st.lists(vertex, min_size=3, max_size=7), min_size=1, max_size=25)
        polygons, V = draw(some), rng.normal(size=(n, 3))
    else:
        V, F = draw(strategies.surfaces())
        polygons = grown(F, draw(st.integers(3, 7)), rng)
    again = [p for p in polygons if rng.random() < draw(st.sampled_from([0.0, 0.2, 1.0]))]
    polygons = [*polygons, *again]
    share = draw(st.sampled_from([0.0, 0.3]))
    polygons = [p[::-1] if rng.random() < share else p for p in polygons]
    polygons = [np.roll(p, rng.integers(len(p))).tolist() for p in polygons]
    if draw(st.booleans()):
        V = rng.integers(0, 3, V.shape).astype(float)
    order = rng.permutation(len(polygons))
    return mesh_of(V, [polygons[i] for i in order])


def grown(F, most, rng):
    """Polygons of up to `most` corners, each of faces that are neighbours."""
    todo = {tuple(f) for f in F.tolist()}
    polygons = []
    while todo:
        polygon = list(todo.pop())
        for face in list(todo):
            if len(polygon) >= most or rng.random() < 0.2:
                break
            shared = [
                (i, face[j - 2])
                for i in range(len(polygon))
                for j in range(3)
                if (polygon[i - 1], polygon[i]) == (face[j], face[j - 1])
            ]
            if shared:
                todo.remove(face)
                polygon.insert(*shared[0])
        polygons.append(polygon)
    return polygons


def canonical(mesh, names=None):
    """The polygons as a multiset, each in the least of its rotations."""
    names = range(len(mesh.vertices)) if names is None else names
    rows = [[names[v] for v in p] for p in lists_of(mesh)]
    return sorted(min(tuple(p[i:] + p[:i]) for i in range(len(p))) for p in rows)
