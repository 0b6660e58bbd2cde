"""The blocks of docs/browser.md run, in their order, and do what is said of them."""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import sys
from pathlib import Path

import children
import guides
import pytest
from places import ROOT

from deltamesh import info
from deltamesh._page.filling import PAGE, REPORT

GUIDE = (ROOT / "docs" / "browser.md").read_text(encoding="utf-8")
BLOCKS = guides.blocks_of(GUIDE)
BUILD = "python src/core/build.py --npm deltamesh-js"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    top = tmp_path_factory.mktemp("guide")
    shutil.copy(ROOT / "benchmarks" / "meshes" / "torus.ply", top)
    return top


def test_every_block_is_run_here() -> None:
    assert set(BLOCKS) == {"view", "report", "decode"}
    assert BUILD in GUIDE
    assert GUIDE.count("```") / 2 == len(BLOCKS) + 2
    # That one needs an extra: cli/test_render.py.
    assert "deltamesh render torus.dmesh --error torus.ply -o torus.png\n" in GUIDE


@pytest.mark.skipif(os.name != "posix", reason="a block for a shell of POSIX")
def test_view(folder: Path) -> None:
    if not PAGE.exists():
        pytest.skip("an installation without the page")
    guides.run_shell(BLOCKS["view"], folder)
    page = (folder / "torus.html").read_text(encoding="utf-8")
    assert page.count('class="mesh"') == 2
    assert len(PAGE.read_bytes()) <= 150_000


@pytest.mark.skipif(os.name != "posix", reason="a block for a shell of POSIX")
def test_report(folder: Path) -> None:
    if not REPORT.exists():
        pytest.skip("an installation without the page")
    guides.run_shell(BLOCKS["report"], folder)
    for name, count in (("bench.html", 7), ("batch.html", 1)):
        text = (folder / name).read_text(encoding="utf-8")
        assert text.count('class="mesh"') == count


def test_decode(folder: Path) -> None:
    node = shutil.which("node")
    if node is None:
        pytest.skip("no node")
    if not importlib.util.find_spec("ziglang"):
        pytest.skip("no ziglang")
    script = str(ROOT / "src" / "core" / "build.py")
    children.run([sys.executable, script, *BUILD.split()[2:]], cwd=folder, check=True)
    (folder / "decode.mjs").write_text(BLOCKS["decode"], encoding="utf-8")
    done = children.run([node, "decode.mjs"], cwd=folder, text=True)
    assert done.stderr == ""
    container = info((folder / "torus.dmesh").read_bytes())
    assert done.stdout.splitlines() == [
        f"{container.vertices} {container.triangles} {container.triangles}",
        container.parameters.method,
        "true 100",
    ]


@pytest.mark.parametrize("name", re.findall(r"\]\((figures/[^)]+)\)", GUIDE))
def test_its_figures_are_there(name: str) -> None:
    assert (ROOT / "docs" / name).read_bytes().startswith(b"\x89PNG")
