"""Decimal places of the positions in a text: `--digits` of `decode` and `batch`."""

from __future__ import annotations

from pathlib import Path

import meshes
import pytest

from deltamesh_cli.program import run
from deltamesh_formats.meshfiles.files import write_mesh
from deltamesh_formats.polymesh.mesh import from_triangles


@pytest.fixture(autouse=True)
def encoded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_mesh("torus.obj", from_triangles(*meshes.torus(9, 7)))
    assert cli("encode torus.obj a.dmesh --max-error 0.01 -q") == 0


def cli(line: str) -> int:
    return run(line.split())


def places(name: str) -> int:
    rows = [line.split()[1:] for line in Path(name).read_text().splitlines() if line[:2] == "v "]
    return max(len(number.partition(".")[2]) for row in rows for number in row)


def test_a_text_has_so_many_places(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("decode a.dmesh fine.obj --digits 9") == 0
    assert "not kept" not in capsys.readouterr().err
    assert places("fine.obj") == 9
    assert cli("decode a.dmesh one.obj --digits 1") == 0
    assert "positions beyond 1 decimal places (by up to 0.0" in capsys.readouterr().err
    assert places("one.obj") == 1


def test_a_batch_has_the_option_too() -> None:
    assert cli("batch -d a.dmesh --output-format obj --digits 2 -q") == 0
    assert places("a.obj") == 2


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("decode a.dmesh a.ply --digits 3", "--digits means nothing for ply, which is binary"),
        ("decode a.dmesh a.obj --digits 21", "'21' is not a whole number from 0 to 20"),
        ("batch torus.obj --digits 2", "--digits means nothing without -d"),
    ],
)
def test_usage(line: str, message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli(line) == 2
    assert message in " ".join(capsys.readouterr().err.split())
