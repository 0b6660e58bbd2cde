"""Sequences on the command line: many files into one, and back."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import click
import meshes
import numpy as np
import pytest
from animated import moving
from commandline import cli

from deltamesh import decode, info, read_mesh, write_mesh
from deltamesh_cli.sequences import NumberedFiles, in_order

MOVING = moving(meshes.torus(9, 7), 12, each=0.05)


@pytest.fixture
def frames(folder: Path) -> Path:
    """Twelve files, so that names as texts are in another order than their numbers."""
    for i, mesh in enumerate(MOVING):
        write_mesh(folder / f"f{i}.ply", mesh)
    return folder


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("f*.ply"))


ENCODE = "encode -o walk.dmesh --sequence --keep-order --method refined --step 0.02 "


def test_names_of_a_shell_are_in_the_order_of_their_numbers() -> None:
    shell = ("a/f1.ply", "a/f10.ply", "a/f2.ply")
    assert in_order(shell) == ("a/f1.ply", "a/f2.ply", "a/f10.ply")
    assert in_order(shell[::-1]) == shell[::-1]
    assert in_order(("b", "a", "b")) == ("b", "a", "b")
    assert in_order(("1²10", "1²9", "²1")) == ("1²9", "1²10", "²1")


def test_frames_become_one_file_and_files_again(
    frames: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli(ENCODE + "--fps 25 --key-every 4", *names(frames)) == 0
    told = capsys.readouterr()
    assert told.err == ""
    assert told.out.startswith("f0.ply and 11 more: ")
    assert "frames: 12 at 25 a second, key frames 0, 4, 8" in told.out
    assert "\nworst further frame: " in told.out
    data = (frames / "walk.dmesh").read_bytes()
    (frames / "out").mkdir()
    assert cli("decode walk.dmesh out --all") == 0
    assert capsys.readouterr().out == (
        f"walk.dmesh -> {Path('out', 'walk_00.ply')} to {Path('out', 'walk_11.ply')}: 12 frames\n"
    )
    for i in (0, 5, 11):
        written = read_mesh(frames / "out" / f"walk_{i:02}.ply")
        np.testing.assert_allclose(written.vertices, decode(data, frame=i).vertices, atol=1e-4)
        assert np.abs(written.vertices - MOVING[i].vertices).max() < 0.1
    assert cli("decode walk.dmesh out/pose.obj --frame 11") == 0
    last = read_mesh(frames / "out" / "pose.obj").vertices
    np.testing.assert_allclose(last, decode(data, frame=11).vertices, atol=1e-3)
    assert cli("test walk.dmesh") == 0


def test_json_has_every_frame(frames: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli(ENCODE + "--json", *names(frames)) == 0
    made = json.loads(capsys.readouterr().out)
    assert made["source"] == "f0.ply"
    assert made["sequence"]["count"] == 12
    assert (made["sequence"]["fps"], made["sequence"]["key_frames"]) == (None, [0])
    errors = [one["normal_deviation_degrees"] for one in made["sequence"]["frames"]]
    assert len(errors) == 11
    assert 1 <= made["sequence"]["worst_frame"] <= 11
    assert cli("info --json walk.dmesh") == 0
    assert json.loads(capsys.readouterr().out)["sequence"] == made["sequence"]
    assert cli("decode walk.dmesh g%d.stl --all --json") == 0
    assert json.loads(capsys.readouterr().out)["files"] == [f"g{i}.stl" for i in range(12)]


def test_one_frame_of_many_is_said_to_be_one(
    frames: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli(ENCODE + "-q", *names(frames)) == 0
    assert cli("decode walk.dmesh one.ply") == 0
    note = "note: one.ply: frames 1 to 11 of a sequence are not kept\n"
    assert capsys.readouterr().err == note
    assert cli("decode walk.dmesh one.ply -f --frame 0") == 0
    assert capsys.readouterr().err == ""
    assert cli("compare f0.ply walk.dmesh") == 0
    assert "walk.dmesh: frame 0, without frames 1 to 11" in capsys.readouterr().err
    assert cli("compare -q f0.ply walk.dmesh") == 0
    assert capsys.readouterr().err == ""
    assert cli("view --no-open walk.dmesh -o walk.html") == 0
    assert "without frames" not in capsys.readouterr().err
    assert cli("view --no-open -f walk.dmesh f0.ply -o walk.html") == 0
    assert "walk.dmesh: frame 0, without frames 1 to 11" in capsys.readouterr().err


def test_frames_that_do_not_fit_are_named(frames: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = frames / "other.off"
    other.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    assert cli(ENCODE, "f0.ply", "f1.ply", "other.off") == 1
    assert capsys.readouterr().err == (
        "deltamesh: other.off: cannot encode: frame 2: 3 vertices, where frame 0 has 63\n"
    )
    write_mesh(frames / "f2.ply", replace(MOVING[2], vertices=1e12 * MOVING[2].vertices))
    for method in ("refined", "highpass", "cartesian"):
        line = f"encode -o walk.dmesh --sequence --method {method} --step 0.02"
        assert cli(line, "f0.ply", "f1.ply", "f2.ply") == 1
        told = capsys.readouterr().err
        assert told.startswith("deltamesh: f2.ply: cannot encode: frame 2: a quantization step of ")
    assert cli(ENCODE, "f0.ply", "missing.ply") == 1
    assert "missing.ply: cannot read" in capsys.readouterr().err
    assert not (frames / "walk.dmesh").exists()


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("encode f0.ply f1.ply f2.ply", "--sequence makes one file of many frames"),
        ("encode f0.ply f1.ply --sequence", "--sequence needs -o OUT"),
        ("encode f0.ply --fps 25", "--fps means nothing without --sequence"),
        ("encode f0.ply --key-every 4", "--key-every means nothing without --sequence"),
        ("encode - f1.ply -o w.dmesh --sequence", "The frames of a sequence are files"),
        ("encode f0.ply f1.ply -o w.dmesh --sequence --lossless", "cannot have several frames"),
        ("decode walk.dmesh x.ply --frame 12", "there is no frame 12: the file has 12, from 0 on"),
        ("decode walk.dmesh x.ply --frame 1 --all", "exclude each other"),
        ("decode walk.dmesh x.ply --all", "has no %04d for the number of a frame"),
        ("decode walk.dmesh - --all", "standard output cannot have them"),
        ("decode walk.dmesh x.ply --partial --frame 1", "--partial decodes no frame but the first"),
    ],
)
def test_what_makes_no_sense_is_refused(
    frames: Path, capsys: pytest.CaptureFixture[str], line: str, message: str
) -> None:
    assert cli(ENCODE + "-q", *names(frames)) == 0
    assert cli(line) == 2
    assert message in " ".join(capsys.readouterr().err.split())


def test_no_file_is_overwritten_unasked(frames: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli(ENCODE + "-q", *names(frames)) == 0
    (frames / "x_7.ply").write_text("mine")
    assert cli("decode walk.dmesh x_%d.ply --all") == 1
    assert "x_7.ply" in capsys.readouterr().err
    assert (frames / "x_7.ply").read_text() == "mine"
    assert not (frames / "x_0.ply").exists()
    assert cli("decode walk.dmesh x_%d.ply --all -f") == 0


def test_names_of_files_have_the_number_where_it_is_asked_for(frames: Path) -> None:
    assert cli(ENCODE + "-q", *names(frames)) == 0
    container = info(frames / "walk.dmesh")
    for target, name in (
        (None, "walk_03.ply"),
        ("a%05d.obj", "a00003.obj"),
        ("%d.stl.gz", "3.stl.gz"),
        (str(frames), str(frames / "walk_03.ply")),
    ):
        assert NumberedFiles("walk.dmesh", target, None, container).name(3) == name
    for source, target, name in (
        ("50%d.dmesh", None, "50%d_03.ply"),
        ("%%%d.dmesh", str(frames), str(frames / "%%%d_03.ply")),
        ("walk.dmesh", "%%d%%%d.ply", "%d%3.ply"),
    ):
        assert NumberedFiles(source, target, None, container).name(3) == name
    with pytest.raises(click.UsageError, match="has no %04d"):
        NumberedFiles("walk.dmesh", "%%d.ply", None, container)
