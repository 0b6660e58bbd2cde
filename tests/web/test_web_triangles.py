"""Triangles of polygons in JavaScript: those of Python, whatever the polygons."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import children
import numpy as np
import outlines
import polygon_meshes

from deltamesh import PolyMesh

SCRIPT = Path(__file__).with_name("cut_all.mjs")


def polygon(points: np.ndarray) -> PolyMesh:
    return polygon_meshes.mesh_of(points, [list(range(len(points)))])


def flat(points: np.ndarray) -> np.ndarray:
    return np.column_stack([points, np.zeros(len(points))]) if points.shape[1] == 2 else points


def cases() -> Iterator[PolyMesh]:
    rng = np.random.default_rng(11)
    yield polygon_meshes.quad_torus(9, 7)
    yield polygon_meshes.prism(9)
    yield polygon_meshes.mixed()
    spikes = outlines.star(10 ** rng.uniform(-3, 0, size=500))
    for points in (outlines.pacman(20), outlines.comb(9, 0.9), outlines.spiral(60, 3.0), spikes):
        yield polygon(flat(points))
    for _ in range(150):
        quad = rng.normal(size=(4, 3)) if rng.random() < 0.5 else rng.integers(0, 3, (4, 3))
        yield polygon(quad.astype(np.float64))
    for corners in (8, 9, 17, 40, 90):
        for _ in range(25):
            points, _ = outlines.in_space(rng, outlines.random_outline(rng, corners))
            yield polygon(flat(points))
    for _ in range(10):
        yield polygon(flat(outlines.with_holes(rng, 3)))
        yield polygon(flat(outlines.with_middles(outlines.random_outline(rng, 8))))
        # Crossing itself, so that there may be no triangles without an overlap.
        yield polygon(rng.normal(size=(7, 3)))
        yield polygon(np.zeros((6, 3)))


def test_triangles_are_those_of_python(node: str) -> None:
    meshes = list(cases())
    given = [
        {
            "positions": mesh.vertices.ravel().tolist(),
            "corners": mesh.corners.tolist(),
            "offsets": mesh.offsets.tolist(),
        }
        for mesh in meshes
    ]
    done = children.run([node, str(SCRIPT)], given=json.dumps(given).encode(), check=True)
    for mesh, found in zip(meshes, json.loads(done.stdout), strict=True):
        expected = mesh.triangulation().corners
        np.testing.assert_array_equal(np.array(found).reshape(-1, 3), expected)
