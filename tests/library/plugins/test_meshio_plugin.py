"""meshio reads and writes `.dmesh`, and its meshes come back whole."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import polymeshes
import pytest
import wholes
from hypothesis import given

import deltamesh

meshio = pytest.importorskip("meshio")

from deltamesh.plugins.meshio import from_meshio, register, to_meshio  # noqa: E402

KINDS = (wholes.VERTEX, wholes.FACE, wholes.NORMAL, wholes.UV, wholes.COLOUR)


@given(polymeshes.polymeshes(KINDS, part_names=wholes.PARTS))
def test_a_mesh_goes_through_meshio_unchanged(mesh: deltamesh.PolyMesh) -> None:
    assert wholes.plain(from_meshio(to_meshio(mesh))) == wholes.plain(mesh)


def test_cells_are_runs_of_faces_in_their_order() -> None:
    V = np.random.default_rng(1).random((9, 3))
    faces = [[0, 1, 2], [2, 1, 0], [0, 1, 2, 3], [3, 4, 5, 6, 7], [4, 5, 6, 7, 8], [6, 7, 8]]
    mesh = to_meshio(deltamesh.from_arrays(V, faces, face={"R": np.arange(6)}))
    assert [(block.type, block.data.tolist()) for block in mesh.cells] == [
        ("triangle", faces[:2]),
        ("quad", faces[2:3]),
        ("polygon", faces[3:5]),
        ("triangle", faces[5:]),
    ]
    assert [rows.tolist() for rows in mesh.cell_data["R"]] == [[0, 1], [2], [3, 4], [5]]


def test_parts_are_numbers_and_names_as_gmsh_has_them() -> None:
    parts = deltamesh.Parts("material", ("steel", "steel", "ü"), np.array([2, -1, 0, 1]))
    plain = deltamesh.from_arrays(np.eye(4)[:, :3], [[0, 1, 2], [1, 2, 3], [0, 1, 3], [0, 2, 3]])
    mesh = to_meshio(deltamesh.PolyMesh(plain.vertices, plain.corners, plain.offsets, (), (parts,)))
    assert mesh.cell_data["material"][0].tolist() == [2, -1, 0, 1]
    fields = {name: value.tolist() for name, value in mesh.field_data.items()}
    assert fields == {"material:steel": [0, 2], "material:steel_2": [1, 2], "material:ü": [2, 2]}
    assert from_meshio(mesh).parts[0].of_face.tolist() == [2, -1, 0, 1]


def test_what_is_not_of_faces_is_told() -> None:
    V = np.eye(5)[:, :3]
    mesh = meshio.Mesh(
        V,
        [("line", [[0, 1]]), ("triangle", [[0, 1, 2]]), ("tetra", [[0, 1, 2, 3]])],
        point_data={"T": np.arange(5), "word": np.array(list("abcde")), "J": np.zeros((5, 2, 2))},
        cell_data={"R": [[1], [2], [3]]},
        point_sets={"left": [0]},
        cell_sets={"all": [[0], [0], [0]]},
        field_data={"year": np.array(2003)},
    )
    found = from_meshio(mesh)
    assert found.faces.tolist() == [[0, 1, 2]]
    assert found.face_data["R"].tolist() == [2]
    assert found.vertex_data["J"].shape == (5, 4)
    assert set(found.lost) == {
        "cells of type line",
        "cells of type tetra",
        "the vertex array 'word'",
        "the shape of the vertex array 'J'",
        "the point set 'left'",
        "the cell set 'all'",
        "the field 'year'",
    }


def test_two_coordinates_get_a_third() -> None:
    mesh = from_meshio(meshio.Mesh([[0.0, 0], [1, 0], [0, 1]], [("triangle", [[0, 1, 2]])]))
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        ([("tetra", [[0, 1, 2, 3]])], "no triangles, quads or polygons among the cells: tetra"),
        ([], "among the cells: none"),
        ([("triangle", [[0, 1, 9]])], "outside 0..3"),
        ([("triangle", [[0.0, 1, 2]])], "must be a table of integers"),
    ],
)
def test_what_is_no_mesh_of_faces_is_refused(cells: list, message: str) -> None:
    with pytest.raises(deltamesh.MeshError, match=message):
        from_meshio(meshio.Mesh(np.eye(4)[:, :3], cells))


def test_corners_without_seams_become_points_and_with_them_are_named() -> None:
    V, F = np.eye(4)[:, :3], [[0, 1, 2], [0, 2, 3]]
    smooth = deltamesh.from_arrays(V, F, corner={"uv": V[np.ravel(F)][:, :2]})
    np.testing.assert_array_equal(to_meshio(smooth).point_data["uv"], V[:, :2])
    seams = deltamesh.from_arrays(V, F, corner={"uv": np.arange(12.0).reshape(6, 2)})
    with pytest.warns(UserWarning, match="in a mesh of meshio: texture coordinates with seams"):
        assert to_meshio(seams).point_data == {}


def test_files_by_name_and_as_objects(tmp_path: Path) -> None:
    register()  # a second time changes nothing
    mesh = to_meshio(wholes.sample())
    mesh.write(tmp_path / "x.dmesh", max_error=1e-3)
    again = meshio.read(tmp_path / "x.dmesh")
    np.testing.assert_array_equal(again.cells[0].data, mesh.cells[0].data)
    assert np.abs(again.points - mesh.points).max() <= 1e-3
    stream = io.BytesIO()
    meshio.write(stream, mesh, "dmesh", max_error=1e-3)
    assert stream.getvalue() == (tmp_path / "x.dmesh").read_bytes()
    stream.seek(0)
    np.testing.assert_array_equal(meshio.read(stream, "dmesh").points, again.points)


def test_attributes_survive_a_file(tmp_path: Path) -> None:
    mesh = to_meshio(wholes.sample())
    mesh.write(tmp_path / "x.dmesh", method="lossless")
    again = from_meshio(meshio.read(tmp_path / "x.dmesh"))
    assert wholes.plain(again) == wholes.plain(from_meshio(mesh))
