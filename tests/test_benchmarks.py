"""The benchmarks run, and `results.csv` is what they measure of the repository's own mesh."""

from __future__ import annotations

import importlib
import os
import sys
from itertools import product
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
from click.testing import CliRunner, Result

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
sys.path.append(str(BENCHMARKS))
corpus, measurement, processes, results, run = map(
    importlib.import_module, ("corpus", "measurement", "processes", "results", "run")
)
SCRIPTS = (
    "run",
    "speed",
    "draco",
    "lossless",
    "valences",
    "order",
    "memory",
    "make_folder",
    "batch",
)
TORUS = corpus.GENERATED
Rows = list[dict[str, str]]


@pytest.fixture(scope="module")
def rows() -> Rows:
    """What is measured now, of the generated mesh."""
    return list(run.measured((TORUS,), jobs=1))


@pytest.fixture
def call(rows: Rows, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Call `run.py` on the generated mesh, measured once for all tests."""
    monkeypatch.setattr(run, "measured", lambda names, jobs: iter(rows))

    def invoke(*arguments: object) -> Result:
        return CliRunner().invoke(run.command, ["--quick", *map(str, arguments)])

    return invoke


def altered(row: dict[str, str], **columns: str) -> dict[str, str]:
    return {**row, **columns}


def test_the_committed_results_are_current(call: Any) -> None:
    done = call("--check")
    assert done.exit_code == 0, f"{done.output}\nwas that meant? then: python benchmarks/run.py"
    assert "20 rows are as in" in done.output


def test_the_committed_results_are_complete_and_have_no_times() -> None:
    committed = results.read(results.RESULTS)
    expected = [
        (name, one.method, str(one.bits), one.diffusion)
        for name, one in product(corpus.NAMES, measurement.CONFIGURATIONS)
    ]
    assert [results.key(row) for row in committed] == expected
    assert tuple(committed[0]) == measurement.COLUMNS
    assert set(measurement.COLUMNS) == {
        *measurement.KEYS,
        *measurement.EXACT,
        *measurement.ERRORS,
    }


def test_results_are_text_of_four_digits(rows: Rows) -> None:
    for row in rows:
        for column in (*measurement.EXACT[3:], *measurement.ERRORS):
            assert row[column] == measurement.number(float(row[column]))
        sections = sum(float(row[column]) for column in measurement.EXACT[4:])
        assert sections == pytest.approx(float(row["bpv"]), rel=1e-3)


def test_diffusion_lowers_the_error_of_the_generated_mesh(rows: Rows) -> None:
    rms = {results.key(row)[1:]: float(row["rms"]) for row in rows}
    for bits in "45678":
        assert rms["highpass", bits, "on"] * 3 < rms["highpass", bits, "off"]


def test_check_tells_what_changed(call: Any, rows: Rows, tmp_path: Path) -> None:
    file = tmp_path / "results.csv"
    results.write(file, [altered(rows[0], bytes="12345"), *rows[1:]])
    before = file.read_bytes()
    done = call("--check", "--results", file)
    assert done.exit_code == 1
    last = done.stdout.splitlines()[-1].split()
    assert last == [TORUS, "highpass", "4", "on", "bytes", "12345", rows[0]["bytes"]]
    assert file.read_bytes() == before


def test_check_needs_something_to_compare_with(call: Any, tmp_path: Path) -> None:
    done = call("--check", "--results", tmp_path / "results.csv")
    assert done.exit_code == 1
    assert "nothing to compare with" in done.output


def test_rows_of_other_meshes_stay(call: Any, rows: Rows, tmp_path: Path) -> None:
    file = tmp_path / "results.csv"
    horse = altered(rows[0], mesh="horse", bytes="1")
    results.write(file, [altered(rows[0], bytes="2"), horse])
    assert call("--results", file).exit_code == 0
    assert results.read(file) == [*rows, horse]


def test_errors_may_differ_by_one_percent_and_sizes_not(rows: Rows) -> None:
    row = altered(rows[0], rms="0.001")
    old = altered(row, rms="0.0010099", vertices="1")
    assert [one[4:] for one in results.changes([old], [row])] == [
        ("vertices", "1", row["vertices"])
    ]
    for rms in ("0.001011", "0", "nan", ""):
        changed = results.changes([altered(row, rms=rms)], [row])
        assert [one[4:] for one in changed] == [("rms", rms, "0.001")]


def test_rows_that_come_and_go_are_changes(rows: Rows) -> None:
    other = altered(rows[0], mesh="horse")
    assert results.changes([rows[0], other], [rows[1]]) == [
        (*results.key(rows[0]), "row", "there", "gone"),
        (*results.key(rows[1]), "row", "none", "new"),
    ]


def test_missing_meshes_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("DELTAMESH_MESHES", str(tmp_path))
    assert corpus.chosen((), quick=False) == (TORUS,)
    assert f"skipped, not in {tmp_path}: bunny, horse, " in capsys.readouterr().err
    with pytest.raises(click.ClickException, match="none of these meshes is there"):
        corpus.chosen(("horse",), quick=False)
    assert corpus.files() == [corpus.path(TORUS)]


@pytest.mark.parametrize("script", SCRIPTS)
def test_every_script_has_help_with_examples(script: str) -> None:
    done = CliRunner().invoke(importlib.import_module(script).command, ["--help"])
    assert done.exit_code == 0
    assert f"python benchmarks/{script}.py" in done.output
    assert f"benchmarks/{script}.py" in (BENCHMARKS / "README.md").read_text(encoding="utf-8")


def test_draco_is_not_smaller() -> None:
    pytest.importorskip("DracoPy")
    ours, draco = importlib.import_module("draco").file_sizes(TORUS, 11)
    assert ours < 1.03 * draco


def test_the_entropy_of_valences() -> None:
    entropy = importlib.import_module("valences").entropy
    assert entropy(np.array([6, 6, 6])) == 0
    assert entropy(np.array([4, 5, 6, 7])) == 2
    assert entropy(np.array([6, 6, 5, 7])) == 1.5


def test_a_folder_of_many_meshes_from_few(tmp_path: Path) -> None:
    make_folder = importlib.import_module("make_folder")
    options = ["--count", "12", "--faces", "1500", "--least", "100"]
    for name in ("one", "two"):
        arguments = [str(tmp_path / name), str(corpus.path(TORUS)), *options]
        assert CliRunner().invoke(make_folder.command, arguments).exit_code == 0
    made = sorted((tmp_path / "one").rglob("*.*"))
    assert len(made) == 12
    for path in made:
        assert path.read_bytes() == Path(str(path).replace("/one/", "/two/")).read_bytes()
    sizes = [len(corpus.read(path).faces) for path in made]
    assert all(100 <= size <= 1500 for size in sizes)
    parts = list(make_folder.pieces(corpus.load(TORUS), 1500, 1))
    assert sum(len(part.faces) for part in parts) == 5184, "cutting loses no face"
    assert sizes[:4] == sizes[4:8], "copies"
    first, copy = (corpus.read(made[i]).vertices for i in (0, 4))
    assert 0 < abs(first - copy).max() < 0.01


@pytest.mark.skipif(not hasattr(os, "wait4"), reason="POSIX only")
def test_a_process_is_measured_without_its_parent() -> None:
    used = processes.deltamesh("--version")
    assert 0 < used.seconds < 60
    # This process, with numba in it, has several times that.
    assert 5 << 20 < used.peak < 80 << 20
    with pytest.raises(RuntimeError, match="No such command"):
        processes.deltamesh("nothing")
