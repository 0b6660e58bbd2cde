"""Files that are cut, and streams that end early, on the command line."""

from __future__ import annotations

import gzip
import io
import json
import sys
from pathlib import Path

import pytest
from commandline import cli

from deltamesh_formats.container.reader import read_container
from deltamesh_formats.container.stages import stages_of
from deltamesh_formats.meshfiles.files import read_mesh


def ends(data: bytes) -> dict[str, int]:
    return stages_of(read_container(data))


@pytest.fixture
def cut(folder: Path, torus_dmesh: bytes) -> Path:
    """The torus up to the middle of its refinements."""
    size = (ends(torus_dmesh)["deltas"] + ends(torus_dmesh)["refinements"]) // 2
    (folder / "part.dmesh").write_bytes(torus_dmesh[:size])
    return folder


def test_a_file_that_is_cut_is_decoded_and_said_to_be(
    cut: Path, torus_dmesh: bytes, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli("decode part.dmesh out.ply") == 3
    assert "truncated: section NORM" in capsys.readouterr().err
    assert cli("decode part.dmesh out.ply --partial") == 0
    told = capsys.readouterr()
    assert told.out == "part.dmesh -> out.ply: 2592 vertices, 5184 faces\n"
    assert told.err.startswith(
        f"note: part.dmesh: stage deltas, {ends(torus_dmesh)['deltas']} bytes, then NORM is cut;"
        " not there yet, if the file has them: refinements, vectors of cells, "
    )
    assert told.err.endswith("the checksum of its content cannot be verified\n")
    assert len(read_mesh("out.ply").faces) == 5184
    assert cli("decode -q part.dmesh out.ply -f --partial") == 0
    assert capsys.readouterr() == ("", "")


def test_json_has_the_stage(cut: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("decode part.dmesh out.obj --partial --json") == 0
    made = json.loads(capsys.readouterr().out)
    assert (made["stage"], made["cut"], made["absent"][0]) == ("deltas", "NORM", "refinements")
    assert cli("decode torus.dmesh whole.obj --partial --json") == 0
    told = capsys.readouterr()
    assert told.err == ""
    made = json.loads(told.out)
    assert (made["stage"], made["cut"], made["absent"]) == ("whole", None, [])
    assert cli("decode torus.dmesh whole.obj -f --json") == 0
    assert "stage" not in json.loads(capsys.readouterr().out)


def test_info_lists_stages_and_what_is_there(
    cut: Path, torus_dmesh: bytes, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli("info torus.dmesh") == 0
    listed = ", ".join(f"{stage} {size}" for stage, size in ends(torus_dmesh).items())
    assert f"stages, by their bytes: {listed}\n" in capsys.readouterr().out
    assert cli("info part.dmesh") == 3
    assert cli("info part.dmesh --partial") == 0
    told = capsys.readouterr().out
    assert "stage deltas, " in told
    assert "  DELT  " in told
    assert "  NORM  " not in told
    assert cli("info --json part.dmesh --partial") == 0
    made = json.loads(capsys.readouterr().out)
    assert [one["stage"] for one in made["stages"]] == ["anchors", "deltas"]
    assert (made["stage"], made["digest"], made["errors"]) == ("deltas", None, None)


class _Pipe(io.TextIOWrapper):
    def isatty(self) -> bool:
        return False


@pytest.mark.parametrize("packed", [False, True])
def test_a_stream_that_ends_early(
    folder: Path,
    torus_dmesh: bytes,
    packed: bool,
    monkeypatch: pytest.MonkeyPatch,
    capsysbinary: pytest.CaptureFixture[bytes],
) -> None:
    data = torus_dmesh[: ends(torus_dmesh)["anchors"] + 200]
    if packed:
        data = gzip.compress(data)[:-12]
    monkeypatch.setattr(sys, "stdin", _Pipe(io.BytesIO(data)))
    assert cli("decode - --partial --output-format ply") == 0
    told = capsysbinary.readouterr()
    assert told.out.startswith(b"ply\n")
    assert told.err.startswith(b"note: standard input: stage anchors, ")


@pytest.mark.parametrize("command", ["decode bad.dmesh out.ply", "info bad.dmesh"])
def test_damage_in_a_whole_section_is_refused(
    cut: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    data = bytearray((cut / "part.dmesh").read_bytes())
    data[300] ^= 1
    (cut / "bad.dmesh").write_bytes(data)
    assert cli(f"{command} --partial") == 3
    assert "damaged" in capsys.readouterr().err
    assert not (cut / "out.ply").exists()


def test_without_positions_nothing_is_written(
    folder: Path, torus_dmesh: bytes, capsys: pytest.CaptureFixture[str]
) -> None:
    for size, message in (
        (20, "PARM is cut"),
        (ends(torus_dmesh)["anchors"] - 1, "has a position"),
    ):
        (folder / "bad.dmesh").write_bytes(torus_dmesh[:size])
        assert cli("decode bad.dmesh out.ply --partial") == 3
        assert message in capsys.readouterr().err
    assert not (folder / "out.ply").exists()
    assert cli("info bad.dmesh --partial") == 0
    assert "no positions yet" in capsys.readouterr().out
