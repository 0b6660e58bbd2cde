"""Commands with --lossless."""

from __future__ import annotations

import json

import meshes
import numpy as np
import pytest

from deltamesh import decode
from deltamesh_cli.program import run
from deltamesh_formats.polymesh.mesh import from_triangles


@pytest.fixture
def mesh_file(tmp_path, monkeypatch):
    from deltamesh_formats.meshfiles.files import write_mesh

    monkeypatch.chdir(tmp_path)
    V, F = meshes.torus(9, 7)
    write_mesh("torus.obj", from_triangles(np.where(V == 0, -0.0, V), F))


def cli(line: str) -> int:
    return run(line.split())


@pytest.mark.parametrize("more", ["--bits 8", "--max-error 1", "--anchors 5", "--method cartesian"])
def test_usage(mesh_file: None, capsys: pytest.CaptureFixture[str], more: str) -> None:
    assert cli(f"encode torus.obj --lossless {more}") == 2
    assert more.split()[0] in capsys.readouterr().err


def test_commands(mesh_file: None, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("encode torus.obj a.dmesh --lossless") == 0
    assert "RMS 0 and max 0 of the diagonal, normals 0" in capsys.readouterr().out
    assert cli("encode torus.obj b.dmesh --method lossless") == 0
    assert cli("test a.dmesh b.dmesh") == 0
    capsys.readouterr()
    assert cli("info a.dmesh") == 0
    assert "\n  lossless\n" in capsys.readouterr().out
    assert cli("compare torus.obj a.dmesh --json") == 0
    errors = json.loads(capsys.readouterr().out)["errors"]
    assert errors.pop("diagonal") > 0
    assert (errors.pop("parts"), errors.pop("worst_part")) == (1, None)
    assert set(errors.values()) == {0.0}
    assert cli("decode a.dmesh back.obj") == 0
    assert cli("encode back.obj again.dmesh --lossless") == 0
    with open("a.dmesh", "rb") as a, open("again.dmesh", "rb") as again:
        assert sorted(map(bytes, decode(a.read()).vertices)) == sorted(
            map(bytes, decode(again.read()).vertices)
        )


def test_compare_tells_zeros_apart(tmp_path, capsys: pytest.CaptureFixture[str]) -> None:
    """As the encoder does: two vertices at one position, but for the sign of a zero, are two."""
    lines = "0 0 0", "1 0 0", "0 1 0", "-0.0 1 0", "1 -0.0 0", "1 1 0"
    text = "".join(f"v {line}\n" for line in lines)
    (tmp_path / "two.obj").write_text(f"{text}f 1 2 3\nf 4 5 6\n")
    assert cli(f"encode {tmp_path}/two.obj {tmp_path}/two.dmesh --lossless") == 0
    capsys.readouterr()
    assert cli(f"compare {tmp_path}/two.obj {tmp_path}/two.dmesh --json") == 0
    shown = json.loads(capsys.readouterr().out)
    assert shown["b"]["vertices"] == 6
    assert shown["errors"]["rms"] == 0
