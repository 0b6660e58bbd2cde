"""The blocks of docs/research.md run, in their order, and show what is said of them."""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

import children
import pytest
from places import ROOT

PAGE = (ROOT / "docs" / "research.md").read_text(encoding="utf-8")
BLOCKS = dict(re.findall(r"^<!-- run: (\w+) -->\n```python\n(.*?)^```$", PAGE, re.DOTALL | re.M))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    top = tmp_path_factory.mktemp("research")
    shutil.copy(ROOT / "benchmarks" / "meshes" / "torus.ply", top)
    return top


def run(folder: Path, name: str) -> list[tuple[float, ...]]:
    """Return the numbers of each line that a block prints."""
    command = [sys.executable, "-W", "error", "-c", BLOCKS[name]]
    done = children.run(command, cwd=folder, text=True)
    assert done.returncode == 0, done.stderr
    found = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?")
    return [tuple(map(float, found.findall(line))) for line in done.stdout.splitlines()]


def test_every_block_is_run_here() -> None:
    assert len(BLOCKS) == PAGE.count("```") / 2
    here = Path(__file__).read_text(encoding="utf-8")
    for name in BLOCKS:
        assert f'run(folder, "{name}")' in here


def test_a_least_squares_mesh_takes_ten_lines(folder: Path) -> None:
    assert len([line for line in BLOCKS["smooth"].splitlines() if line]) == 10
    ((rms,),) = run(folder, "smooth")
    assert 0 < rms < 0.02


def test_fitted_anchors_are_the_best_and_hard_ones_are_met(folder: Path) -> None:
    soft, (_, heavy, _), hard, fitted, erased = run(folder, "anchors")
    assert fitted[0] < hard[0] <= heavy < soft[0] < erased[0]
    assert hard[1] == erased[1] == 0 < soft[1]


def test_basis_functions_are_about_as_good_as_eigenvectors(folder: Path) -> None:
    shape, (peak,), (functions,), (eigenvectors,) = run(folder, "bases")
    assert shape == (2592, 60)
    assert 0.98 < peak <= 1
    assert 0.5 < functions / eigenvectors < 2


def test_errors_of_deltas_are_of_low_frequency(folder: Path) -> None:
    plain, diffused, (grid,) = run(folder, "spectrum")
    assert plain[1] > 0.99 > diffused[1] > grid
    assert (plain[2], diffused[2]) == pytest.approx((-2, -0.8), abs=0.3)


def test_less_detail_is_smoother(folder: Path) -> None:
    (none, half, whole, double) = run(folder, "detail")
    assert none[1] > half[1] > whole[1] == 0 < double[1]


def test_turned_deltas_keep_the_shape(folder: Path) -> None:
    (plain, miss), (turned, less) = run(folder, "edit")
    assert turned < plain / 2
    assert less < miss
