"""The code of docs/ci.md runs, in the order of the page."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import children
import pytest
from places import ROOT

from deltamesh_cli.program import run

PAGE = (ROOT / "docs" / "ci.md").read_text(encoding="utf-8")


def test_the_code_of_the_page_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "meshes" / "deep").mkdir(parents=True)
    torus = (ROOT / "benchmarks" / "meshes" / "torus.ply").read_bytes()
    for name in ("torus.ply", "deep/torus.ply"):
        (tmp_path / "meshes" / name).write_bytes(torus)
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^<!-- run -->\n```(\w+)\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    *commands, (language, python) = blocks
    assert [one for one, _ in commands] == ["sh"] * 3
    said = []
    for _, command in commands:
        program, *arguments = shlex.split(command)
        assert (program, run(arguments)) == ("deltamesh", 0)
        said.append(capsys.readouterr().out)
    assert "2 rows match rates.csv" in said[1]
    assert language == "python"
    done = children.run([sys.executable, "-c", python], text=True)
    assert done.returncode == 0, done.stderr
    assert "deep/torus.ply" in done.stdout
    assert "gone" in done.stdout
    assert "grew" not in done.stdout


def test_the_workflow_runs_the_command_of_the_page() -> None:
    workflow = re.findall(r"^```yaml\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)[0]
    (check,) = re.findall(r"run: (deltamesh .*)$", workflow, re.MULTILINE)
    assert f"```sh\n{check}\n```" in PAGE
