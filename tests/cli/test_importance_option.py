"""The option --importance: what it takes, refuses and prints."""

from __future__ import annotations

import json
from pathlib import Path

import meshes
import numpy as np
import pytest
from commandline import cli

import deltamesh

V, F = meshes.torus(60, 40)
V = V + 0.003 * np.random.default_rng(2).normal(size=V.shape)


@pytest.fixture
def scan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    quality = np.where(V[:, 0] > 0, 1.0, 0.25).astype(np.float32)
    mesh = deltamesh.from_arrays(V, F, vertex={"quality": quality, "height": V[:, 2] - 7})
    deltamesh.write_mesh("scan.ply", mesh)
    return tmp_path


def test_both_regions_are_printed(scan: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("encode scan.ply --importance quality --drop height") == 0
    encoded = capsys.readouterr().out
    assert cli("info scan.ply.dmesh") == 0
    described = capsys.readouterr().out
    for line in ("errors are weighted: importance 1 of ", "less importance of "):
        assert line in encoded
        assert line in described
    assert cli("encode scan.ply all.dmesh") == 0
    assert "weighted" not in capsys.readouterr().out


def test_json_has_both_regions(scan: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("encode scan.ply --importance quality --json") == 0
    found = json.loads(capsys.readouterr().out)["importance"]
    assert found["vertices_full"] + found["vertices_reduced"] == len(V)
    assert found["vertices_none"] == 0
    assert found["full"]["normal_deviation_degrees"] <= 1
    name = "normal_deviation_degrees"
    assert found["reduced"][name] > found["full"][name]
    assert cli("encode scan.ply all.dmesh --json") == 0
    assert json.loads(capsys.readouterr().out)["importance"] is None


@pytest.mark.parametrize(
    ("options", "code", "message"),
    [
        ("--importance colour", 2, "no attribute 'colour' of one number for each vertex"),
        ("--importance height", 1, "values run from "),
        ("--importance quality --lossless", 2, "--importance means nothing with --method"),
        ("--importance quality --bits 0", 2, "importance means nothing with 0 bits"),
    ],
)
def test_what_it_cannot_take(
    scan: Path, options: str, code: int, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli(f"encode scan.ply {options}") == code
    assert message in capsys.readouterr().err
    assert not (scan / "scan.ply.dmesh").exists()


def test_a_batch_takes_it(scan: Path) -> None:
    assert cli("batch -q scan.ply --importance quality") == 0
    assert "regs" in deltamesh.info("scan.ply.dmesh").sections
