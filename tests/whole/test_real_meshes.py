"""Real meshes, where there are any: see `meshes.folder`."""

from __future__ import annotations

import meshes
import numpy as np
import pytest

from deltamesh import decode
from deltamesh._options import Options
from deltamesh._pipeline.encoder import encode_mesh

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
    "clean/featuretype.ply",  # 5096 vertices at 1722 positions
    "unstated/cube_40k.obj",  # four and more faces on most edges
    "clean/cycloidal.ply",  # edges of four faces
    "clean/chair_model.obj",  # every face twice
    "copyleft/bearing.stl",  # a soup; edges of four faces, degenerate faces
    "copyleft/blobby_shuffled.off",  # faces turned at random
    "copyleft/face000_rangemap.ply",  # vertices of several fans
    "edge/moebius.obj",
    "edge/fan3.obj",
    "edge/hourglass_ico.obj",
    "edge/degenerated.obj",
    "clean/twin_7081_left.obj",  # a vertex of valence 969
)


@pytest.mark.parametrize("method", ["highpass", "cartesian"])
@pytest.mark.parametrize("name", meshes.large_are_slow(NAMES))
def test_round_trip(name, method):
    mesh = meshes.real(name)
    whole = meshes.as_polymesh(mesh)
    diagonal = np.linalg.norm(np.ptp(mesh.vertices, axis=0))
    one, other = (
        encode_mesh(whole, Options(method=method, step=diagonal / 1000, threads=threads))
        for threads in (1, 2)
    )
    assert other.data == one.data

    decoded = decode(one.data)
    assert (decoded.faces == one.mesh.faces).all()
    assert (np.sort(one.order) == np.arange(len(mesh.vertices))).all()
    corner = (one.rotation[:, None] + np.arange(3)) % 3
    assert (np.sort(one.face_order) == np.arange(len(mesh.faces))).all()
    assert (one.order[decoded.faces] == mesh.faces[one.face_order[:, None], corner]).all()
    assert np.abs(decoded.vertices - one.mesh.vertices).max() <= 1e-9 * diagonal
    assert np.abs(decoded.vertices - mesh.vertices[one.order]).max() <= 0.02 * diagonal
