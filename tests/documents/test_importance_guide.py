"""The blocks of docs/importance.md run, and its numbers are those that are measured."""

from __future__ import annotations

import importlib
import os
import re
import sys
from pathlib import Path

import guides
import meshes
import numpy as np
import pytest
from places import BENCHMARKS, ROOT

import deltamesh

sys.path.append(str(BENCHMARKS))
corpus, importance = map(importlib.import_module, ("corpus", "importance"))

GUIDE = (ROOT / "docs" / "importance.md").read_text(encoding="utf-8")
BLOCKS = guides.blocks_of(GUIDE)
ROWS = [row for row in GUIDE.splitlines() if re.match(r"\| (bunny|horse) \|", row)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    top = tmp_path_factory.mktemp("guide")
    V, F = meshes.torus(90, 60)
    V = V + 0.003 * np.random.default_rng(2).normal(size=V.shape)
    quality = np.where(V[:, 0] > 0, 1.0, 0.125).astype(np.float32)
    mesh = deltamesh.from_arrays(V, F, vertex={"quality": quality})
    deltamesh.write_mesh(top / "scan.ply", mesh)
    return top


def test_every_block_and_every_row_is_tested_here() -> None:
    assert set(BLOCKS) == {"commands", "python"}
    assert GUIDE.count("```") / 2 == len(BLOCKS)
    assert importance.HEAD in GUIDE
    assert importance.HOLE_HEAD in GUIDE
    assert len(ROWS) == 2 * 2 * 3


@pytest.mark.skipif(os.name != "posix", reason="a block for a shell of POSIX")
def test_its_blocks_run(folder: Path) -> None:
    done = guides.run_shell(BLOCKS["commands"], folder)
    assert done.stdout.count("errors are weighted: importance 1 of ") == 3
    assert "quality" not in deltamesh.load(folder / "small.dmesh").vertex_data
    assert "quality" in deltamesh.load(folder / "scan.ply.dmesh").vertex_data
    done = guides.run_python(BLOCKS["python"], folder)
    less, more = map(int, re.fullmatch(r"(\d+) bytes, all alike: (\d+)\n", done.stdout).groups())
    assert less < more


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bunny", "horse"])
def test_its_numbers_are_what_is_measured(name: str) -> None:
    if not corpus.path(name).is_file():
        pytest.skip(f"no {name} in {corpus.folder()}")
    found = [str(row) for row in importance.rows_of(name, (0.125, 0.0))]
    assert found == [row for row in ROWS if row.startswith(f"| {name} ")]


@pytest.mark.slow
def test_the_head_of_the_camel_is_what_is_measured() -> None:
    if not corpus.path("camelhead").is_file():
        pytest.skip(f"no camelhead in {corpus.folder()}")
    assert str(importance.hole()) in GUIDE


def test_its_shares_are_those_of_its_table() -> None:
    sizes = [int(row.split(" | ")[3].replace(",", "")) for row in ROWS]
    saved = [[100 * (1 - sizes[i + k] / sizes[i]) for i in range(0, 12, 3)] for k in (1, 2)]
    (eighth,) = re.findall(r"an eighth outside, files are (\d+) to (\d+) % smaller", GUIDE)
    (none,) = re.findall(r"any importance outside, (\d+) to (\d+) %", " ".join(GUIDE.split()))
    for told, found in ((eighth, saved[0]), (none, saved[1])):
        assert tuple(map(int, told)) == (round(min(found)), round(max(found)))


@pytest.mark.parametrize("name", re.findall(r"\]\((figures/[^)]+)\)", GUIDE))
def test_its_figures_are_there(name: str) -> None:
    assert (ROOT / "docs" / name).read_bytes().startswith(b"\x89PNG")
