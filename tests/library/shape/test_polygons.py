"""Polygons of more than three corners: from any file, and back as they were."""

from __future__ import annotations

import meshes
import numpy as np
import polygon_oracle
import pytest
from drafts import merged_of
from hypothesis import given
from hypothesis import strategies as st
from polygon_meshes import MADE, canonical, lists_of, mesh_of, quads, soups

from deltamesh import decode, encode
from deltamesh._options import Options
from deltamesh._order.reordering import permuted_corners
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh._shape.polygons import merged_polygons
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.meshfiles.files import read_mesh
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.polymesh.triangles import fans

METHODS = ("highpass", "refined", "cartesian", "lossless")
REAL = (
    "clean/sword_quad_dominant.obj",
    "clean/cow_ngon.obj",
    "unstated/cube_40k.obj",
    "edge/moebius.obj",
    "edge/dodecahedron_poly.obj",
    "edge/inspired_quads_smooth.off",
    "edge/negative_indices.obj",
    "edge/comments.off",
    "edge/multi.ply",
)


# ---- Meshes ------------------------------------------------------------------------------------


def assert_kept(mesh, encoded, *, keep_order=False):
    decoded = decode(encoded.data)
    np.testing.assert_array_equal(decoded.corners, encoded.mesh.corners)
    np.testing.assert_array_equal(decoded.offsets, encoded.mesh.offsets)
    assert canonical(decoded, encoded.order.tolist()) == canonical(mesh)
    rows, own = lists_of(mesh), encoded.order
    for got, face, turn in zip(
        lists_of(decoded), encoded.face_order, encoded.rotation, strict=True
    ):
        assert own[got].tolist() == rows[face][turn:] + rows[face][:turn]
    if keep_order:
        np.testing.assert_array_equal(decoded.corners, mesh.corners)
        np.testing.assert_array_equal(decoded.offsets, mesh.offsets)
    return decoded


# ---- Whole files -------------------------------------------------------------------------------


@pytest.mark.parametrize("name", MADE)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("keep_order", [False, True])
def test_made_polygons_come_back(name: str, method: str, keep_order: bool) -> None:
    mesh = MADE[name]
    encoded = encode_mesh(mesh, Options(method=method, keep_order=keep_order))
    decoded = assert_kept(mesh, encoded, keep_order=keep_order)
    if method == "lossless":
        np.testing.assert_array_equal(decoded.vertices, mesh.vertices[encoded.order])
    else:
        off = np.abs(decoded.vertices - mesh.vertices[encoded.order]).max()
        assert off < 0.2 * np.ptp(mesh.vertices)


@given(soups(), st.sampled_from(METHODS), st.booleans())
def test_any_polygons_come_back(mesh: PolyMesh, method: str, keep_order: bool) -> None:
    encoded = encode_mesh(mesh, Options(method=method, keep_order=keep_order))
    assert_kept(mesh, encoded, keep_order=keep_order)


@pytest.mark.parametrize("name", meshes.large_are_slow(REAL))
def test_real_polygons_come_back(name: str) -> None:
    if not (meshes.folder() / name).exists():
        pytest.skip(f"no {name}: DELTAMESH_MESHES names the folder of larger meshes")
    mesh = read_mesh(meshes.folder() / name)
    for keep_order in (False, True):
        encoded = encode_mesh(mesh, Options(method="cartesian", keep_order=keep_order))
        decoded, own = decode(encoded.data), encoded.face_order
        assert sorted(own.tolist()) == list(range(len(mesh.sizes)))
        corners, offsets = permuted_corners(mesh.offsets, own, encoded.rotation)
        np.testing.assert_array_equal(decoded.offsets, offsets)
        np.testing.assert_array_equal(encoded.order[decoded.corners], mesh.corners[corners])
        if keep_order:
            np.testing.assert_array_equal(decoded.corners, mesh.corners)
        size = len(read_container(encoded.data).sections["POLY"].payload)
        assert 8 * size <= 0.5 * len(mesh.sizes) + 64


def test_triangles_have_no_polygons() -> None:
    V, F = meshes.torus(9, 7)
    whole = mesh_of(V, F.tolist())
    assert encode(whole, method="cartesian") == encode(V, F, method="cartesian")
    assert "POLY" not in read_container(encode(whole)).sections


def test_a_grid_of_quads_costs_next_to_nothing() -> None:
    """Whichever corners they begin at: parallel diagonals are found."""
    mesh = quads(60, 50)
    sections = read_container(encode(mesh, method="cartesian")).sections
    assert len(sections["CONN"].payload) + len(sections["POLY"].payload) < 60
    first = np.zeros(len(mesh.sizes), dtype=np.int64)
    V, F = mesh.vertices, fans(mesh.corners, mesh.offsets, first).faces
    assert len(read_container(encode(V, F, method="cartesian")).sections["CONN"].payload) > 300


def test_equal_polygons_keep_their_places() -> None:
    """Of triangles that are equal, each stays with its own polygon."""
    V = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 1]])
    polygons = [[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2], [2, 0, 1], [1, 2, 3, 0], [0, 1, 2, 3]]
    mesh = mesh_of(V, polygons)
    encoded = encode_mesh(mesh, Options(method="cartesian", keep_order=True))
    assert_kept(mesh, encoded, keep_order=True)


# ---- Kernels -----------------------------------------------------------------------------------


@given(soups())
def test_the_outlines_are_those_of_the_oracle(mesh: PolyMesh) -> None:
    _, merged = merged_of(mesh)
    polygons = merged_polygons(merged)
    expected = polygon_oracle.outlines(merged.tolist())
    assert polygons.corners.tolist() == [outside for p in expected for outside, _ in p]
    assert np.diff(polygons.offsets).tolist() == [len(p) for p in expected]
    for at, (_, corner) in enumerate(c for p in expected for c in p):
        assert set(np.flatnonzero(polygons.of_corners == at).tolist()) == corner
    lowest = [min(h // 3 for _, corner in p for h in corner) for p in expected]
    assert polygons.lowest.tolist() == lowest == sorted(lowest)
