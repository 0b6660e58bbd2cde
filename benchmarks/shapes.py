"""Shapes by formulas: what CAD programs make, where bounds are hard to keep.

They are small and have large faces, right angles or thin walls: a shape may keep all of its angles
and still lose its size.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
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
    platonic,
    prism,
    regular,
    tube,
    turned_over,
    union,
    voxels_of,
    wire,
)

from deltamesh_formats.array_types import Floats
from deltamesh_formats.polymesh.arrays import from_arrays
from deltamesh_formats.polymesh.mesh import PolyMesh


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
