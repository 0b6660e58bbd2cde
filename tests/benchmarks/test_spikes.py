"""Spikes: the direct solution is none of ours, ratios see a spike, tables go into the page."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import Any

import meshes
import numpy as np
import pytest
from click.testing import CliRunner, Result
from places import BENCHMARKS

from deltamesh._mesh import TriangleMesh
from deltamesh._options import Options

sys.path.append(str(BENCHMARKS))
anchored, direct, pages, spikes = map(
    importlib.import_module, ("anchored", "direct", "pages", "spikes")
)


@pytest.fixture(scope="module")
def file() -> Any:
    V, F = meshes.torus(40, 30)
    two = TriangleMesh(np.concatenate([V, V + 1000]), np.concatenate([F, F + len(V)]))
    return anchored.coded(two, Options(method="refined", step=0.01, anchors=0.01))


def test_the_direct_solution_has_the_laplacian_and_the_anchors(file: Any) -> None:
    """The dense matrix, solved by LAPACK, has the same solution."""
    systems = direct.DirectSystems(file.surface)
    anchors = file.integers.anchors
    generator = np.random.default_rng(3)
    delta, held = generator.normal(size=(len(file.V), 3)), generator.normal(size=(len(anchors), 3))
    x = systems.interpolation(anchors).solve(delta.copy(), held, np.ones((len(delta), 1)))
    indptr, indices = file.surface.graph
    L = np.diag(np.diff(indptr).astype(float))
    L[np.repeat(np.arange(len(delta)), np.diff(indptr)), indices] -= 1
    L[anchors] = np.eye(len(delta))[anchors]
    delta[anchors] = held
    np.testing.assert_allclose(x, np.linalg.solve(L, delta), atol=1e-11)


def test_a_distance_from_it_is_in_steps(file: Any) -> None:
    W = file.decoded
    assert direct.distance_from_direct(file, W) < 1e-4
    W[17, 1] += 0.3 * file.parameters.step
    assert direct.distance_from_direct(file, W) == pytest.approx(0.3, abs=1e-4)


def test_a_spike_is_seen_in_each_ratio(file: Any) -> None:
    W = file.decoded
    before = spikes.spikes_of(file, W)
    assert before.largest <= 1
    normal = W[file.integers.anchors[0]] - W[: len(W) // 2].mean(axis=0)
    W[file.integers.anchors[0]] += 0.2 * normal
    after = spikes.spikes_of(file, W)
    assert after.deltas > 3 * before.deltas
    assert after.largest > 2
    assert after.normals > 1.2 * before.normals


@pytest.fixture
def call(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Call the script on the mesh of the repository, and a page aside."""
    page = tmp_path / "anchors.md"
    page.write_text("a\n\n<!-- table: spikes -->\n\n| x |\n\nb\n\n<!-- table: largest -->\n\nc\n")
    monkeypatch.setattr(spikes, "PAGE", page)

    def invoke(*arguments: object) -> Result:
        return CliRunner().invoke(spikes.command, ["--quick", *map(str, arguments)])

    return invoke


def test_the_script_writes_what_it_prints(call: Any, tmp_path: Path) -> None:
    off = tmp_path / "folder" / "plane.off"
    off.parent.mkdir()
    off.write_text("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n")
    (off.parent / "empty.off").write_text("OFF\n0 0 0\n")
    (off.parent / "notes.txt").write_text("none")
    done = call(off.parent, "--write")
    assert done.exit_code == 0, done.output
    assert [line.split(": ")[0] for line in done.stderr.splitlines()] == ["skipped"]
    assert "empty.off" in done.stderr
    table, largest = done.stdout.strip().split("\n\n")
    assert [line.split(" | ")[0] for line in table.splitlines()] == [
        "| mesh",
        "| ---",
        "| torus.ply",
        "| plane.off",
    ]
    page = spikes.PAGE.read_text()
    assert pages.shown(page, "spikes") == table
    assert pages.shown(page, "largest") == largest


def test_a_distance_beyond_the_tolerance_is_loud(
    call: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(spikes, "distance_from_direct", lambda file, W: 2e-3)
    done = call()
    assert done.exit_code == 1
    assert "further than 0.001 steps: torus.ply" in done.stderr


def test_large_meshes_may_be_left_out(call: Any) -> None:
    done = call("--most", 2591)
    assert done.exit_code == 0
    assert "2592 vertices of faces" in done.stderr
