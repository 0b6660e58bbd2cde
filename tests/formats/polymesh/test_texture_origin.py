"""Texture coordinates of GLB begin at the top left, all others at the bottom left."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from filetests import POINTS, again, read
from numpy.typing import NDArray

import deltamesh
from deltamesh._compare import likeness
from deltamesh_formats.meshfiles.files import mesh_bytes
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh, from_triangles
from deltamesh_formats.polymesh.texture_origin import is_top_left, marked_top_left, with_origin

UV = np.array([[0.0, 0.25], [0.5, 0.75], [1, 0], [0.125, 1]])
FACES = np.array([[0, 1, 2], [1, 3, 2]])


def textured(values: NDArray[np.generic] = UV, *, normalized: bool = False) -> PolyMesh:
    bare = from_triangles(np.array(POINTS, dtype=float), FACES)
    attribute = Attribute("uv", "vertex", values, "uv", normalized=normalized)
    return replace(bare, attributes=(attribute,))


def uv_of(mesh: PolyMesh) -> NDArray[np.float64]:
    """Those of each corner, in the order of the faces."""
    attribute = mesh.attribute("uv", "vertex", "corner")
    assert attribute is not None
    return attribute.values[likeness.rows_of(mesh, attribute)].astype(float)


@pytest.mark.parametrize("first", ["obj", "ply", "off", "glb"])
@pytest.mark.parametrize("last", ["obj", "ply", "off", "glb"])
def test_a_picture_stays_upright_through_any_two_formats(first: str, last: str) -> None:
    found = again(again(textured(), first), last)
    assert is_top_left(found) == (last == "glb")
    np.testing.assert_array_equal(uv_of(with_origin(found, top_left=False)), UV[FACES.ravel()])


def test_trimesh_sees_the_same(tmp_path) -> None:
    trimesh = pytest.importorskip("trimesh")
    visual = trimesh.visual.TextureVisuals(uv=UV)
    theirs = trimesh.Trimesh(np.array(POINTS), FACES, visual=visual, process=False)
    read_by_us = read(theirs.export(file_type="glb"), "glb")
    np.testing.assert_array_equal(uv_of(again(read_by_us, "obj")), UV[FACES.ravel()])
    path = tmp_path / "ours.glb"
    paint = Parts(
        "material", ("paint",), np.zeros(2, dtype=np.int64)
    )  # without one, it forgets UVs
    path.write_bytes(mesh_bytes(replace(textured(), parts=(paint,)), "glb"))
    back = trimesh.load_mesh(path, process=False)
    np.testing.assert_array_equal(back.visual.uv[back.faces.ravel()], UV[FACES.ravel()])


def test_numbers_of_a_glb_come_back_to_the_last_bit() -> None:
    values = np.array([[0, 1e-9], [0.1, 1 / 3], [5, -0.7], [0, 3e-39]], dtype=np.float32)
    source = marked_top_left(textured(values))
    data = deltamesh.encode(read(mesh_bytes(source, "glb"), "glb"), method="lossless")
    kept = deltamesh.decode(data)
    assert is_top_left(kept)
    (attribute,) = read(mesh_bytes(kept, "glb"), "glb").attributes
    assert sorted(row.tobytes() for row in attribute.values) == sorted(
        row.tobytes() for row in values
    )
    decoded = io.BytesIO(mesh_bytes(kept, "obj"))
    assert not is_top_left(deltamesh.read_mesh(decoded, "obj"))


def test_whole_numbers_are_turned_where_they_are_fractions() -> None:
    steps = np.array([[0, 0], [1, 255], [2, 55], [3, 1]], dtype=np.uint8)
    (turned,) = with_origin(textured(steps, normalized=True), top_left=True).attributes
    np.testing.assert_array_equal(turned.values[:, 1], [255, 0, 200, 254])
    (plain,) = with_origin(textured(steps), top_left=True).attributes
    np.testing.assert_array_equal(plain.values, steps)


def test_they_are_compared_as_pictures_are_seen() -> None:
    mesh = textured()
    other = with_origin(mesh, top_left=True)
    found = likeness.corresponding(mesh, other)
    assert found is not None
    pairs = likeness.matched_corners(mesh, other, found)
    assert pairs is not None
    assert [one.largest for one in likeness.differences(mesh, other, pairs)] == [0.0]


def test_without_texture_coordinates_nothing_is_told() -> None:
    bare = from_triangles(np.array(POINTS, dtype=float), FACES)
    assert not is_top_left(again(bare, "glb"))
