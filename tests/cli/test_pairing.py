"""Comparison of two folders: files are paired by their names."""

from __future__ import annotations

import json
from pathlib import Path

import meshes
import pytest
from commandline import cli

from deltamesh_cli.failures import Failure
from deltamesh_cli.inputs import Input
from deltamesh_cli.pairing import Folder
from deltamesh_formats.meshfiles.files import mesh_bytes
from deltamesh_formats.polymesh.mesh import from_triangles


@pytest.fixture
def folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name in ("a/torus.obj", "a/below/ball.ply"):
        mesh = meshes.torus(9, 7) if "torus" in name else meshes.icosphere(1)
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(mesh_bytes(from_triangles(*mesh), name[-3:]))
    assert cli("batch -q -r a --output-dir-mirror b") == 0
    return tmp_path


def test_the_same_name_counts_most(tmp_path: Path) -> None:
    def found(*names: str) -> str:
        for old in tmp_path.iterdir():
            old.unlink()
        for name in names:
            (tmp_path / name).touch()
        folder = Folder(str(tmp_path), recursive=False)
        return Path(folder.counterpart(Input("x/a.ply", "a.ply"))).name

    assert found("a.ply", "a.ply.dmesh", "a.obj") == "a.ply"
    assert found("a.ply.dmesh", "a.obj") == "a.ply.dmesh"
    assert found("a.ply.dmesh.zst", "a.dmesh") == "a.ply.dmesh.zst"
    assert found("a.dmesh", "b.ply") == "a.dmesh"
    assert found("a.obj.gz", "a.ply.txt") == "a.obj.gz"
    with pytest.raises(Failure, match=r"x/a.ply: cannot compare: a.obj and a.stl in .* its name"):
        found("a.stl", "a.obj")
    with pytest.raises(Failure, match=r"x/a.ply: cannot compare: no file in .* has its name"):
        found("b.ply")


def test_folders_are_compared_file_by_file(
    folders: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli("compare -r --json a b/a") == 0
    pairs = [
        (one["a"]["file"], one["b"]["file"], one["errors"]["normal_deviation_degrees"])
        for one in map(json.loads, capsys.readouterr().out.splitlines())
    ]
    assert [pair[:2] for pair in pairs] == [
        ("a/below/ball.ply", "b/a/below/ball.ply.dmesh"),
        ("a/torus.obj", "b/a/torus.obj.dmesh"),
    ]
    assert all(0 < pair[2] <= 1 for pair in pairs)
    assert cli("compare a b/a") == 0
    found = capsys.readouterr()
    assert found.out.startswith("a/torus.obj: ")
    assert "\nb/a/torus.obj.dmesh: " in found.out
    assert found.err == ""


def test_a_file_without_counterpart_fails_and_those_of_b_are_noted(
    folders: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folders / "a" / "new.ply").write_bytes((folders / "a" / "below" / "ball.ply").read_bytes())
    (folders / "a" / "torus.obj").unlink()
    assert cli("compare -r --json a b/a") == 1
    found = capsys.readouterr()
    assert found.err.splitlines() == [
        "deltamesh: a/new.ply: cannot compare: no file in b/a has its name",
        "note: b/a: in no A: 1 files, the first b/a/torus.obj.dmesh",
    ]
    last = json.loads(found.out.splitlines()[-1])
    assert (last["file"], last["exit_code"]) == ("a/new.ply", 1)
    assert cli("compare -r a b/a --exclude new.ply") == 0
    assert capsys.readouterr().err == ""


def test_files_are_compared_with_a_folder_and_many_with_no_file(
    folders: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli("compare -q a/torus.obj a/below/ball.ply b/a") == 1  # ball is in a folder of b/a
    assert cli("compare -q a/torus.obj a/below/ball.ply b/a -r") == 1
    assert "ball.ply: cannot compare" in capsys.readouterr().err
    for line in ("compare a b/a/torus.obj.dmesh", "compare a/torus.obj a/below/ball.ply nothing"):
        assert cli(line) == 2
        assert "has to be a folder" in capsys.readouterr().err
    assert cli("compare a") == 2
    assert "A is missing" in capsys.readouterr().err
