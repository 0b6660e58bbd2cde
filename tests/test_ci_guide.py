"""The code of docs/ci.md runs, in the order of the page."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "ci.md").read_text(encoding="utf-8")


def run(language: str, code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    if language == "sh":
        program, *arguments = shlex.split(code)
        assert program == "deltamesh"
        command = [sys.executable, "-m", "deltamesh_cli", *arguments]
    else:
        command = [sys.executable, "-c", code]
    return subprocess.run(
        command, cwd=folder, env=os.environ, capture_output=True, text=True, check=True
    )


def test_the_code_of_the_page_runs(tmp_path: Path) -> None:
    (tmp_path / "meshes" / "deep").mkdir(parents=True)
    torus = (ROOT / "benchmarks" / "meshes" / "torus.ply").read_bytes()
    for name in ("torus.ply", "deep/torus.ply"):
        (tmp_path / "meshes" / name).write_bytes(torus)
    blocks = re.findall(r"^<!-- run -->\n```(\w+)\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    assert [language for language, _ in blocks] == ["sh", "sh", "sh", "python"]
    said = [run(language, code, tmp_path).stdout for language, code in blocks]
    assert "2 rows are as in rates.csv" in said[1]
    assert "deep/torus.ply" in said[3]
    assert "gone" in said[3]
    assert "grew" not in said[3]


def test_the_workflow_runs_the_command_of_the_page() -> None:
    workflow = re.findall(r"^```yaml\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)[0]
    (check,) = re.findall(r"run: (deltamesh .*)$", workflow, re.MULTILINE)
    assert f"```sh\n{check}\n```" in PAGE
