"""PyVista reads and writes `.dmesh` by itself, and its meshes come back whole."""

from __future__ import annotations

import sys
from dataclasses import replace
from importlib.metadata import entry_points
from pathlib import Path

import children
import numpy as np
import polymeshes
import pytest
import wholes
from hypothesis import given, settings

import deltamesh

pyvista = pytest.importorskip("pyvista", minversion="0.48")

from deltamesh.plugins.pyvista import (  # noqa: E402
    from_pyvista,
    read_dmesh,
    to_pyvista,
    write_dmesh,
)

KINDS = (wholes.VERTEX, wholes.FACE, wholes.NORMAL, wholes.UV, wholes.COLOUR)


@given(
    polymeshes.polymeshes(
        KINDS, part_names=wholes.PARTS, metadata={"comments": polymeshes.comments}
    )
)
def test_a_mesh_goes_through_pyvista_unchanged(mesh: deltamesh.PolyMesh) -> None:
    again = from_pyvista(to_pyvista(mesh))
    assert wholes.plain(again) == wholes.plain(mesh)


@given(polymeshes.polymeshes(KINDS, precision="float32"))
@settings(max_examples=20)
def test_float32_stays_float32(mesh: deltamesh.PolyMesh) -> None:
    made = to_pyvista(mesh)
    assert made.points.dtype == np.float32
    assert wholes.plain(from_pyvista(made)) == wholes.plain(mesh)


def test_what_pyvista_shows_is_active() -> None:
    mesh = deltamesh.from_arrays(
        np.eye(3), [[0, 1, 2]], vertex={"normal": np.eye(3), "uv": np.eye(3)[:, :2], "T": [1, 2, 3]}
    )
    made = to_pyvista(mesh)
    np.testing.assert_array_equal(made.active_normals, np.eye(3))
    np.testing.assert_array_equal(made.active_texture_coordinates, np.eye(3)[:, :2])
    assert made["T"].tolist() == [1, 2, 3]


def test_active_arrays_have_their_roles_whatever_their_names() -> None:
    made = pyvista.Sphere(theta_resolution=8, phi_resolution=8)
    made.point_data["abc"] = made.points[:, :2].copy()
    made.point_data.active_texture_coordinates_name = "abc"
    mesh = from_pyvista(made)
    assert {a.name: a.role for a in mesh.attributes} == {"Normals": "normal", "abc": "uv"}
    assert mesh.precision == "float32"


def test_corners_without_seams_become_points_and_with_them_are_named() -> None:
    V, F = np.eye(4)[:, :3], [[0, 1, 2], [0, 2, 3]]
    smooth = deltamesh.from_arrays(V, F, corner={"uv": V[np.ravel(F)][:, :2]})
    np.testing.assert_array_equal(to_pyvista(smooth)["uv"], V[:, :2])
    seams = deltamesh.from_arrays(V, F, corner={"uv": np.arange(12.0).reshape(6, 2)})
    with pytest.warns(UserWarning, match="not kept in a PolyData: texture coordinates with seams"):
        assert to_pyvista(seams).array_names == []


def test_lines_points_and_words_are_told(tmp_path: Path) -> None:
    made = pyvista.PolyData(np.eye(4)[:, :3], faces=[3, 0, 1, 2], lines=[2, 0, 1], verts=[1, 3])
    made.cell_data["R"] = [7, 8, 9]
    made.cell_data["seen"] = [False, False, True]
    made.field_data["year"] = [2003]
    before = made.copy()
    mesh = from_pyvista(made)
    assert made == before
    assert mesh.lost == ("1 cells of single vertices", "1 lines", "the field array 'year'")
    made.user_dict["place"] = {"town": "Haifa"}
    assert from_pyvista(made).lost[-1] == "the entry 'place' of user_dict"
    assert mesh.face_data["R"].tolist() == [9]
    assert mesh.face_data["seen"].tolist() == [1]
    with pytest.warns(UserWarning, match=r"not kept in a \.dmesh: 1 cells of single vertices"):
        write_dmesh(made, str(tmp_path / "x.dmesh"))


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: pyvista.ImageData(dimensions=(2, 2, 2)), r"extract_surface\(\) is one"),
        (lambda: pyvista.Sphere().strip(), r"triangulate\(\) makes faces"),
        (lambda: pyvista.PolyData(np.eye(3)), "no faces"),
    ],
)
def test_what_has_no_faces_is_refused(made: object, message: str, tmp_path: Path) -> None:
    with pytest.raises(deltamesh.MeshError, match=message):
        write_dmesh(made(), str(tmp_path / "x.dmesh"))
    assert not list(tmp_path.iterdir())


def test_a_file_and_back(tmp_path: Path) -> None:
    made = pyvista.Sphere(theta_resolution=9, phi_resolution=9)
    path = tmp_path / "ball.dmesh"
    write_dmesh(made, str(path), max_error=1e-3)
    again = read_dmesh(str(path), max_vertices=1000)
    np.testing.assert_array_equal(again.faces, made.faces)
    assert np.abs(again.points - made.points).max() <= 1e-3
    with pytest.raises(deltamesh.LimitError):
        read_dmesh(str(path), max_vertices=10)


def test_pyvista_fetches_what_is_elsewhere() -> None:
    with pytest.raises(pyvista.LocalFileRequiredError):
        read_dmesh("https://example.org/ball.dmesh")


def test_attributes_survive_a_file(tmp_path: Path) -> None:
    mesh = replace(wholes.sample(), precision="float32")
    made = to_pyvista(mesh)
    write_dmesh(made, str(tmp_path / "x.dmesh"), method="lossless")
    again = read_dmesh(str(tmp_path / "x.dmesh"))
    assert wholes.plain(from_pyvista(again)) == wholes.plain(from_pyvista(made))


def test_pyvista_finds_the_plugin_without_an_import(tmp_path: Path) -> None:
    found = {e.value for e in entry_points(name=".dmesh") if e.group.startswith("pyvista.")}
    if not found:
        pytest.skip("deltamesh is not installed with its entry points")
    assert found == {f"deltamesh.plugins.pyvista:{what}_dmesh" for what in ("read", "write")}
    code = (
        "import pyvista, sys\n"
        "ball = pyvista.Sphere(theta_resolution=9, phi_resolution=9)\n"
        "ball.save('ball.dmesh', bits=8)\n"
        "again = pyvista.read('ball.dmesh')\n"
        "assert (again.faces == ball.faces).all()\n"
    )
    children.run([sys.executable, "-c", code], cwd=tmp_path, check=True)
