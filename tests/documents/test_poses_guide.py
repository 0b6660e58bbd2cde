"""The code of docs/poses.md runs, in the order of the page, and its numbers are printed."""

from __future__ import annotations

import importlib
import re
import shlex
import sys
from pathlib import Path

import children
import numpy as np
import pytest
from places import BENCHMARKS, ROOT

import deltamesh
from deltamesh._measures.metrics import vertex_errors
from deltamesh_cli.program import run

sys.path.append(str(BENCHMARKS))
corpus, poses = map(importlib.import_module, ("corpus", "poses"))

PAGE = (ROOT / "docs" / "poses.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^<!-- run -->\n```(\w+)\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
SCHEMES, RECORDS = re.findall(r"^```text\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)


def rows(block: str) -> list[list[str]]:
    """Words of the lines of a table, without the first, in columns that two blanks part."""
    return [re.split(r" {2,}", line.strip()) for line in block.splitlines()[1:]]


def test_the_code_of_the_page_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    deltamesh.write_mesh("bar.ply", poses.bar())
    assert [language for language, _ in BLOCKS] == ["sh", "sh", "sh", "python"]
    for _, block in BLOCKS[:3]:
        for line in block.splitlines():
            program, *arguments = shlex.split(line)
            assert (program, run(arguments)) == ("deltamesh", 0), capsys.readouterr().err
    said = capsys.readouterr()
    assert 'poses (2): "bent"' in said.out
    rest, bent = (deltamesh.read_mesh(name) for name in ("rest.obj", "bent.obj"))
    V, W = rest.vertices, bent.vertices
    assert vertex_errors(V, W, rest.faces).dihedral < 0.8
    assert np.abs(W[V[:, 2] > 5.7].mean(axis=0) - [3.2, 0, 3.4]).max() < 0.05
    assert "without pose dragged, bent\n" in said.out
    turned = deltamesh.load("dragged.dmesh", pose="dragged").vertices
    assert np.abs(turned - deltamesh.load("dragged.dmesh").vertices)[:, 0].max() > 1.4
    done = children.run([sys.executable, "-W", "error", "-c", BLOCKS[3][1]], text=True)
    assert done.returncode == 0, done.stderr
    assert re.match(r"\d+ bytes, 26 anchors, off by 0\.00\d+ of the diagonal\n", done.stdout)


def test_the_schemes_are_those_that_the_benchmark_prints() -> None:
    """To the digits of the page; what is missed is rounding, and below what the page promises."""
    mesh, found = poses.mesh_of("bar"), []
    for edit in poses.edits("bar", mesh.vertices):
        found += [list(row) for row in poses.scheme_rows(mesh, edit)]
    assert [row[:-1] for row in found] == [row[:-1] for row in rows(SCHEMES)]
    assert max(float(row[-1]) for row in found + rows(SCHEMES)) < 1e-9


@pytest.mark.parametrize(
    ("name", "share"), [("bar", 0.005), pytest.param("bunny", 0.005, marks=pytest.mark.slow)]
)
def test_the_records_are_those_that_the_benchmark_prints(name: str, share: float) -> None:
    if name != "bar" and not corpus.path(name).is_file():
        pytest.skip(f"no {corpus.path(name)}: DELTAMESH_MESHES names the folder of larger meshes")
    mesh = poses.mesh_of(name)
    known = {
        row[0]: row for row in rows(RECORDS) if row[1] == str(round(share * len(mesh.vertices)))
    }
    for edit in poses.edits(name, mesh.vertices):
        found = list(poses.record_row(mesh, edit, share))
        wanted = known[found[0]]
        for own, said in zip(found[1:6], wanted[1:6], strict=True):
            assert float(own.strip(" %")) == pytest.approx(float(said.strip(" %")), rel=0.02)
        errors = (" ".join(row[6:]).split() for row in (found, wanted))
        for own, said in zip(*errors, strict=True):  # a hundredth of a degree is the last digit
            assert float(own) == pytest.approx(float(said), rel=0.03)
