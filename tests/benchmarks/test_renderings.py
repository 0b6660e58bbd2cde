"""What the figures say: sizes are equal where they claim to be, captions are of what is shown."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import Any

import click
import meshes
import numpy as np
import pytest
from click.testing import CliRunner, Result
from places import BENCHMARKS

from deltamesh import bench
from deltamesh._mesh import TriangleMesh

sys.path.append(str(BENCHMARKS))
renderings, equal_sizes = map(importlib.import_module, ("renderings", "equal_sizes"))


def law(setting: float) -> int:
    return round(10_000 * setting**-0.4 + 3_000)


@pytest.mark.parametrize("budget", [5_000, 13_000, 40_000])
@pytest.mark.parametrize("start", [0.2, 1.0, 30.0])
def test_a_file_of_as_many_bytes_is_found(budget: int, start: float) -> None:
    asked: list[float] = []

    def size_of(setting: float) -> int:
        asked.append(setting)
        return law(setting)

    found = equal_sizes.fitting(size_of, budget, start)
    assert 0.99 * budget <= law(found) <= budget
    assert len(set(asked)) < 20
    assert all(float(f"{one:.4g}") == one for one in asked)


def test_a_jump_of_sizes_is_kept_below() -> None:
    found = equal_sizes.fitting(lambda setting: 900 if setting < 2 else 500, 700, 1.3)
    assert 2 <= found < 2.01


@pytest.mark.parametrize("budget", [2_000, 10**9])
def test_sizes_out_of_reach_are_told(budget: int) -> None:
    with pytest.raises(LookupError, match=f"no file of {budget} bytes"):
        equal_sizes.fitting(law, budget, 1.0)


def test_the_nearest_bits() -> None:
    sizes = {7: 800, 8: 1000, 9: 1300}
    found = [equal_sizes.nearest_bits(sizes, budget) for budget in (100, 899, 901, 1149, 1151)]
    assert found == [7, 7, 8, 8, 9]


def test_a_caption_tells_bytes_and_errors() -> None:
    mesh = TriangleMesh(*meshes.torus(20, 12))
    measured = bench.measure("torus", mesh, bench.codec_of("cartesian bits=7"))
    text = renderings.caption("Cartesian, 7 bits", bench.codec_of("cartesian bits=7").code(mesh))
    title, size, errors = text.splitlines()
    assert title == "Cartesian, 7 bits"
    assert size == f"{measured.bytes:,} bytes, {measured.bpv:.2f} bits/vertex"
    assert errors == f"normals {measured.normal_deg:.2f}°, rms {measured.rms:.1e}"


@pytest.mark.parametrize("levels", [0, 2])
def test_an_icosphere_is_a_closed_unit_sphere(levels: int) -> None:
    sphere = renderings.icosphere(levels)
    assert len(sphere.vertices) == 10 * 4**levels + 2
    assert len(sphere.faces) == 20 * 4**levels
    np.testing.assert_allclose(np.linalg.norm(sphere.vertices, axis=1), 1)
    assert len(bench.codec_of("cartesian").code(sphere).decoded.faces) == len(sphere.faces)


def test_a_model_has_a_surface_and_its_errors_for_each_method() -> None:
    mesh = TriangleMesh(*meshes.torus(20, 12))
    (row,) = renderings.model(mesh, renderings.LOOKS["bunny"][0])
    assert [panel.values is None for panel in row] == [True, False, True, False]
    for panel in row[1::2]:
        unit = np.linalg.norm(np.ptp(mesh.vertices, axis=0))
        distances = np.linalg.norm(panel.mesh.vertices - panel.frame.vertices, axis=1) / unit
        np.testing.assert_allclose(panel.values, distances)
        assert panel.text.endswith(f"max {distances.max():.1e}")


@pytest.mark.slow
def test_ours_is_as_large_as_draco_and_never_larger() -> None:
    pytest.importorskip("DracoPy")
    mesh = TriangleMesh(*meshes.torus(60, 40))
    rows = renderings.equal_bytes(mesh, renderings.LOOKS["bunny"], 8.0)
    (first, ours, draco), parts = rows
    assert first.mesh is mesh
    size, largest = (
        int(one.text.split("\n")[1].split()[0].replace(",", "")) for one in (ours, draco)
    )
    assert 0.95 * largest < size <= largest
    assert [part.mesh for part in parts] == [first.mesh, ours.mesh, draco.mesh]
    assert {part.text for part in parts} == {""}


@pytest.fixture
def call(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Call the script where no mesh is, and without rendering."""
    pytest.importorskip("pyvista")
    monkeypatch.setenv("DELTAMESH_MESHES", str(tmp_path / "none"))
    drawn: list[str] = []
    monkeypatch.setattr(renderings, "sphere", lambda: [[]])
    monkeypatch.setattr(renderings, "_render", lambda path, *_: drawn.append(path.name))

    def invoke(*arguments: str) -> tuple[Result, list[str]]:
        line = ["--output", str(tmp_path / "pictures"), *arguments]
        return CliRunner().invoke(renderings.command, line), drawn

    return invoke


def test_what_needs_a_mesh_that_is_absent_is_skipped(call: Any) -> None:
    done, drawn = call()
    assert done.exit_code == 0, done.output
    assert drawn == ["sphere.png", "paper_edits.png"]
    skipped = [line.split(" skipped")[0] for line in done.stderr.splitlines()]
    others = [name for name in renderings.PAPER if name != "paper_edits"]
    assert skipped == ["model", "stream", "importance", "equal_bytes", *others]


def test_without_pyvista_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(renderings.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(click.ClickException, match=r"pyvista is missing: pip install '\.\[view\]'"):
        renderings.command.main([], standalone_mode=False)
