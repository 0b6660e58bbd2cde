"""`deltamesh edit`, regions and motions, `decode --pose` and poses in `info`."""

from __future__ import annotations

import json
from pathlib import Path

import bars
import click
import numpy as np
import pytest
from commandline import cli

import deltamesh
from deltamesh_cli.program import run
from deltamesh_cli.regions import Motion, motion, region, target_of, vertices_in
from deltamesh_formats.errors import OptionError
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh, from_triangles


@pytest.fixture
def bar(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    V, F = bars.bar(24, 40)
    mesh = from_triangles(V, F)
    ends = Parts("group", ("low & end", "rest"), (V[F[:, 0], 2] > 0.3).astype(np.int64))
    mesh = PolyMesh(mesh.vertices, mesh.corners, mesh.offsets, parts=(ends,))
    deltamesh.save("bar.dmesh", mesh, method="refined", anchors=40)
    return tmp_path


BEND = ["--fix", "z<5%", "--move", "z>95%", "turn=y,120 shift=3.2,0,-2.46"]


def test_a_pose_is_added_listed_and_decoded(bar: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = Path("bar.dmesh").read_bytes()
    assert cli("edit bar.dmesh bent.dmesh --name bent", *BEND) == 0
    said = capsys.readouterr()
    assert "bytes, " in said.out
    assert "as recorded by 40 anchors: RMS" in said.out
    assert said.err == ""
    assert Path("bar.dmesh").read_bytes() == before
    assert cli("edit bent.dmesh -o two.dmesh --name out --move vertices:3,7-9 shift=0.1,0,0") == 0
    assert cli("info two.dmesh") == 0
    assert 'poses (2): "bent" ' in capsys.readouterr().out
    assert cli("info --json two.dmesh") == 0
    assert [one["name"] for one in json.loads(capsys.readouterr().out)["poses"]] == ["bent", "out"]
    assert cli("decode two.dmesh bent.ply --pose bent") == 0
    assert cli("decode two.dmesh rest.ply") == 0
    rest, found = (deltamesh.read_mesh(name).vertices for name in ("rest.ply", "bent.ply"))
    top = rest[:, 2] > 5.7
    wanted = rest[top] - rest[top].mean(axis=0)
    np.testing.assert_allclose(
        found[top] - found[top].mean(axis=0), wanted @ bars.EDITS["bend"][0].T, atol=0.02
    )
    middle = rest[top].mean(axis=0) + np.array([3.2, 0, -2.46])
    np.testing.assert_allclose(found[top].mean(axis=0), middle, atol=0.05)
    np.testing.assert_allclose(found[rest[:, 2] < 0.3], rest[rest[:, 2] < 0.3], atol=0.02)


def test_json_has_what_the_library_has(bar: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("edit bar.dmesh a.dmesh --json --name a --step 0.01", *BEND) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["bytes"] == len(Path("a.dmesh").read_bytes())
    assert (found["pose"], found["anchors"]) == ("a", 40)
    assert found["missed"] < 1e-8 < found["recorded_missed"] < 0.01


def test_poses_are_removed(bar: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("edit -q bar.dmesh bent.dmesh --name bent", *BEND) == 0
    assert cli("edit -q bent.dmesh two.dmesh --name out --move vertices:3 shift=0.1,0,0") == 0
    capsys.readouterr()
    assert cli("edit two.dmesh one.dmesh --remove out") == 0
    size = len(Path("bent.dmesh").read_bytes())
    wanted = f"two.dmesh -> one.dmesh: {size} bytes, without pose out\n"
    assert capsys.readouterr().out == wanted
    assert Path("one.dmesh").read_bytes() == Path("bent.dmesh").read_bytes()
    assert cli("edit --json two.dmesh none.dmesh --remove out --remove bent") == 0
    told = json.loads(capsys.readouterr().out)
    assert told == {
        "source": "two.dmesh",
        "file": "none.dmesh",
        "bytes": len(Path("bar.dmesh").read_bytes()),
        "removed": ["out", "bent"],
    }
    assert Path("none.dmesh").read_bytes() == Path("bar.dmesh").read_bytes()


def test_few_anchors_are_said_to_be_few(bar: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mesh = deltamesh.load("bar.dmesh")
    deltamesh.save("few.dmesh", mesh, method="refined", anchors=4)
    assert cli("edit few.dmesh a.dmesh --name a", *BEND) == 0
    assert "its 4 anchors are few for this edit" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "code", "words"),
    [
        ("edit bar.dmesh --name a --move z>9% shift=0,0,1", 2, "OUT is needed"),
        ("edit bar.dmesh bar.dmesh -f --name a --move z>9% shift=0,0,1", 1, "the input itself"),
        ("edit bar.dmesh a.obj --name a --move z>9% shift=0,0,1", 2, "does not end in .dmesh"),
        ("edit bar.dmesh a.dmesh --move z>9% shift=0,0,1", 2, "--name"),
        ("edit bar.dmesh a.dmesh --name a", 2, "--move"),
        ("edit bar.dmesh a.dmesh --name a --move z shift=0,0,1", 2, "is no region"),
        ("edit bar.dmesh a.dmesh --name a --move z>9% up", 2, "is none of"),
        ("edit bar.dmesh a.dmesh --name a --move z>9 shift=0,0,1", 2, "no vertices are in"),
        ("edit bar.dmesh a.dmesh --name a --move vertices:960 shift=0,0,1", 2, "vertex 960"),
        ("edit bar.dmesh a.dmesh --name a --move part:x shift=0,0,1", 2, "no part 'x'"),
        ("edit bar.dmesh a.dmesh --name a --fix z>8% --move z>9% shift=0,0,1", 2, "and fixed"),
        ("edit bar.dmesh a.dmesh --name a --memory 1M --move z>9% shift=0,0,1", 3, "--memory"),
        ("edit none.dmesh a.dmesh --name a --move z>9% shift=0,0,1", 1, "none.dmesh"),
        ("edit bar.dmesh a.dmesh --remove a", 2, "no pose 'a': the file has none"),
        ("edit bar.dmesh a.dmesh --remove a --name b", 2, "--name means nothing with --remove"),
        ("edit bar.dmesh a.dmesh --remove a --fix z<5%", 2, "--fix means nothing with --remove"),
        ("decode bar.dmesh a.obj --pose a", 2, "no pose 'a'"),
        ("decode bar.dmesh a.obj --pose a --partial", 2, "whole file"),
    ],
)
def test_failures(
    bar: Path, capsys: pytest.CaptureFixture[str], line: str, code: int, words: str
) -> None:
    assert run(line.split()) == code
    assert words in capsys.readouterr().err
    assert not Path("a.dmesh").exists()
    assert not Path("a.obj").exists()


def test_methods_without_anchors_are_named(bar: Path, capsys: pytest.CaptureFixture[str]) -> None:
    deltamesh.save("plain.dmesh", deltamesh.load("bar.dmesh"), method="cartesian")
    assert cli("edit plain.dmesh a.dmesh --name a", *BEND) == 1
    assert "method cartesian has none" in capsys.readouterr().err


CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 2)], dtype=float)
MESH = PolyMesh(
    CUBE,
    np.array([0, 1, 3, 2, 4, 5, 7, 6]),
    np.array([0, 4, 8]),
    parts=(Parts("group", ("a & b",), np.array([0, -1])),),
)


@pytest.mark.parametrize(
    ("text", "chosen"),
    [
        ("x<0.5", [0, 1, 2, 3]),
        ("z > 50%", [1, 3, 5, 7]),
        ("z<1e0", [0, 2, 4, 6]),
        ("z<-1e0", []),
        ("x>50% & z>50%", [5, 7]),
        ("ball:0,0,0,1", [0, 2, 4]),
        ("box:0,0,0,1,1,1", [0, 2, 4, 6]),
        ("box:1,1,1,0,0,0", [0, 2, 4, 6]),
        ("vertices:0,5-7", [0, 5, 6, 7]),
        ("vertices:0-3 & y>50%", [2, 3]),
        ("part:a & b", [0, 1, 2, 3]),
    ],
)
def test_regions(text: str, chosen: list[int]) -> None:
    terms = region(text)
    if not chosen:
        with pytest.raises(OptionError, match="no vertices"):
            vertices_in(MESH, terms)
        return
    assert np.flatnonzero(vertices_in(MESH, terms)).tolist() == chosen


@pytest.mark.parametrize(
    "text",
    ["", "z", "w<1", "z<", "z<a", "ball:1,2,3", "ball:1,2,3,x", "box:1,2,3,4,5,nan", "vertices:",
     "vertices:-1", "vertices:3-1", "vertices:1,,2", "sphere:1,2,3,4", "x<1 & ",
     "vertices:1-99999999999999999999999", "vertices:" + "9" * 5000],
)  # fmt: skip
def test_what_is_no_region_is_refused(text: str) -> None:
    with pytest.raises(click.BadParameter):
        region(text)


@pytest.mark.parametrize(
    "text",
    ["turn=y", "turn=y,a", "turn=0,0,0,9", "turn=1,2,9", "shift=1", "shift=1,2,3 shift=1,2,3",
     "about=1,2,3", "scale=2", "shift=1,2,inf", "shift", "", " "],
)  # fmt: skip
def test_what_is_no_motion_is_refused(text: str) -> None:
    with pytest.raises(click.BadParameter):
        motion(text)


def test_motions() -> None:
    assert motion("shift=1,2,3") == Motion((1, 2, 3))
    assert motion("turn=y,30 about=1,0,0") == Motion((0, 0, 0), (0, 1, 0), 30, (1, 0, 0))
    np.testing.assert_array_equal(target_of(motion("shift=1,2,3"), CUBE), [1, 2, 3])
    quarter = target_of(motion("turn=z,90 shift=0,0,1"), CUBE)
    np.testing.assert_allclose(quarter @ [0.5, 0.5, 1, 1], [0.5, 0.5, 2, 1], atol=1e-12)
    np.testing.assert_allclose(quarter @ [1, 0.5, 1, 1], [0.5, 1, 2, 1], atol=1e-12)
    about = target_of(motion("turn=0,0,2,90 about=0,0,0"), CUBE)
    np.testing.assert_allclose(about @ [1, 0, 5, 1], [0, 1, 5, 1], atol=1e-12)
