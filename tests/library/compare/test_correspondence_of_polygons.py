"""Polygons of two meshes that correspond."""

from __future__ import annotations

import numpy as np
import pytest
from polygon_meshes import MADE, canonical, lists_of, mesh_of

from deltamesh._compare.correspondence import match_polygons
from deltamesh._mesh import triangulated


@pytest.mark.parametrize("name", ["quads", "torus", "prism", "moebius"])
def test_polygons_correspond_wherever_they_begin(name: str) -> None:
    mesh = MADE[name]
    rng = np.random.default_rng(1)
    to = rng.permutation(len(mesh.vertices))
    polygons = [np.roll(to[p], rng.integers(len(p))).tolist() for p in lists_of(mesh)]
    polygons = [polygons[i] for i in rng.permutation(len(polygons))]
    other = mesh_of(mesh.vertices[np.argsort(to)] + 1e-4, polygons)
    found = match_polygons(mesh, other)
    assert found is not None
    assert canonical(mesh, found.tolist()) == canonical(other)
    assert match_polygons(mesh, mesh_of(mesh.vertices, mesh.triangles.tolist())) is not None
    triangles = triangulated(mesh).faces.tolist()
    assert match_polygons(mesh_of(mesh.vertices, triangles), mesh) is not None
