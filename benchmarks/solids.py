"""Solids by formulas: meshes of polygons, counter-clockwise seen from outside."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from typing import Final

import numpy as np

from deltamesh_formats.array_types import Bools, Floats

Polygons = list[list[int]]
Solid = tuple[Floats, Polygons]

GOLDEN: Final = (1 + 5**0.5) / 2
# Of whatever is random in what is made of solids.
SEED: Final = 2006


def prism(outline: Sequence[tuple[float, float]], height: float) -> Solid:
    """Return a prism over an outline, which runs counter-clockwise; its caps are two polygons."""
    n, base = len(outline), np.array(outline, dtype=float)
    V = np.concatenate([np.column_stack((base, np.full(n, z))) for z in (0.0, height)])
    sides = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    return V, [list(range(n))[::-1], list(range(n, 2 * n)), *sides]


def regular(n: int, radius: float) -> list[tuple[float, float]]:
    """Return the corners of a regular polygon."""
    turns = 2 * np.pi * np.arange(n) / n
    return list(zip(radius * np.cos(turns), radius * np.sin(turns), strict=True))


def box(x: float, y: float, z: float) -> Solid:
    """Return a box with a corner at the origin."""
    return prism([(0, 0), (x, 0), (x, y), (0, y)], z)


def voxels(filled: Bools) -> Solid:
    """Return the quads between filled cubes and others, each vertex once."""
    cubes = np.pad(filled, 1)
    corners, quads = [], []
    for axis in range(3):
        u, v = (np.eye(3, dtype=int)[(axis + k) % 3] for k in (1, 2))
        inside, beyond = cubes, np.roll(cubes, -1, axis=axis)
        for turned, faces in ((False, inside & ~beyond), (True, ~inside & beyond)):
            at = np.argwhere(faces)
            at[:, axis] += 1
            quad = np.stack((at, at + u, at + u + v, at + v), axis=1)
            quads.append(quad[:, ::-1] if turned else quad)
    corners = np.concatenate(quads).reshape(-1, 3)
    V, index = np.unique(corners, axis=0, return_inverse=True)
    return V.astype(float) - 1, index.reshape(-1, 4).tolist()


def grid(m: int, n: int, height: Callable[[Floats, Floats], Floats]) -> Solid:
    """Return m x n vertices over the unit square in quads, at heights above it."""
    x, y = np.meshgrid(np.linspace(0, 1, m), np.linspace(0, 1, n), indexing="ij")
    i = np.arange(m * n).reshape(m, n)
    quads = np.stack((i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]), axis=-1)
    V = np.stack((x, y, height(x, y)), axis=-1).reshape(-1, 3)
    return V, quads.reshape(-1, 4).tolist()


def swept(rings: Floats, closed: bool) -> Solid:
    """Return the quads between rings of vertices, float64 (k, n, 3); closed from last to first."""
    k, n, _ = rings.shape
    i = np.arange(k * n).reshape(k, n)
    after = np.roll(i, -1, axis=0) if closed else i[1:]
    before = i if closed else i[:-1]
    quads = np.stack(
        (before, np.roll(before, -1, axis=1), np.roll(after, -1, axis=1), after), axis=-1
    )
    return rings.reshape(-1, 3), quads.reshape(-1, 4).tolist()


def cylinder(n: int, m: int, radius: float, height: float) -> Solid:
    """Return a cylinder of m rings of n vertices with polygons as caps."""
    rings = np.array([[(x, y, z) for x, y in regular(n, radius)] for z in height * np.arange(m)])
    V, quads = swept(rings / [1, 1, max(m - 1, 1)], closed=False)
    top = (m - 1) * n
    return V, [*quads, list(range(n))[::-1], list(range(top, top + n))]


def tube(n: int, inner: float, outer: float, height: float) -> Solid:
    """Return a hollow cylinder, open at both ends, of walls between two radii."""
    profile = ((outer, 0.0), (outer, height), (inner, height), (inner, 0.0))
    rings = np.array([[(x, y, z) for x, y in regular(n, r)] for r, z in profile])
    return swept(rings, closed=True)


def wire(n: int, radius: float) -> Solid:
    """Return a thin closed wire around a helix that has been bent to a ring."""
    t = 2 * np.pi * np.arange(n) / n
    ring = 1 + 0.2 * np.cos(7 * t)
    centre = np.stack((ring * np.cos(t), ring * np.sin(t), 0.2 * np.sin(7 * t)), axis=1)
    along = np.roll(centre, -1, axis=0) - np.roll(centre, 1, axis=0)
    side = np.cross(along, centre)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    up = np.cross(along, side)
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    turn = np.array(regular(6, radius))[None, :, :, None]
    rings = centre[:, None] + turn[:, :, 0] * side[:, None] + turn[:, :, 1] * up[:, None]
    return swept(rings, closed=True)


def platonic(name: str) -> Solid:
    """Return a Platonic solid whose vertices are at the usual coordinates."""
    signs = np.array(list(product((-1.0, 1.0), repeat=3)))
    cyclic = [np.roll(v, k) for k in range(3) for v in product((0.0,), (-1.0, 1.0), (-1.0, 1.0))]
    icosahedron = np.array([v * np.roll([0, 1, GOLDEN], i // 4) for i, v in enumerate(cyclic)])
    flat = np.array([v * np.roll([0, 1 / GOLDEN, GOLDEN], i // 4) for i, v in enumerate(cyclic)])
    V = {
        "tetrahedron": signs[[0, 3, 5, 6]],
        "cube": signs,
        "octahedron": np.concatenate((np.eye(3), -np.eye(3))),
        "dodecahedron": np.concatenate((signs, flat)),
        "icosahedron": icosahedron,
    }[name]
    return V, hull(V)


def hull(V: Floats) -> Polygons:
    """Return the faces of the convex hull of a few vertices around the origin, all on it."""
    found: dict[tuple[int, ...], list[int]] = {}
    for i, j, k in product(range(len(V)), repeat=3):
        normal = np.cross(V[j] - V[i], V[k] - V[i])
        if not normal.any() or normal @ V[i] < 1e-9:
            continue
        reach = (V - V[i]) @ normal
        if reach.max() < 1e-9:
            on = np.flatnonzero(reach > -1e-9)
            middle = V[on].mean(axis=0)
            first = V[on[0]] - middle
            other = np.cross(normal / np.linalg.norm(normal), first)
            turn = np.arctan2((V[on] - middle) @ other, (V[on] - middle) @ first)
            found.setdefault(tuple(on), on[np.argsort(turn)].tolist())
    return list(found.values())


def ball(levels: int, radius: float = 1.0) -> Solid:
    """Return a sphere: an icosahedron with each face split in four, `levels` times."""
    V, polygons = platonic("icosahedron")
    F = np.array(polygons)
    for _ in range(levels):
        halves = np.stack([V[F[:, i]] + V[F[:, (i + 1) % 3]] for i in range(3)], axis=1)
        a, b, c = V[F].transpose(1, 0, 2)
        ab, bc, ca = halves.transpose(1, 0, 2) / 2
        parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        soup = np.concatenate([np.stack(part, axis=1) for part in parts]).reshape(-1, 3)
        V, index = np.unique(soup.round(12), axis=0, return_inverse=True)
        F = index.reshape(-1, 3)
        V = V / np.linalg.norm(V, axis=1, keepdims=True)
    return radius * V / np.linalg.norm(V[0]), F.tolist()


def union(*solids: Solid) -> Solid:
    """Return all of them, side by side."""
    starts = np.cumsum([0, *(len(V) for V, _ in solids)])
    polygons = [
        [int(i + start) for i in polygon]
        for (_, found), start in zip(solids, starts, strict=False)
        for polygon in found
    ]
    return np.concatenate([V for V, _ in solids]), polygons


def moved(solid: Solid, by: Sequence[float] | Floats, scale: float = 1.0) -> Solid:
    """Return a solid scaled, and then moved."""
    return scale * solid[0] + np.asarray(by), solid[1]


def turned_over(solid: Solid) -> Solid:
    """Return a solid with its faces seen from the other side, such as a cavity."""
    return solid[0], [polygon[::-1] for polygon in solid[1]]


def voxels_of(size: tuple[int, int, int], *blocks: Sequence[slice]) -> Solid:
    """Return the quads around blocks of cubes in a space of that many."""
    filled = np.zeros(size, dtype=bool)
    for block in blocks:
        filled[tuple(block)] = True
    return voxels(filled)
