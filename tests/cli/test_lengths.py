"""Lengths on the command line: bare, with a unit, and as shares of the diagonal."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import click
import meshes
import pytest
from commandline import cli

from deltamesh_cli import lengths
from deltamesh_cli.value_types import Length, length, length_or_share, positive_share
from deltamesh_formats.errors import OptionError
from deltamesh_formats.meshfiles.files import mesh_bytes
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles

BALL = from_triangles(*meshes.icosphere(2))


def mesh(file_format: str, *units: str) -> PolyMesh:
    return replace(BALL, format=file_format, metadata={"units": units} if units else {})


def test_lengths_are_read() -> None:
    assert length("0.05") == 0.05
    assert length(" 5e-2 mm ") == Length(0.05, "mm")
    assert length("2.5µm") == (2.5, "µm")
    assert length_or_share("0.1%") == Length(0.1, "%")
    assert str(Length(0.05, "mm")) == "0.05mm"
    assert positive_share("0.1%") == pytest.approx(0.001)
    for read, text in (
        *(
            (length_or_share, text)
            for text in ("0", "-1", "mm", "1 parsec", "1mm2", "inf", "1e999")
        ),
        (length, "0.1%"),
        *((positive_share, text) for text in ("0", "0%", "-1", "nan", "1mm")),
    ):
        with pytest.raises(click.BadParameter):
            read(text)


@pytest.mark.parametrize(
    ("given", "of", "expected", "words"),
    [
        (Length(0.05, "mm"), mesh("glb"), 5e-5, "meter; --max-error 0.05mm is 5e-05"),
        (Length(0.05, "mm"), mesh("3mf", "inch"), 0.05 / 25.4, "inch; --max-error 0.05mm is"),
        (Length(1, "m"), mesh("dae", "0.5 meter"), 2.0, "0.5 meter; --max-error 1m is 2"),
        (0.05, mesh("gltf"), 0.05, "meter"),
        (0.05, mesh("ply"), 0.05, "that of the file, which PLY does not name"),
    ],
)
def test_lengths_are_converted_into_the_unit_of_a_mesh(
    given: float | Length, of: PolyMesh, expected: float, words: str
) -> None:
    parameters, unit = lengths.in_unit_of(of, {"max_error": given, "step": None, "bits": 3})
    assert parameters == {"max_error": pytest.approx(expected), "step": None, "bits": 3}
    assert unit.startswith(words)
    assert lengths.in_unit_of(of, {"max_error": None}) == ({"max_error": None}, "")


def test_a_unit_needs_a_file_that_has_one() -> None:
    given = {"rms_error": Length(1, "mm")}
    with pytest.raises(OptionError, match="--rms-error 1mm has a unit, but PLY names none"):
        lengths.in_unit_of(mesh("ply"), given)
    with pytest.raises(OptionError, match="but furlong is an unknown one"):
        lengths.in_unit_of(mesh("3mf", "furlong"), given)
    with pytest.raises(OptionError, match="means nothing here"):
        lengths.refuse_units(given)


def test_shares_bound_by_the_diagonal_and_the_less_counts() -> None:
    parameters = {"max_error": Length(0.1, "%"), "rms_error": 2.0, "max_error_rel": None}
    lengths.settle_shares(parameters)
    assert parameters == {"rms_error": 2.0, "max_error_rel": pytest.approx(0.001)}
    parameters = {"max_error": Length(0.1, "%"), "max_error_rel": 1e-4}
    lengths.settle_shares(parameters)
    assert parameters == {"max_error_rel": 1e-4}


@pytest.fixture
def balls(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name in ("ball.glb", "ball.ply", "ball.3mf"):
        (tmp_path / name).write_bytes(mesh_bytes(BALL, name[-3:]))
    return tmp_path


def test_bounds_with_units_hold(balls: Path, capsys: pytest.CaptureFixture[str]) -> None:
    errors = []
    for line in (
        "ball.glb --max-error 2cm",
        "ball.3mf --max-error 20um",
        "ball.ply --max-error 1%",
    ):
        assert cli(f"encode --json {line} --only") == 0
        found = json.loads(capsys.readouterr().out)
        errors.append((found["errors"]["max"], found["errors"]["max_relative"], found["unit"]))
    assert 0.01 < errors[0][0] <= 0.02
    assert errors[0][2] == "meter; --max-error 2cm is 0.02"
    assert 0.01 < errors[1][0] <= 0.02
    assert errors[1][2] == "millimeter; --max-error 20um is 0.02"
    assert 0.005 < errors[2][1] <= 0.01
    assert errors[2][2] is None
    assert cli("encode ball.glb -f --max-error 0.02") == 0
    assert "\nunit of lengths: meter\n" in capsys.readouterr().out
    assert cli("encode ball.ply -f --max-error 20mm") == 2
    assert "but PLY names none" in capsys.readouterr().err


def test_batch_and_bench_take_them(balls: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = "batch ball.glb ball.ply --max-error 2cm --manifest run.jsonl --resume"
    assert cli(line) == 2
    assert "ball.ply: cannot encode: --max-error 2cm has a unit" in capsys.readouterr().err
    records = [json.loads(text) for text in Path("run.jsonl").read_text().splitlines()]
    (done,) = (one for one in records if one["status"] == "done")
    assert done["errors"]["max"] <= 0.02
    assert cli(line + " --json") == 2
    summary = json.loads(capsys.readouterr().out.splitlines()[-1])["summary"]
    assert summary["files"]["done before"] == 1, "the unit is an option as any other"
    assert cli("bench ball.glb --method cartesian --max-error 1%,2% --csv") == 0
    assert "cartesian max_error_rel=0.02" in capsys.readouterr().out
    assert cli("bench ball.glb --max-error 1mm") == 2
