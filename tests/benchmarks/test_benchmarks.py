"""The benchmarks run, and `results.csv` is what they measure of the repository's own mesh."""

from __future__ import annotations

import importlib
import json
import math
import os
import sys
from itertools import product
from pathlib import Path
from typing import Any

import click
import meshes
import numpy as np
import pytest
from click.testing import CliRunner, Result
from places import BENCHMARKS

from deltamesh import MeshError, bench
from deltamesh._mesh import TriangleMesh
from deltamesh.bench import _rates as rates

sys.path.append(str(BENCHMARKS))
corpus, curves, equal, headline, large, processes, run, shapes = map(
    importlib.import_module,
    ("corpus", "curves", "equal", "headline", "large", "processes", "run", "shapes"),
)
SCRIPTS = (
    "run",
    "anchors",
    "spikes",
    "headline",
    "curves",
    "speed",
    "lossless",
    "conversions",
    "valences",
    "order",
    "memory",
    "make_folder",
    "batch",
    "paper",
    "renderings",
    "bounds",
    "importance",
    "parts",
    "partial",
    "sequences",
    "readers",
    "large",
)
README = (BENCHMARKS / "README.md").read_text(encoding="utf-8")
TORUS = corpus.GENERATED
FILE = corpus.path(TORUS).name
Rows = list[dict[str, str]]


@pytest.fixture(scope="module")
def rows() -> Rows:
    """What is measured now, of the generated mesh."""
    return [{c: row[c] for c in rates.COLUMNS} for row in run.measured((TORUS,), jobs=1)]


@pytest.fixture
def call(rows: Rows, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Call `run.py` on the generated mesh, measured once for all tests."""
    monkeypatch.setattr(run, "measured", lambda names, jobs: iter(rows))

    def invoke(*arguments: object) -> Result:
        return CliRunner().invoke(run.command, ["--quick", *map(str, arguments)])

    return invoke


def altered(row: dict[str, str], **columns: str) -> dict[str, str]:
    return {**row, **columns}


# ---- results.csv -------------------------------------------------------------------------------


def test_the_committed_results_are_current(call: Any) -> None:
    done = call("--check")
    assert done.exit_code == 0, f"{done.output}\nwas that meant? then: python benchmarks/run.py"
    assert "20 rows are as in" in done.output


def test_the_committed_results_are_complete_and_have_no_times() -> None:
    committed = run.read(run.RESULTS)
    expected = [(corpus.path(name).name, one) for name, one in product(corpus.NAMES, run.CODECS)]
    assert [rates.key(row) for row in committed] == expected
    assert tuple(committed[0]) == rates.COLUMNS
    assert not set(rates.COLUMNS) & set(rates.SECONDS)
    assert rates.as_text(committed) == run.RESULTS.read_text(encoding="utf-8")


def test_diffusion_lowers_the_error_of_the_generated_mesh(rows: Rows) -> None:
    rms = {row["codec"]: float(row["rms"]) for row in rows}
    for bits in "45678":
        assert rms[f"highpass bits={bits}"] * 3 < rms[f"highpass bits={bits} diffusion=False"]


def test_check_tells_what_changed(call: Any, rows: Rows, tmp_path: Path) -> None:
    file = tmp_path / "results.csv"
    one_less = str(int(rows[0]["bytes"]) - 1)
    file.write_text(rates.as_text([altered(rows[0], bytes=one_less), *rows[1:]]))
    before = file.read_bytes()
    done = call("--check", "--results", file)
    assert done.exit_code == 1
    last = done.stdout.splitlines()[-1].split()
    assert last[:6] == [FILE, "highpass", "bits=4", "bytes", one_less, rows[0]["bytes"]]
    assert last[-1] == "grew"
    assert file.read_bytes() == before


def test_check_needs_something_to_compare_with(call: Any, tmp_path: Path) -> None:
    done = call("--check", "--results", tmp_path / "results.csv")
    assert done.exit_code == 1
    assert "nothing to compare with" in done.output


def test_rows_of_other_meshes_stay(call: Any, rows: Rows, tmp_path: Path) -> None:
    file = tmp_path / "results.csv"
    horse = altered(rows[0], mesh="horse.ply", bytes="1")
    file.write_text(rates.as_text([altered(rows[0], bytes="2"), horse]))
    assert call("--results", file).exit_code == 0
    assert run.read(file) == [*rows, horse]


# ---- Sizes at equal error ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def coder() -> Any:
    return equal.Coder("highpass", TriangleMesh(*meshes.torus(40, 30)))


@pytest.mark.parametrize("error", headline.ERRORS)
@pytest.mark.parametrize("setting", [0.003, 0.02])
def test_a_file_at_an_error_is_found(coder: Any, error: str, setting: float) -> None:
    target = getattr(equal.Coder(coder.label, coder.mesh)(setting), error)
    found = equal.coded_at(coder, error, target)
    assert found in coder.points.values()
    assert 0.9 * target < getattr(found, error) <= target
    between = equal.interpolated_at(coder, error, target)
    assert getattr(between, error) == pytest.approx(target)
    assert between.size == pytest.approx(found.size, rel=0.1)


def test_an_error_out_of_reach_is_no_size() -> None:
    coder = equal.Coder("refined", TriangleMesh(*meshes.torus(8, 6)))
    for find in (equal.coded_at, equal.interpolated_at):
        with pytest.raises(MeshError, match="too small for this mesh"):
            find(coder, "normals", 1e-40)


class Law(equal.Coder):
    """A curve by formulas: sizes fall with the setting; beyond 0.3 dihedral angles recover."""

    def __call__(self, setting: float) -> Any:
        dihedral = setting if setting < 0.3 else 0.1 / setting
        made = equal.Point(round(1e6 * setting**-0.5), setting / 9, 3 * setting, dihedral)
        return self.points.setdefault(setting, made)


def test_a_curve_of_a_power_law_is_met_exactly() -> None:
    for error, of_setting in (("rms", 9), ("normals", 1 / 3)):
        coder = Law("highpass", TriangleMesh(*meshes.tetrahedron()))
        size = equal.interpolated_at(coder, error, 0.02).size
        assert size == pytest.approx(1e6 * (0.02 * of_setting) ** -0.5, rel=1e-4)
        found = equal.coded_at(coder, error, 0.02)
        assert 0.0198 <= getattr(found, error) <= 0.02


def test_a_curve_that_comes_back_counts_where_it_leaves() -> None:
    coder = Law("highpass", TriangleMesh(*meshes.tetrahedron()))
    for setting in (4.0, 1.0):
        assert coder(setting).dihedral <= 0.1  # there already, and not to be taken
    for find in (equal.coded_at, equal.interpolated_at):
        assert find(coder, "dihedral", 0.1).size == pytest.approx(1e6 * 0.1**-0.5, rel=0.01)
        # Never so bad: the worst there is.
        worst = find(coder, "dihedral", 0.5)
        assert worst.dihedral == max(one.dihedral for one in coder.points.values())


@pytest.mark.parametrize("way", ["exact", "curve"])
def test_the_headline_is_a_ratio_of_sizes_at_equal_error(way: str, tmp_path: Path) -> None:
    pytest.importorskip("DracoPy")
    file = tmp_path / "headline.json"
    line = ["--quick", "-j", "1", "--bits", "9", "--way", way, "--json", str(file)]
    done = CliRunner().invoke(headline.command, [*line, "--codec", "cartesian"])
    assert done.exit_code == 0, done.output
    (one,) = json.loads(file.read_text())
    assert (one["mesh"], one["bits"], one["way"]) == (TORUS, 9, way)
    for error in headline.ERRORS:
        # Draco quantizes as our Cartesian method does: at equal error the step is the same.
        assert 0.89 < one[error][error] / one["draco"][error] < 1.001
        assert 0.8 < one[error]["size"] / one["draco"]["size"] < 1.03
    for error in headline.ERRORS:
        assert one["all"][error] <= one["draco"][error] * 1.001
    assert one["all"]["rms"] <= 1.5e-3
    assert one["all"]["size"] > 0.99 * max(one[error]["size"] for error in headline.ERRORS)
    ratios = [one[column]["size"] / one["draco"]["size"] for column in headline.COLUMNS]
    assert done.stdout.splitlines()[-1].split() == [TORUS, *(f"{r:.3f}" for r in ratios * 2)]


def test_the_headline_may_keep_the_distance_of_draco_too() -> None:
    pytest.importorskip("DracoPy")
    task = (TORUS, "cartesian", (9,), "exact", ("all",))
    near, far = (headline.compared((*task, rms))[0] for rms in (None, 1.5e-3))
    assert list(near.ours) == ["all"]
    assert near.ours["all"].rms <= near.draco.rms
    assert near.ours["all"].size > 0.95 * far.ours["all"].size


def test_means_are_geometric_and_tell_what_is_missing() -> None:
    draco = equal.Point(100, 0.1, 1.0, 1.0)
    ours = {"normals": equal.Point(50, 0.1, 1.0, 1.0), "dihedral": None}
    one = headline.Comparison("bunny", 11, draco, ours)
    assert one.ratio("normals") == 0.5
    assert headline.geometric_mean([0.5, 2, 8]) == pytest.approx(2)
    assert headline.largest([0.5, 2, 1]) == 2
    for of_all in (headline.geometric_mean, headline.largest):
        assert math.isnan(of_all([0.5, one.ratio("dihedral"), 1]))


# ---- Curves ------------------------------------------------------------------------------------


def test_curves_are_a_table_and_a_picture(tmp_path: Path) -> None:
    for package in ("DracoPy", "matplotlib"):
        pytest.importorskip(package)
    families = ("cartesian bits=6", "cartesian bits=8", "draco bits=8", "zstd")
    line = ["--quick", "-j", "1", "--output", str(tmp_path)]
    done = CliRunner().invoke(curves.command, [*line, *(f"--codec={one}" for one in families)])
    assert done.exit_code == 0, done.output
    found = rates.from_text((tmp_path / "torus.csv").read_text())
    assert [row["codec"] for row in found] == list(families)
    objects = json.loads((tmp_path / "torus.json").read_text())
    assert [str(one["bytes"]) for one in objects] == [row["bytes"] for row in found]
    assert (tmp_path / "torus.png").read_bytes().startswith(b"\x89PNG")


def test_a_curve_has_a_panel_an_error_and_labelled_axes() -> None:
    pytest.importorskip("matplotlib")
    figures = importlib.import_module("figures")
    mesh = TriangleMesh(*meshes.torus(9, 7))
    labels = {"cartesian": ("cartesian bits=7", "cartesian bits=5"), "zstd": ("zstd",)}
    found = {
        family: [bench.measure("torus", mesh, bench.codec_of(one)) for one in of_family]
        for family, of_family in labels.items()
    }
    figure = figures.curves(found, "a torus")
    *panels, legend = figure.axes
    assert len(panels) == 5
    for panel in panels:
        assert (panel.get_xscale(), panel.get_yscale()) == ("log", "log")
        assert panel.get_xlabel() == "bits per vertex, whole file"
        assert panel.get_ylabel().endswith(("[degrees]", "/ diagonal"))
        (line,) = panel.get_lines()  # what has no error is in the legend only
        assert list(line.get_xdata()) == sorted(one.bpv for one in found["cartesian"])
    texts = [text.get_text() for text in legend.get_legend().get_texts()]
    assert texts[0] == "deltamesh, Cartesian"
    assert f"{found['zstd'][0].bpv:.1f} bits/vertex" in texts[1]


def test_a_sweep_is_of_what_a_codec_has() -> None:
    def first(family: str) -> str:
        return next(iter(curves.sweep(family, TORUS)))

    assert first("draco") == "draco bits=8"
    assert first("cartesian") == "cartesian bits=8"
    assert first("refined coarse=4").startswith("refined coarse=4 step=0.0")
    assert list(curves.sweep("refined bits=6", TORUS)) == ["refined bits=6"]
    assert list(curves.sweep("zstd", TORUS)) == ["zstd"]
    for family in curves.FAMILIES:
        for label in curves.sweep(family, TORUS):
            bench.codec_of(label)


# ---- Meshes and scripts ------------------------------------------------------------------------


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


@pytest.mark.parametrize("bits", [9, 11])
def test_draco_is_not_smaller_at_equal_bits(bits: int) -> None:
    pytest.importorskip("DracoPy")
    ours, draco = (
        bench.codec_of(f"{name} bits={bits}").code(corpus.bare(TORUS))
        for name in ("cartesian", "draco")
    )
    assert ours.size < 1.03 * draco.size


def test_the_table_of_conversions_is_what_is_measured() -> None:
    conversions = importlib.import_module("conversions")
    mesh = corpus.load(TORUS)
    elements = conversions.of_vertices(mesh.faces, len(mesh.vertices))
    rows = conversions.measured(elements, (40 * mesh.vertices).round(3))
    for name, kind, without, found, decimals, *_ in rows:
        line = [name.replace("*", "\N{MULTIPLICATION SIGN}"), kind, without, found]
        assert f"| {' | '.join(line)} |" in README, name
        assert float(found) < 0.9 * float(without)
        assert f"{float(decimals):.2f} bits" in README


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
    # This process, with scipy in it, has several times that.
    assert 5 << 20 < used.peak < 80 << 20
    with pytest.raises(RuntimeError, match="No such command"):
        processes.deltamesh("nothing")


# ---- Large surfaces ----------------------------------------------------------------------------


@pytest.mark.parametrize("n", [20, 1000, 2001])
def test_large_surfaces_are_closed_irregular_and_turned_outwards(n: int) -> None:
    mesh = large.surface(n)
    F, V = mesh.faces, mesh.vertices
    assert V.shape == (n, 3)
    assert F.shape == (2 * n - 4, 3)
    ends = np.stack((F, np.roll(F, -1, axis=1)), axis=2).reshape(-1, 2)
    there, back = (set(map(tuple, x.tolist())) for x in (ends, ends[:, ::-1]))
    assert there == back
    assert len(there) == 3 * len(F)
    assert np.linalg.det(V[F]).sum() > 0
    valences = np.bincount(F.ravel())
    assert valences.min() >= 3
    if n >= 1000:
        assert 0.5 < np.mean(valences != 6) < 0.6
    assert (V.astype(np.float32) == V).all()
    again = large.surface(n)
    assert (again.vertices == V).all()
    assert (again.faces == F).all()


def test_larger_surfaces_are_the_same_surface() -> None:
    coarse, fine = (large.surface(n).vertices for n in (1000, 16000))
    directions = (V / np.linalg.norm(V, axis=1, keepdims=True) for V in (coarse, fine))
    near = np.argmax(np.matmul(*(D.T if i else D for i, D in enumerate(directions))), axis=1)
    radius, other = np.linalg.norm(coarse, axis=1), np.linalg.norm(fine[near], axis=1)
    assert np.corrcoef(radius, other)[0, 1] > 0.98


def test_growth_is_an_exponent_above_the_start_up() -> None:
    def row(n: int, cpu: float) -> Any:
        return large.Row(n, "decode", 1, processes.Usage(cpu, cpu, 1), 0.0)

    assert large.growth(row(1000, 1.5), row(8000, 4.5), 0.5) == "0.67"
    assert large.growth(row(1000, 0.4), row(8000, 4.5), 0.5) == ""
    assert large.growth(row(1000, 1.5), row(1000, 4.5), 0.5) == ""


@pytest.mark.skipif(not hasattr(os, "wait4"), reason="POSIX only")
def test_the_table_of_large_surfaces(tmp_path: Path) -> None:
    pytest.importorskip("DracoPy")
    arguments = ["500", "1000", "--folder", str(tmp_path)]
    done = CliRunner().invoke(large.command, arguments)
    assert done.exit_code == 0, done.output
    rows = [line.split() for line in done.stdout.splitlines()]
    assert [row[0] for row in rows[1:]] == ["500"] * 4 + ["1000"] * 4
    assert [row[1] for row in rows[1:]] == ["encode", "decode", "Draco", "Draco"] * 2
    assert 300 < int(rows[5][2]) < int(rows[7][3])
    assert len(corpus.read(tmp_path / "large-1000.ply").vertices) == 1000


# ---- Generated shapes and scenes ---------------------------------------------------------------


@pytest.mark.parametrize("name", shapes.SHAPES)
def test_shapes_are_closed_or_flat_and_turned_outwards(name: str) -> None:
    mesh = shapes.shape(name)
    F, V = mesh.triangles, mesh.vertices
    ends = np.stack((F, np.roll(F, -1, axis=1)), axis=2).reshape(-1, 2)
    there, back = (set(map(tuple, x.tolist())) for x in (ends, ends[:, ::-1]))
    if not name.startswith(("grid", "fine grid")):
        assert there == back
    volume = np.linalg.det(V[F]).sum() / 6
    assert volume > 0 or name.startswith("grid")
    far = shapes.shape(name, turned=True)
    assert np.linalg.norm(far.vertices.mean(axis=0)) > 50 * np.ptp(far.vertices)
    assert np.linalg.det(far.vertices[F] - far.vertices.mean(axis=0)).sum() / 6 == pytest.approx(
        1e-9 * np.linalg.det(V[F] - V.mean(axis=0)).sum() / 6, rel=1e-4
    )


def test_generated_shapes_are_within_the_bounds_and_auto_is_not_worse_than_refined() -> None:
    bounds = importlib.import_module("bounds")
    line = ["-j", "1", "--each", "--shape", "box", "--shape", "grid, flat"]
    options = ("auto", "auto bits=8", "auto normal_error=1", "cartesian max_rel=1e-3")
    done = CliRunner().invoke(bounds.command, [*line, *(f"--option={one}" for one in options)])
    assert done.exit_code == 0, done.output
    rows = [row.split("  ") for row in done.stdout.splitlines()]
    assert sum("box, turned" in row for line in rows for row in line) >= len(options)


def test_an_error_beyond_its_bound_is_wrong() -> None:
    bounds, decoded = map(importlib.import_module, ("bounds", "decoded"))
    part = decoded.PartError(rms=1e-3, max=3e-3, normal=0.5, dihedral=2.0)
    small = part._replace(rms=1e-2)

    def share(**given: object) -> float:
        one = decoded.Found(None, 0.0, 1, part, [part, small], 0, 0)
        return bounds.share(one, {"method": "auto", **given}, 2.0)

    assert share() == pytest.approx(1e-2 / 1.5e-3)  # of the small part
    assert share(quality=7) == pytest.approx(1e-2 / 0.75e-3)
    assert share(max_error=2e-3) == pytest.approx(3)  # of the whole
    assert share(rms_error_rel=1e-3) == pytest.approx(1)
    assert share(dihedral_error=1.0, rms_error_rel=1e-2) == pytest.approx(2)
    assert share(normal_error=1.0, only=True) == pytest.approx(0.5)
    assert share(bits=8) == 0
    assert bounds.Result("auto", "box", False, share=1.1).wrong
    assert not bounds.Result("auto", "box", False, share=1.0).wrong


def test_parts_of_scenes_are_measured_beside_draco(tmp_path: Path) -> None:
    pytest.importorskip("DracoPy")
    parts, file = importlib.import_module("parts"), tmp_path / "parts.json"
    line = ["-j", "1", "--share", "0.005", "--method", "cartesian", "--uniform"]
    names = ("terrain with a ball", "city of 5000 boxes", "terrain in tiles")
    done = CliRunner().invoke(
        parts.command, [*line, *(f"--scene={one}" for one in names), "--json", str(file)]
    )
    assert done.exit_code == 0, done.output
    rows = json.loads(file.read_text())
    assert {row["scene"] for row in rows} == set(names)
    for row in rows:
        assert row["normal"] <= 1
        assert row["rms"] <= 1.5e-3 * (1 + 1e-6)
        assert row["parts"] > 1
        assert row["lost"] == 0
    draco = [row for row in rows if row["codec"].startswith("draco")]
    assert len(draco) == len(names)
    ours = {row["scene"]: row["size"] for row in rows if row["codec"] == "cartesian"}
    assert all(ours[row["scene"]] < row["size"] for row in draco)
    with_steps = [row for row in rows if row["codec"] == "cartesian, finest"]
    assert all(row["steps"] == 0 for row in with_steps)


def test_readers_are_compared_file_by_file(tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    pytest.importorskip("meshio")
    readers = importlib.import_module("readers")
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    (tmp_path / "deep").mkdir()
    (tmp_path / "alike.obj").write_text(corners + "f 1 2 3\n")
    (tmp_path / "deep" / "back.obj").write_text(corners + "f -3 -2 -1\nv 5 5 5\n")
    (tmp_path / "cut.obj").write_text(corners + "f 1 2 4\n")
    (tmp_path / "points.obj").write_text(corners)
    (tmp_path / "notes.txt").write_text("no mesh")
    done = CliRunner().invoke(readers.command, [str(tmp_path)])
    assert done.exit_code == 0, done.output
    *listed, heading, one, total = (line for line in done.output.splitlines() if line)
    assert any("back.obj: deltamesh 4 vertices, 1 triangles" in line for line in listed)
    assert any("trimesh" in line and "(different: positions" in line for line in listed)
    assert any("cut.obj: deltamesh refused: MeshError: line 4" in line for line in listed)
    assert not any("alike.obj" in line for line in listed)
    assert heading.split()[:4] == ["format", "files", "deltamesh", "read"]
    assert one.split()[:5] == ["OBJ", "4", "2", "1", "1"]
    assert total.split()[1:5] == ["4", "2", "1", "1"]


def test_a_reader_that_takes_too_long_is_ended() -> None:
    readers = importlib.import_module("readers")
    worker = readers.Worker("deltamesh", 0.0)
    try:
        assert worker.read("nothing.obj").refusal == "too slow"
        patient = readers.Worker("deltamesh", 60.0)
        assert patient.read("nothing.obj").message.startswith("FileNotFoundError")
    finally:
        worker.end()
        patient.end()
