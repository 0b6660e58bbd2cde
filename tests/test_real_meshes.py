"""Real meshes, where there are any: see `meshes.folder`."""

from __future__ import annotations

import meshes
import numpy as np
import pytest

from deltamesh import decode
from deltamesh.codec import encode_mesh
from deltamesh.options import Options
from deltamesh.topology import weld

NAMES = (
    "unstated/bun_zipper.ply",
    "unstated/horse.ply",
    "unstated/camelhead.off",
    "unstated/armadillo.obj",
    "unstated/fandisk.obj",
    "unstated/screwdriver.ply",
    "unstated/sphere.off",
    "clean/skull.obj",
    "clean/turbineblade.ply",
    "clean/mountain.obj",
    "clean/1002_tray_bottom.STL",  # genus 23
    "clean/plane_holes.obj",  # 27 boundary loops
    "clean/pizza.obj",  # genus 73
    "clean/tank.obj",  # 51 components
    "clean/featuretype.ply",  # welds from 5096 to 1722 vertices
    "clean/twin_7081_left.obj",  # a vertex of valence 969
)


def canonical(faces):
    """Faces as a sorted array, each beginning with its lowest vertex: equal up to order."""
    first = faces.argmin(axis=1)[:, None]
    turned = np.take_along_axis(faces, (first + np.arange(3)) % 3, axis=1)
    return turned[np.lexsort(turned.T)]


@pytest.mark.parametrize("method", ["highpass", "cartesian"])
@pytest.mark.parametrize("name", NAMES)
def test_round_trip(name, method):
    mesh = meshes.real(name)
    one = encode_mesh(mesh, Options(method=method, threads=1))
    assert encode_mesh(mesh, Options(method=method, threads=2)).data == one.data

    decoded = decode(one.data)
    assert (decoded.faces == one.mesh.faces).all()
    keep, welded = weld(mesh.vertices)
    assert (np.sort(one.order) == keep).all()
    assert (canonical(one.order[decoded.faces]) == canonical(keep[welded][mesh.faces])).all()
    diagonal = np.linalg.norm(np.ptp(mesh.vertices, axis=0))
    assert np.abs(decoded.vertices - one.mesh.vertices).max() <= 1e-9 * diagonal
    assert np.abs(decoded.vertices - mesh.vertices[one.order]).max() <= 0.02 * diagonal
