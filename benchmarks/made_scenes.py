"""Scenes by formulas: what games and surveys make, with parts of unlike size.

What bounds the whole says little of a small part.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Final

import numpy as np
from solids import (
    SEED,
    Solid,
    ball,
    box,
    cylinder,
    grid,
    moved,
    union,
)

from deltamesh_formats.array_types import Floats
from deltamesh_formats.polymesh.arrays import from_arrays
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh, from_triangles


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
