"""The blocks of docs/partial.md run, and its numbers are those that are measured."""

from __future__ import annotations

import importlib
import os
import re
import shutil
import sys
from pathlib import Path

import guides
import pytest
from places import BENCHMARKS, ROOT

from deltamesh_formats.container.stages import STAGES

sys.path.append(str(BENCHMARKS))
corpus, partial = map(importlib.import_module, ("corpus", "partial"))

GUIDE = (ROOT / "docs" / "partial.md").read_text(encoding="utf-8")
BLOCKS = guides.blocks_of(GUIDE)
ROWS = [row for row in GUIDE.splitlines() if re.match(r"\| (bunny|horse) \|", row)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    top = tmp_path_factory.mktemp("guide")
    shutil.copy(ROOT / "benchmarks" / "meshes" / "torus.ply", top)
    return top


def test_every_block_and_every_row_is_tested_here() -> None:
    assert set(BLOCKS) == {"commands", "python"}
    assert GUIDE.count("```") / 2 == len(BLOCKS)
    assert partial.HEAD in GUIDE
    assert {row.split(" | ")[1] for row in ROWS} == set(STAGES)
    stages = re.findall(r"^\| `(\w+)` \|", GUIDE, re.MULTILINE)
    assert tuple(stages) == STAGES


@pytest.mark.skipif(os.name != "posix", reason="a block for a shell of POSIX")
def test_its_blocks_run(folder: Path) -> None:
    done = guides.run_shell(BLOCKS["commands"], folder)
    assert done.stderr.startswith("note: part.dmesh: stage deltas, ")
    assert "note: standard input: stage anchors, " in done.stderr
    assert "stages, by their bytes: anchors " in done.stdout
    assert "not there yet, if the file has them: refinements" in done.stdout
    done = guides.run_python(BLOCKS["python"], folder)
    assert done.stdout.startswith("deltas ")
    assert done.stdout.endswith("whole True\n")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bunny", "horse"])
def test_its_numbers_are_what_is_measured(name: str) -> None:
    if not corpus.path(name).is_file():
        pytest.skip(f"no {name} in {corpus.folder()}")
    found = [stage.row(name) for stage in partial.stages_of_mesh(corpus.bare(name))]
    assert found == [row for row in ROWS if row.startswith(f"| {name} ")]


@pytest.mark.slow
def test_its_solutions_are_what_is_measured() -> None:
    if not corpus.path("bunny").is_file():
        pytest.skip(f"no bunny in {corpus.folder()}")
    text = " ".join(GUIDE.split())
    for stage in partial.coarse_surfaces(corpus.bare("bunny")):
        assert re.search(
            rf"{stage.rms:.1e}( of the diagonal)? \((normals )?{stage.normals:.2f}", text
        )


@pytest.mark.parametrize("name", re.findall(r"\]\((figures/[^)]+)\)", GUIDE))
def test_its_figures_are_there(name: str) -> None:
    assert (ROOT / "docs" / name).read_bytes().startswith(b"\x89PNG")
