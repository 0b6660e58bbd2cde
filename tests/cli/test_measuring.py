"""Parts of the command bench: names of meshes, tables of changes, exit codes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from deltamesh.bench import Change
from deltamesh_cli.failures import DONE, MISSED, Failure
from deltamesh_cli.inputs import MESH, Choice
from deltamesh_cli.measuring import (
    codecs_of,
    has_peer,
    labels_in,
    names_in_tables,
    peer_labels,
    read_rates,
)
from deltamesh_cli.rate_tables import change_table, report_changes

GREW = Change("a.ply", "cartesian bits=10", "bytes", "100", "110", "grew", 0.1)
LESS = Change("a.ply", "cartesian bits=10", "rms", "0.2", "0.1", "shrank", -0.5)
GONE = Change("b.ply", "draco 11", "row", "there", "", "gone")


def silent(stage: str) -> None:
    """Tell nobody."""


@pytest.fixture
def scans(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name in ("scans/a.ply", "scans/below/b.obj", "scans/notes.txt", "other/a.ply"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"?")
    return tmp_path


def named(*names: str, recursive: bool = False) -> dict[str, str]:
    found = names_in_tables(Choice(recursive).inputs(names, MESH))
    return {name: one.path for name, one in found.items()}


def test_meshes_of_a_folder_are_named_below_it(scans: Path) -> None:
    assert list(named("scans")) == ["a.ply"]
    assert named(str(scans / "scans"), recursive=True) == {
        "a.ply": str(scans / "scans" / "a.ply"),
        "below/b.obj": str(scans / "scans" / "below" / "b.obj"),
    }


def test_meshes_with_one_name_are_named_by_their_paths(scans: Path) -> None:
    assert list(named("scans/a.ply", "other/a.ply")) == ["scans/a.ply", "other/a.ply"]
    # One file that is named twice has its own name.
    assert list(named("scans/a.ply", "scans/a.ply")) == ["a.ply"]


def test_labels_are_those_of_the_mesh_or_of_all_others() -> None:
    rows = [
        {"mesh": "a", "codec": "cartesian bits=10"},
        {"mesh": "a", "codec": "draco 11"},
        {"mesh": "b", "codec": "cartesian bits=10"},
    ]
    assert labels_in(rows, "b") == ["cartesian bits=10"]
    assert labels_in(rows, "new") == ["cartesian bits=10", "draco 11"]


def test_other_codecs_are_told_apart() -> None:
    labels = peer_labels(["draco"], (10, 11))
    assert len(labels) == 2
    assert has_peer(labels)
    assert not has_peer(["cartesian bits=10"])
    with pytest.raises(Failure, match="unknown codec"):
        codecs_of(["nothing 10"], (), solver="auto", threads=None)
    (own,) = codecs_of(["cartesian bits=10", *labels], labels, solver="auto", threads=None)
    assert own.label == "cartesian bits=10"


def test_changes_are_told_and_decide_the_exit_code(capsys: pytest.CaptureFixture[str]) -> None:
    assert report_changes("x.csv", [], 7, as_json=False, quiet=False) == DONE
    assert capsys.readouterr().out == "7 rows match x.csv\n"
    assert report_changes("x.csv", [], 7, as_json=False, quiet=True) == DONE
    assert capsys.readouterr().out == ""
    assert report_changes("x.csv", [LESS], 7, as_json=False, quiet=False) == DONE
    assert "differences from x.csv" in capsys.readouterr().err
    assert report_changes("x.csv", [LESS, GONE], 7, as_json=True, quiet=False) == MISSED
    objects = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [one["worse"] for one in objects] == [False, True]


def test_a_table_of_changes_has_their_growth() -> None:
    lines = change_table([GREW, LESS, GONE]).splitlines()
    assert "+10.00 %" in lines[1]
    assert "-50.00 %" in lines[2]
    assert "%" not in lines[3]


def test_a_file_that_is_no_table_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    path.write_text("no, such\n1,2\n")
    with pytest.raises(Failure, match="cannot compare with it"):
        read_rates(str(path))
