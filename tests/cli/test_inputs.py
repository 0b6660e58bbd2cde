"""Files of a command: the same words mean the same files to every command."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from commandline import cli, posix

from deltamesh_cli.failures import Failure
from deltamesh_cli.inputs import DMESH, EITHER, MESH, Choice

NAMES = ("a.ply", "b.dmesh", "notes.txt", "deep/c.obj", "deep/c.obj.dmesh", "deep/er/d.dmesh.zst")


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in NAMES:
        path = tmp_path / "scans" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"?")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_folder_stands_for_the_files_of_a_kind_in_it(tree: Path) -> None:
    def names(kind: object, **options: object) -> list[str]:
        return [one.name for one in Choice(**options).inputs(["scans"], kind)]

    assert names(MESH) == ["a.ply"]
    assert names(DMESH) == ["b.dmesh"]
    assert names(EITHER) == ["a.ply", "b.dmesh"]
    assert names(DMESH, recursive=True) == ["b.dmesh", "deep/c.obj.dmesh", "deep/er/d.dmesh.zst"]
    assert names(DMESH, recursive=True, include=("*.obj.*",)) == ["deep/c.obj.dmesh"]
    assert names(DMESH, recursive=True, exclude=("deep",)) == ["b.dmesh"]


def test_files_are_in_the_order_of_their_names_and_each_is_there_once(tree: Path) -> None:
    names = ["scans/notes.txt", "scans/*.ply", "scans/../scans/a.ply", "-", "scans"]
    found = Choice(recursive=True).inputs(names, MESH)
    assert [one.path for one in found] == [
        "scans/notes.txt", "scans/a.ply", "-", "scans/deep/c.obj",
    ]  # fmt: skip
    assert [one.name for one in found] == ["notes.txt", "a.ply", "-", "deep/c.obj"]
    assert [one.in_folder for one in found] == [False, False, False, True]


def test_lists_have_a_name_a_line_or_names_that_end_in_nul(tree: Path) -> None:
    path = tree / "list"
    path.write_bytes(b"a b.ply\r\n\n*.ply\nscans\n")
    found = [one.path for one in Choice(lists=("list",)).inputs(["c.ply"], MESH)]
    assert found == ["c.ply", "a b.ply", "*.ply", "scans/a.ply"]
    path.write_bytes(b"a\nb.ply\0c.ply\r\0")
    assert Choice(lists=("list",), null=True).listed() == ["a\nb.ply", "c.ply\r"]
    with pytest.raises(Failure, match="nothing: cannot read"):
        Choice(lists=("nothing",)).listed()
    (one,) = Choice(lists=("nothing",)).inputs([], MESH)
    with pytest.raises(Failure, match="nothing: cannot read"):
        one.checked()


def test_a_folder_without_files_of_the_kind_fails(tree: Path) -> None:
    (tree / "empty").mkdir()
    (one,) = Choice().inputs(["empty"], DMESH)
    with pytest.raises(Failure, match=r"no \.dmesh file in this folder .*-r searches"):
        one.checked()
    (one,) = Choice(recursive=True).inputs(["empty"], MESH)
    with pytest.raises(Failure, match=r"no mesh file in this folder$"):
        one.checked()


def test_a_folder_that_cannot_be_listed_fails_and_others_do_not(
    tree: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scan = os.scandir

    def scandir(path: str) -> object:
        if path.endswith("deep"):
            raise PermissionError(13, "Permission denied", path)
        return scan(path)

    monkeypatch.setattr(os, "scandir", scandir)
    first, second = Choice(recursive=True).inputs(["scans"], MESH)
    assert first.checked() == "scans/a.ply"
    with pytest.raises(Failure, match="deep: cannot read: permission denied"):
        second.checked()


@posix
def test_every_command_takes_folders_patterns_and_lists(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("in/one.ply", "in/below/two.ply"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes((folder / "torus.ply").read_bytes())
        (folder / f"{name}.dmesh").write_bytes((folder / "torus.dmesh").read_bytes())
    (folder / "list").write_text("in/below/two.ply.dmesh\n")
    words = {
        "in": 1,
        "-r in": 2,
        "-r in --include one*": 1,
        "in/**/*.dmesh": 2,
        "--filelist list": 1,
        "in --filelist list": 2,
        "-r in --exclude below --filelist list": 2,
    }
    for command in ("info", "test", "batch -d -n", "batch -n", "bench --bits 5"):
        for line, count in words.items():
            mesh = command in ("batch -n", "bench --bits 5")
            if mesh:
                (folder / "list").write_text("in/below/two.ply\n")
                line = line.replace("*.dmesh", "*.ply")
            if command.startswith("batch"):
                line += " --skip-existing"
            assert cli(f"{command} --json {line}") == 0, (command, line)
            objects = map(json.loads, capsys.readouterr().out.splitlines())
            assert sum("summary" not in one for one in objects) == count, (command, line)
        (folder / "list").write_text("in/below/two.ply.dmesh\n")
