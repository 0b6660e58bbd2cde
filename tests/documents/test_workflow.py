"""The workflow that builds wheels and runs them: the commands that can be run here."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

import children
import pytest
from places import ROOT

from deltamesh_cli.program import run

yaml = pytest.importorskip("yaml")  # of dask


def commands(job: str) -> list[list[str]]:
    """The words of each command of a job."""
    path = ROOT / ".github" / "workflows" / "wheels.yml"
    steps = yaml.safe_load(path.read_text(encoding="utf-8"))["jobs"][job]["steps"]
    lines = "\n".join(step["run"] for step in steps if "run" in step).splitlines()
    return [shlex.split(line) for line in lines if line]


def test_wheels_are_built_by_a_script_that_is_there() -> None:
    (script,) = commands("build")[-1]
    assert (ROOT / script).is_file()


def test_what_runs_on_each_system(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "benchmarks").symlink_to(ROOT / "benchmarks")
    monkeypatch.chdir(tmp_path)
    installed = [words for words in commands("run") if words[0] == "deltamesh"]
    assert [words[1] for words in installed] == ["encode", "decode", "compare"]
    assert [run(words[1:]) for words in installed] == [0, 0, 0]


def test_what_runs_where_only_numpy_is() -> None:
    python, *words = commands("musl")[-1]
    assert python == "python"
    children.run([sys.executable, *words], check=True)
