"""The blocks of docs/sequences.md run, and its numbers are those that are measured."""

from __future__ import annotations

import importlib
import os
import re
import sys
from pathlib import Path

import guides
import pytest
from places import BENCHMARKS, ROOT

import deltamesh

sys.path.append(str(BENCHMARKS))
corpus, sequences = map(importlib.import_module, ("corpus", "sequences"))

GUIDE = (ROOT / "docs" / "sequences.md").read_text(encoding="utf-8")
BLOCKS = guides.blocks_of(GUIDE)
TABLES = re.findall(rf"^{re.escape(sequences.HEAD)}\n.*\n((?:\|.*\n)+)", GUIDE, re.MULTILINE)
FRAMES = 12


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    top = tmp_path_factory.mktemp("guide")
    (top / "frames").mkdir()
    torus = corpus.bare(corpus.GENERATED)
    for i, V in enumerate(sequences.animation(torus.vertices, FRAMES, 40)):
        deltamesh.write_mesh(top / "frames" / f"f{i}.ply", deltamesh.from_arrays(V, torus.faces))
    return top


def test_every_block_is_tested_here() -> None:
    assert set(BLOCKS) == {"commands", "python"}
    assert GUIDE.count("```") / 2 == len(BLOCKS)
    assert len(TABLES) == 2


@pytest.mark.skipif(os.name != "posix", reason="a block for a shell of POSIX")
def test_its_blocks_run(folder: Path) -> None:
    done = guides.run_shell(BLOCKS["commands"], folder)
    assert f"frames: {FRAMES} at 25 a second, key frames 0" in done.stdout
    assert "worst further frame: " in done.stdout
    assert len(list((folder / "all").glob("walk_*.ply"))) == FRAMES
    assert (folder / "f011.stl").is_file()
    done = guides.run_python(BLOCKS["python"], folder)
    assert done.stdout.startswith("10 25.0\n")
    assert done.stdout.count("\n") == 11


def test_a_sequence_of_the_generated_mesh_is_smaller_than_files() -> None:
    several, each, *_ = sequences.rows(corpus.bare(corpus.GENERATED), 3, 40)
    assert several.frame < 0.6 * each.frame
    assert several.normals <= 1
    assert re.fullmatch(r"\| deltamesh, a sequence \|( [^|]+ \|){6}", str(several))


@pytest.mark.slow
@pytest.mark.parametrize(("table", "frames", "cycle"), [(0, 20, 20), (1, 12, 100)])
def test_its_numbers_are_what_is_measured(table: int, frames: int, cycle: int) -> None:
    if not corpus.path("bunny").is_file():
        pytest.skip(f"no bunny in {corpus.folder()}")
    mesh = corpus.bare("bunny")
    found = sequences.of_sequence(list(sequences.animation(mesh.vertices, frames, cycle)), mesh)
    told = TABLES[table].splitlines()[0].split(" | ")
    assert str(found).split(" | ")[:-1] == told[:-1]  # but for the time
