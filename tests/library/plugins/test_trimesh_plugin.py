"""trimesh loads and exports `.dmesh`, and its meshes come back whole."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import meshes
import numpy as np
import polymeshes
import pytest
import wholes
from hypothesis import given

import deltamesh
from deltamesh_formats.polymesh.mesh import Attribute, Parts, from_triangles

trimesh = pytest.importorskip("trimesh")

from deltamesh.plugins.trimesh import from_trimesh, register, to_trimesh  # noqa: E402

KINDS = (wholes.VERTEX, wholes.FACE, wholes.CORNER, wholes.NORMAL, wholes.UV, wholes.COLOUR)
V, F = meshes.torus(9, 7)


@given(
    polymeshes.polymeshes(
        KINDS, largest=3, part_names=wholes.PARTS, metadata={"comments": polymeshes.comments}
    )
)
def test_a_mesh_goes_through_trimesh_unchanged(mesh: deltamesh.PolyMesh) -> None:
    made = to_trimesh(mesh)
    np.testing.assert_array_equal(made.vertices, mesh.vertices)
    np.testing.assert_array_equal(made.faces, mesh.faces)
    for again in (from_trimesh(made), from_trimesh(made.copy())):
        assert wholes.plain(again) == wholes.plain(mesh)


def test_normals_may_be_any_numbers() -> None:
    normal = np.full((len(V), 3), 1.7e308)
    normal[0] = -1.7e308
    mesh = deltamesh.from_arrays(V, F, vertex={"normal": normal})
    np.testing.assert_array_equal(to_trimesh(mesh).vertex_attributes["normal"], normal)


def test_everything_has_its_place() -> None:
    parts = Parts("material", ("steel",), np.zeros(len(F), np.int64))
    mesh = replace(wholes.sample(corner=True), parts=(parts,), metadata={"units": ("mm",)})
    made = to_trimesh(mesh)
    data = mesh.vertex_data
    np.testing.assert_array_equal(made.vertex_normals, data["normal"])
    np.testing.assert_array_equal(made.visual.vertex_colors, data["colour"])
    np.testing.assert_array_equal(made.vertex_attributes["temperature"], data["temperature"])
    assert set(made.vertex_attributes) == {"normal", "temperature"}
    np.testing.assert_array_equal(made.face_attributes["region"], mesh.face_data["region"])
    corners = made.face_attributes["corner_uv"].reshape(-1, 3, 2)
    np.testing.assert_array_equal(corners.reshape(-1, 2), mesh.corner_data["uv"])
    assert made.face_attributes["material"].tolist() == [0] * len(F)
    assert made.metadata["material_names"] == ["steel"]
    assert made.units == "mm"
    assert wholes.plain(from_trimesh(made)) == wholes.plain(mesh)


def test_polygons_are_cut_and_carry_their_attributes() -> None:
    mesh = deltamesh.from_arrays(
        V, [[0, 1, 2, 3], [4, 5, 6]], face={"R": [7, 8]}, corner={"c": np.arange(7)}
    )
    made = to_trimesh(mesh)
    cut = mesh.triangulation()
    np.testing.assert_array_equal(made.faces, cut.faces)
    assert made.face_attributes["R"].tolist() == [7, 7, 8]
    assert made.face_attributes["corner_c"].tolist() == cut.corners.tolist()


def test_texture_coordinates_without_seams_are_those_of_vertices() -> None:
    mesh = deltamesh.from_arrays(V, F, corner={"uv": V[F][:, :, :2]})
    made = to_trimesh(mesh)
    np.testing.assert_array_equal(made.visual.uv, V[:, :2])
    assert not made.face_attributes


def test_seams_are_split_on_request() -> None:
    faces = [[0, 1, 2], [0, 2, 3]]
    uv = np.array([[0, 0], [1, 0], [1, 1], [0.5, 0], [1, 1], [0, 1]])
    mesh = deltamesh.from_arrays(
        np.eye(5)[:, :3], faces, vertex={"T": np.arange(5)}, corner={"uv": uv, "c": np.arange(6)}
    )
    made = to_trimesh(mesh, split_seams=True)
    assert made.faces.tolist() == [[0, 1, 2], [5, 2, 3]]
    assert made.visual.uv[made.faces].reshape(6, 2).tolist() == uv.tolist()
    assert made.vertex_attributes["T"].tolist() == [0, 1, 2, 3, 4, 0]
    assert made.face_attributes["corner_c"].tolist() == [[0, 1, 2], [3, 4, 5]]


def test_colours_that_are_no_bytes_are_shown_and_kept() -> None:
    colours = np.random.default_rng(1).random((len(V), 3)).astype(np.float32)
    mesh = deltamesh.from_arrays(V, F, vertex={"colour": colours})
    made = to_trimesh(mesh)
    np.testing.assert_array_equal(made.visual.vertex_colors[:, :3], np.rint(255 * colours))
    assert wholes.plain(from_trimesh(made)) == wholes.plain(mesh)
    made.visual.vertex_colors = [255, 0, 0, 255]
    assert from_trimesh(made).vertex_data["colour"].tolist() == [[255, 0, 0, 255]] * len(V)


def test_colours_of_faces() -> None:
    made = trimesh.Trimesh(V, F, process=False)
    made.visual.face_colors[3] = [1, 2, 3, 4]
    mesh = from_trimesh(made)
    assert mesh.face_data["colour"][3].tolist() == [1, 2, 3, 4]
    again = to_trimesh(mesh)
    np.testing.assert_array_equal(again.visual.face_colors, made.visual.face_colors)


def test_normals_that_trimesh_computes_are_not_kept() -> None:
    made = trimesh.Trimesh(V, F, process=False)
    assert made.vertex_normals.shape == V.shape
    assert from_trimesh(made).attributes == ()
    given = trimesh.Trimesh(V, F, vertex_normals=np.roll(V, 1, axis=1), process=False)
    assert (from_trimesh(given).vertex_data["normal"] == np.roll(V, 1, axis=1)).all()


def test_normals_turn_with_the_mesh() -> None:
    made = to_trimesh(wholes.sample())
    made.apply_transform(trimesh.transformations.rotation_matrix(1, [0, 0, 1]))
    data = from_trimesh(made).vertex_data
    np.testing.assert_array_equal(data["normal"], made.vertex_normals)
    assert "normal_2" not in data


def test_a_scene_is_its_meshes_in_their_places() -> None:
    scene = trimesh.Scene()
    box = trimesh.creation.box()
    box.vertex_attributes["T"] = np.arange(8)
    ball = trimesh.creation.icosphere(subdivisions=1)
    scene.add_geometry(box, node_name="box")
    move = trimesh.transformations.translation_matrix([5, 0, 0])
    scene.add_geometry(ball, node_name="ball", transform=move)
    mesh = from_trimesh(scene)
    (objects,) = mesh.parts
    assert sorted(objects.names) == ["ball", "box"]
    of_box = objects.of_face == objects.names.index("box")
    assert of_box.sum() == 12
    rows = mesh.vertex_data["T"]
    assert np.isnan(rows).sum() == 0  # integers: 0 where there are none
    at_box = np.unique(mesh.faces[of_box])
    assert sorted(rows[at_box].tolist()) == list(range(8))
    others = np.setdiff1d(np.arange(len(mesh.vertices)), at_box)
    np.testing.assert_allclose(mesh.vertices[others].mean(axis=0), [5, 0, 0], atol=1e-12)


def test_what_is_not_kept_is_told() -> None:
    made = trimesh.Trimesh(V, F, process=False)
    made.vertex_attributes["word"] = np.array(["a"] * len(V))
    made.vertex_attributes["J"] = np.zeros((len(V), 2, 2))
    made.face_attributes["short"] = [1, 2]
    mesh = from_trimesh(made)
    assert mesh.lost == (
        "the vertex array 'word'",
        "the shape of the vertex array 'J'",
        "the face array 'short'",
    )
    with pytest.warns(UserWarning, match=r"not kept in a \.dmesh: the vertex array 'word', the sh"):
        made.export(file_type="dmesh", bits=8)


def test_a_picture_is_told() -> None:
    image = pytest.importorskip("PIL.Image").new("RGB", (4, 4))
    visual = trimesh.visual.TextureVisuals(uv=V[:, :2], image=image)
    mesh = from_trimesh(trimesh.Trimesh(V, F, visual=visual, process=False))
    assert mesh.lost == ("the picture of the texture",)
    assert (mesh.vertex_data["uv"] == V[:, :2]).all()


@pytest.mark.parametrize(
    "nothing", [trimesh.Scene(), trimesh.PointCloud(V), trimesh.Trimesh(), trimesh.Trimesh(V)]
)
def test_what_has_no_faces_is_refused(nothing: object) -> None:
    with pytest.raises(deltamesh.MeshError):
        from_trimesh(nothing)


def test_files_by_name_and_as_objects(tmp_path: Path) -> None:
    register()  # a second time changes nothing
    assert "dmesh" in trimesh.available_formats()
    doubled = np.concatenate([V, V])  # which merging would halve
    made = trimesh.Trimesh(doubled, np.concatenate([F, F + len(V)]), process=False)
    made.export(tmp_path / "x.dmesh", max_error=1e-3)
    data = made.export(file_type="dmesh", max_error=1e-3)
    assert data == (tmp_path / "x.dmesh").read_bytes()
    for again in (
        trimesh.load_mesh(tmp_path / "x.dmesh"),
        trimesh.load_mesh(str(tmp_path / "x.dmesh")),
        trimesh.load_mesh(io.BytesIO(data), file_type="dmesh"),
        trimesh.load(io.BytesIO(data), file_type="dmesh", force="mesh"),
    ):
        np.testing.assert_array_equal(again.faces, made.faces)
        assert np.abs(again.vertices - doubled).max() <= 1e-3
    merged = trimesh.load_mesh(io.BytesIO(data), file_type="dmesh", process=True)
    assert len(merged.vertices) == len(V)
    with pytest.raises(deltamesh.LimitError):
        trimesh.load_mesh(io.BytesIO(data), file_type="dmesh", max_vertices=100)
    free = made.export(file_type="dmesh", max_error=1e-3, keep_order=False)
    assert len(free) < len(data)


def test_attributes_survive_a_file(tmp_path: Path) -> None:
    made = to_trimesh(wholes.sample(corner=True))
    made.export(tmp_path / "x.dmesh", method="lossless")
    again = from_trimesh(trimesh.load_mesh(tmp_path / "x.dmesh"))
    assert wholes.plain(again) == wholes.plain(from_trimesh(made))


def test_gaps_in_colours_are_shown_white() -> None:
    mesh = from_triangles(np.eye(3), np.array([[0, 1, 2]]))
    index = np.array([-1, 0, -1])
    for values, normalized in (
        (np.array([[0.0, 0.2, 1.0]]), False),
        (np.array([[0, 51, 255, 255]], dtype=np.uint8), True),
    ):
        colour = Attribute("colour", "vertex", values, "colour", index, normalized)
        with pytest.warns(UserWarning, match="in a Trimesh: gaps in colours .filled with white"):
            made = to_trimesh(replace(mesh, attributes=(colour,)))
        white = [255, 255, 255, 255]
        assert made.visual.vertex_colors.tolist() == [white, [0, 51, 255, 255], white]
