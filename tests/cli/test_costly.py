"""Lines that say where the bytes of a file are, and options that bound errors of attributes."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import click
import meshes
import numpy as np
import pytest
from commandline import cli

from deltamesh_cli.content_options import content_options
from deltamesh_formats.meshfiles.files import mesh_bytes
from deltamesh_formats.polymesh.mesh import Attribute, from_triangles

V, F = meshes.icosphere(3)
RNG = np.random.default_rng(3)
HEAT = Attribute("heat", "vertex", RNG.random((len(V), 1)).astype(np.float32))
DUST = Attribute("a,b", "vertex", RNG.integers(0, 9999, (len(V), 1)).astype(np.int32))


@pytest.fixture
def scan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    mesh = replace(from_triangles(V, F), attributes=(HEAT, DUST))
    (tmp_path / "scan.ply").write_bytes(mesh_bytes(mesh, "ply"))
    return tmp_path


def costly(capsys: pytest.CaptureFixture[str]) -> list[str]:
    lines = capsys.readouterr().out.splitlines()
    return [
        line
        for line in lines
        if line.partition(":")[0]
        in ("attributes", "order of vertices and faces", "names, parts and metadata")
    ]


def sizes() -> dict[str, int]:
    from deltamesh import info
    from deltamesh_formats.container.figures import attributes_of

    container = info("scan.ply.dmesh")
    found = {entry.name: entry.size for entry in attributes_of(container)}
    return {
        **found,
        **{id_: one.size for id_, one in container.sections.items()},
        "": container.size,
    }


def test_attributes_that_cost_much_are_told(scan: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("encode scan.ply --method cartesian") == 0
    size = sizes()
    (line,) = costly(capsys)
    assert size["heat"] > size["a,b"] > 0
    assert line == (
        f"attributes: {size['ATTR']} bytes of {size['']}: heat {size['heat']}, a,b {size['a,b']};"
        " --drop heat,a,b, or --max-attribute-error heat=E"
    )
    # Each hint works.
    assert cli("encode -f scan.ply --method cartesian --max-attribute-error heat=0.01") == 0
    smaller = sizes()
    assert smaller["heat"] < size["heat"] / 2
    assert cli("encode -f scan.ply --method cartesian --drop heat --drop", "a,b") == 0
    assert costly(capsys)[1:] == []
    assert "ATTR" not in sizes()


def test_texture_coordinates_that_cost_much_get_a_hint(
    scan: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    uv = Attribute("uv", "vertex", RNG.random((len(V), 2)).astype(np.float32), "uv")
    mesh = replace(from_triangles(V, F), attributes=(uv,))
    Path("scan.ply").write_bytes(mesh_bytes(mesh, "ply"))
    assert cli("encode scan.ply --method cartesian") == 0
    (line,) = costly(capsys)
    assert line.endswith("; --drop uv, or --max-uv-error E")
    before = sizes()["uv"]
    assert cli("encode -f scan.ply --method cartesian --max-uv-error 0.01") == 0
    assert sizes()["uv"] < before * 0.7


def test_names_between_commas_are_names_and_so_is_the_whole() -> None:
    @click.command
    @content_options
    def command(**parameters: object) -> None: ...

    def dropped(*arguments: str) -> object:
        return command.make_context("x", list(arguments)).params["drop"]

    assert dropped() is None
    assert dropped("--drop", "uv") == ["uv"]
    assert dropped("--drop", "a, b", "--drop", "b,c") == ["a, b", "a", "b", "b,c", "c"]


def test_names_to_drop_are_separated_by_commas(scan: Path) -> None:
    assert cli("encode scan.ply -q --drop heat,nothing") == 0
    assert "heat" not in sizes()
    assert sizes()["a,b"] > 0


def test_the_order_that_costs_much_is_told(scan: Path, capsys: pytest.CaptureFixture[str]) -> None:
    order = RNG.permutation(len(V))
    mesh = from_triangles(V[order], np.argsort(order)[F][RNG.permutation(len(F))])
    Path("scan.ply").write_bytes(mesh_bytes(mesh, "ply"))
    assert cli("encode scan.ply --method cartesian --keep-order") == 0
    (line,) = costly(capsys)
    assert line.startswith(f"order of vertices and faces: {sizes()['ORDR']} bytes of {sizes()['']}")
    assert cli("encode -f scan.ply --method cartesian") == 0
    assert costly(capsys) == []


def test_bounds_of_attributes(scan: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = "encode -f --json scan.ply --method cartesian --max-attribute-error heat=0.01"
    assert cli(line, "--max-attribute-error", "nothing=1") == 0
    found = capsys.readouterr()
    heat, dust = json.loads(found.out)["attributes"]
    assert 0.009 < heat["largest_error"] <= 0.01
    assert (heat["coding"], heat["bits"]) == ("grid", None)
    assert dust["largest_error"] == 0
    assert (
        found.err == "note: scan.ply: --max-attribute-error nothing: there is no such attribute\n"
    )
    assert cli("encode -f --json scan.ply --method cartesian --bits-float 5") == 0
    assert 0.01 < json.loads(capsys.readouterr().out)["attributes"][0]["largest_error"] < 0.02
    for options in (
        "--max-attribute-error heat",
        "--max-attribute-error =1",
        "--max-attribute-error heat=0",
        "--max-uv-error 0",
        "--lossless --max-uv-error 1",
        "--lossless-attributes --bits-float 3",
    ):
        assert cli(f"encode -f scan.ply {options}") == 2
    assert "--bits-float and --lossless-attributes exclude" in capsys.readouterr().err


def test_batch_takes_them_and_records_them(scan: Path) -> None:
    line = "batch -q scan.ply --max-attribute-error heat=0.01 --manifest run.jsonl"
    assert cli(line) == 0
    record = json.loads(Path("run.jsonl").read_text().splitlines()[-1])
    assert record["options"]["max_attribute_error"] == {"heat": 0.01}
