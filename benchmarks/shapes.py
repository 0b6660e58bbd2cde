"""Shapes and scenes by formulas: what CAD programs and games make, where bounds are hard to keep.

Shapes are small and have large faces, right angles or thin walls: a shape may keep all of its
angles and still lose its size. Scenes have parts of unlike size: what bounds the whole says little
of a small part. All are meshes of polygons, counter-clockwise seen from outside.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Final

import numpy as np

from deltamesh_formats.array_types import Bools, Floats
from deltamesh_formats.polymesh.arrays import from_arrays
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh, from_triangles

Polygons = list[list[int]]
Solid = tuple[Floats, Polygons]

GOLDEN: Final = (1 + 5**0.5) / 2
SEED: Final = 2006


# ---- Shapes ------------------------------------------------------------------------------------


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


def comb(count: int) -> Solid:
    """Return a comb of that many teeth."""
    teeth = [
        point
        for x in reversed(range(count))
        for point in ((x + 0.5, 1.0), (x + 0.5, 5.0), (x, 5.0), (x, 1.0))
    ]
    return prism([(0.0, 0.0), (count - 0.5, 0.0), *teeth], 0.4)


def stair(count: int) -> Solid:
    """Return a stair of that many steps."""
    treads = [point for i in range(count, 0, -1) for point in ((i, i), (i - 1.0, i))]
    return prism([(0.0, 0.0), (count, 0.0), *treads], 2.0)


def _bump(x: Floats, y: Floats) -> Floats:
    return 0.02 * np.exp(-((x - 0.3) ** 2 + (y - 0.6) ** 2) / 0.02**2)


def _flat(x: Floats, y: Floats) -> Floats:
    return 0 * x


def _waves(x: Floats, y: Floats) -> Floats:
    return 0.1 * np.sin(5 * x) * np.cos(4 * y)


_ALL: Final = slice(None)
_L: Final = ((0, 0), (6, 0), (6, 1), (1, 1), (1, 4), (0, 4))

SHAPES: Final[Mapping[str, Callable[[], Solid]]] = {
    "box": lambda: box(3, 2, 1),
    "box of cubes": lambda: voxels_of((9, 6, 3), [_ALL] * 3),
    "thin plate": lambda: box(1, 1, 1e-4),
    "plate of cubes": lambda: voxels_of((30, 20, 1), [_ALL] * 3),
    "rod 1:10000": lambda: box(1e4, 1, 1),
    "rod of cubes": lambda: voxels_of((150, 1, 1), [_ALL] * 3),
    "L profile": lambda: prism(_L, 10),
    "L of cubes": lambda: voxels_of(
        (8, 6, 12), [slice(0, 2), _ALL, _ALL], [_ALL, slice(0, 2), _ALL]
    ),
    "stair": lambda: stair(12),
    "comb": lambda: comb(20),
    "boxes at an edge": lambda: voxels_of(
        (4, 4, 2), [slice(0, 2), slice(0, 2), _ALL], [slice(2, 4), slice(2, 4), _ALL]
    ),
    "boxes at a corner": lambda: voxels_of((2, 2, 2), [slice(0, 1)] * 3, [slice(1, 2)] * 3),
    "cavity": lambda: union(box(4, 4, 4), moved(turned_over(box(1, 1, 1)), (2, 1, 1))),
    "mirrored copy": lambda: union(
        comb(5), turned_over((comb(5)[0] * [-1, 1, 1] - [0.5, 0, 0], comb(5)[1]))
    ),
    "prism 3": lambda: prism(regular(3, 1), 2),
    "prism 12": lambda: prism(regular(12, 1), 0.5),
    "cylinder 32": lambda: cylinder(32, 2, 1, 3),
    "cylinder of rings": lambda: cylinder(32, 17, 1, 3),
    "tube": lambda: tube(48, 0.95, 1, 2),
    "wire": lambda: wire(150, 0.003),
    "grid, flat": lambda: grid(21, 13, _flat),
    "grid, waves": lambda: grid(21, 21, _waves),
    "fine grid, a bump": lambda: grid(50, 50, _bump),
    **{
        name: lambda name=name: platonic(name)  # type: ignore[misc]
        for name in ("tetrahedron", "cube", "octahedron", "dodecahedron", "icosahedron")
    },
    "ball": lambda: ball(2),
}


def shape(name: str, turned: bool = False) -> PolyMesh:
    """Return a shape as it is; or turned, a thousandth as large, and a hundred sizes away."""
    V, polygons = SHAPES[name]()
    if turned:
        axes = np.linalg.qr(np.random.default_rng(SEED).normal(size=(3, 3)))[0]
        axes *= np.sign(np.linalg.det(axes))
        V = 1e-3 * (V @ axes + 100 * np.ptp(V))
    return from_arrays(V, polygons)


# ---- Scenes ------------------------------------------------------------------------------------


def ground(size: float, k: int, height: float, rng: np.random.Generator) -> Solid:
    """Return k x k vertices around the origin, with hills of six octaves."""
    waves = [(2**o, *rng.uniform(0, 6, 2)) for o in range(6)]

    def hills(x: Floats, y: Floats) -> Floats:
        turns = 2 * np.pi
        return sum(np.sin(turns * f * x + a) * np.sin(turns * f * y + b) / f for f, a, b in waves)

    V, quads = grid(k, k, hills)
    return (V - [0.5, 0.5, 0]) * [size, size, height], quads


def _one_ball(share: float, rng: np.random.Generator) -> PolyMesh:
    return _scene(ground(500, 40, 0, rng), moved(ball(2, 0.5), (10, 20, 1)))


def _balls(share: float, rng: np.random.Generator) -> PolyMesh:
    places = rng.uniform(-200, 200, (_count(20, share), 3))
    return _scene(ground(500, 40, 0, rng), *(moved(ball(2, 0.5), at) for at in places))


def _bolts(share: float, rng: np.random.Generator) -> PolyMesh:
    places = rng.uniform(-30, 30, (_count(1000, share), 3))
    hall, bolt = box(100, 60, 30), cylinder(12, 2, 0.05, 0.2)
    return _scene(moved(hall, (-50, -30, -15)), *(moved(bolt, at) for at in places))


def _city(share: float, rng: np.random.Generator) -> PolyMesh:
    count = _count(5000, share)
    sizes, places = rng.uniform(5, 40, (count, 3)), rng.uniform(-900, 900, (count, 3))
    houses = (moved(box(*size), at * [1, 1, 0]) for size, at in zip(sizes, places, strict=True))
    return _scene(ground(2000, 60, 5, rng), *houses)


def _terrain(share: float, rng: np.random.Generator) -> PolyMesh:
    k = max(round(150 * share**0.5), 8)
    return _scene(ground(500, k, 30, rng), moved(ball(2, 0.5), (10, 20, 40)))


def _millionfold(share: float, rng: np.random.Generator) -> PolyMesh:
    levels = 4 if share == 1 else 2
    return _scene(ball(levels, 1000), moved(ball(levels, 0.001), (900, 800, 700)))


def _tiles(share: float, rng: np.random.Generator) -> PolyMesh:
    k = max(round(150 * share**0.5), 16)
    mesh = _scene(ground(500, k, 30, rng))
    middle = mesh.vertices[mesh.triangles].mean(axis=1)[:, :2] / 500 + 0.5
    # A quadtree that gets finer towards one corner.
    level = np.clip(np.floor(-np.log2(np.maximum(middle.max(axis=1), 1e-9))), 0, 4) + 1
    cell = np.floor(middle * 2.0 ** level[:, None])
    _, tile = np.unique(np.column_stack((level, cell)), axis=0, return_inverse=True)
    tile = tile.ravel()
    names = tuple(f"tile {i}" for i in range(tile.max() + 1))
    return replace(mesh, parts=(Parts("object", names, tile),))


def _tree(share: float, rng: np.random.Generator) -> PolyMesh:
    count = _count(5000, share)
    crown = rng.normal(size=(count, 3))
    crown *= rng.uniform(1, 3, (count, 1)) / np.linalg.norm(crown, axis=1, keepdims=True)
    outline = ((0, 0), (0.5, 0.3), (1, 0), (0.5, -0.3))
    leaf = np.array([(x, y, 0.2 * x * x) for x, y in outline])
    leaves = []
    for at, size in zip(crown, rng.uniform(0.03, 0.12, count), strict=True):
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        leaves.append((at + [0, 0, 5] + size * leaf @ axes, [[0, 3, 1], [1, 3, 2]]))
    trunk = cylinder(16, 20, 0.3, 5)
    return _scene(trunk, *leaves)


def _debris(share: float, rng: np.random.Generator) -> PolyMesh:
    count = _count(3000, share)
    sizes = 10 ** rng.uniform(-4, 0, (count, 1, 1))
    corners = rng.uniform(-10, 10, (count, 1, 3)) + sizes * rng.normal(size=(count, 3, 3))
    return _scene((corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3).tolist()))


SCENES: Final[Mapping[str, Callable[[float, np.random.Generator], PolyMesh]]] = {
    "1 ball": _one_ball,
    "20 balls": _balls,
    "1000 bolts in a hall": _bolts,
    "city of 5000 boxes": _city,
    "terrain with a ball": _terrain,
    "a millionfold apart": _millionfold,
    "terrain in tiles": _tiles,
    "tree of 5000 leaves": _tree,
    "debris, 3000 triangles": _debris,
}


def scene(name: str, share: float = 1.0) -> PolyMesh:
    """Return a scene of triangles; of a smaller share, with fewer parts."""
    return SCENES[name](share, np.random.default_rng(SEED))


def _count(whole: int, share: float) -> int:
    return max(round(whole * share), 3)


def _scene(*solids: Solid) -> PolyMesh:
    V, polygons = union(*solids)
    return from_triangles(V, from_arrays(V, polygons).triangles)
