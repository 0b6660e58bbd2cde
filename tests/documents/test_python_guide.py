"""The blocks of docs/python.md run, in their order, and do what is said of them."""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

import children
import pytest
from places import ROOT

PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
BLOCKS = dict(re.findall(r"^<!-- run: (\w+) -->\n```python\n(.*?)^```$", PAGE, re.DOTALL | re.M))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    top = tmp_path_factory.mktemp("guide")
    shutil.copy(ROOT / "benchmarks" / "meshes" / "torus.ply", top)
    return top


def run(folder: Path, name: str) -> str:
    code = BLOCKS[name]
    for library in ("trimesh", "meshio", "pyvista"):
        if re.search(rf"\b{library}\b", code):
            pytest.importorskip(library)
    done = children.run([sys.executable, "-W", "error", "-c", code], cwd=folder, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_every_block_is_run_here() -> None:
    assert len(BLOCKS) == PAGE.count("```") / 2
    here = Path(__file__).read_text(encoding="utf-8")
    for name in BLOCKS:
        assert f'run(folder, "{name}")' in here


def test_arrays_and_files(folder: Path) -> None:
    assert run(folder, "arrays").count("[") == 10
    said = run(folder, "files")
    assert said.startswith("<PolyMesh: 2592 vertices, 5184 triangles")
    assert "bits per vertex" in said
    assert (folder / "again.obj").exists()
    assert run(folder, "processes").count("<PolyMesh: 2592 vertices") == 4


def test_attributes_and_the_notebook(folder: Path) -> None:
    said = run(folder, "attributes").splitlines()
    assert said[0] == (
        "<PolyMesh: 9 vertices, 4 quads; vertex data: temperature (float64); "
        "corner data: uv (float64 x 2); face data: region (int64)>"
    )
    assert "()" in said
    assert said[-1] == "vertex attribute 'temperature' has shape (2,), not (9,) or (9, width)"
    kept = run(folder, "options")
    assert kept == (
        "[('temperature', 'vertex', dtype('float64'), 1), ('uv', 'corner', dtype('float64'), 2)]\n"
    )
    assert "bits per vertex" in run(folder, "notebook")


def test_trimesh(folder: Path) -> None:
    assert float(run(folder, "trimesh")) < 1e-3 * 2 * 3**0.5


def test_meshio(folder: Path) -> None:
    assert "triangle: 5184" in run(folder, "meshio")


@pytest.mark.slow
def test_pyvista(folder: Path) -> None:
    from importlib.metadata import entry_points

    if not any(each.group == "pyvista.readers" for each in entry_points(name=".dmesh")):
        pytest.skip("deltamesh is not installed with its entry points")
    assert "N Points:   842" in run(folder, "pyvista")


def test_from_one_to_the_other(folder: Path) -> None:
    said = run(folder, "between")
    assert "trimesh.Trimesh(vertices.shape=(2592, 3)" in said
    assert (folder / "grid.dmesh").exists()
