"""`deltamesh render`: pictures of meshes and of errors, by PyVista."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path

import meshes
import numpy as np
import pytest

import deltamesh
from deltamesh_cli.pictures import Look, picture
from deltamesh_cli.program import run
from deltamesh_formats.polymesh.mesh import Attribute, from_triangles

pytest.importorskip("pyvista", minversion="0.48")
image = pytest.importorskip("PIL.Image")

V, F = meshes.icosphere(2)
LOOK = Look(80, 60, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0))


def pixels(png: bytes) -> np.ndarray:
    return np.asarray(image.open(io.BytesIO(png)).convert("RGB")).astype(int)


def spread(png: bytes) -> int:
    """The largest difference of the channels of a pixel: 0 for greys."""
    return int(np.ptp(pixels(png), axis=2).max())


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    """A mesh file, and a `.dmesh` of it in another order."""
    mesh, packed = tmp_path / "ball.ply", tmp_path / "ball.dmesh"
    deltamesh.write_mesh(mesh, from_triangles(V, F))
    packed.write_bytes(deltamesh.encode(V, F, bits=5))
    return mesh, packed


def test_a_picture_is_of_the_mesh() -> None:
    png = picture(from_triangles(V, F), LOOK)
    found = pixels(png)
    assert found.shape == (60, 80, 3)
    assert (found[0, 0] == 255).all()
    assert (found[30, 40] < 250).all()
    assert spread(png) < 20


def test_colours_and_errors_are_seen() -> None:
    red = np.tile(np.array([220, 20, 30], np.uint8), (len(V), 1))
    mesh = from_triangles(V, F)
    painted = type(mesh)(V, mesh.corners, mesh.offsets, (Attribute("c", "vertex", red, "colour"),))
    found = pixels(picture(painted, LOOK))[30, 40]
    assert found[0] > 2 * found[1]
    large = Look(400, 300, LOOK.direction, LOOK.up)
    assert spread(picture(mesh, large, np.arange(len(V)) / len(V))) > 100


def test_files_become_pictures(
    files: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    mesh, packed = files
    assert run(["render", str(packed), "--size", "64", "48"]) == 0
    plain = packed.with_name("ball.dmesh.png").read_bytes()
    assert pixels(plain).shape == (48, 64, 3)
    capsys.readouterr()
    target = packed.with_name("e.png")
    line = ["render", "--json", str(packed), "--error", str(mesh), "-o", str(target)]
    assert run(line) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["bytes"] == target.stat().st_size
    assert spread(target.read_bytes()) > 100


def test_another_structure_and_no_direction_are_refused(
    files: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    _, packed = files
    other = packed.with_name("other.ply")
    deltamesh.write_mesh(other, from_triangles(*meshes.icosphere(1)))
    assert run(["render", str(packed), "--error", str(other)]) == 1
    assert "do not correspond" in capsys.readouterr().err
    assert run(["render", str(packed), "--up", "0", "0", "0"]) == 2
    assert not packed.with_name("ball.dmesh.png").exists()


def test_without_pyvista_the_extra_is_named(
    files: tuple[Path, Path],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    assert run(["render", str(files[1])]) == 1
    assert 'pip install "deltamesh[view]"' in capsys.readouterr().err
