"""Which files are meant, and where their outputs go."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from deltamesh.batch import Selection, check_targets, find, flat, mirrored
from deltamesh_formats.errors import OptionError

ALL = Selection(("ply", "obj"), recursive=True)

posix = pytest.mark.skipif(os.name != "posix", reason="file names of POSIX")


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("b.ply", "a.PLY", "notes.txt", "sub/c.obj", "sub/deep/d.ply", "old/e.ply"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_folder_is_all_meshes_in_it_sorted(tree: Path) -> None:
    assert find(["."], ALL) == ["a.PLY", "b.ply", "old/e.ply", "sub/c.obj", "sub/deep/d.ply"]
    assert find(["sub"], ALL) == ["sub/c.obj", "sub/deep/d.ply"]
    assert find([str(tree / "sub/deep")], ALL) == [str(tree / "sub/deep/d.ply")]


def test_without_r_only_the_files_directly_in_a_folder(tree: Path) -> None:
    assert find([".", "sub"], Selection(("ply", "obj"))) == ["a.PLY", "b.ply", "sub/c.obj"]


def test_an_empty_folder_holds_nothing(tree: Path) -> None:
    (tree / "empty").mkdir()
    assert find(["empty"], ALL) == []


def test_named_files_are_taken_whatever_they_are(tree: Path) -> None:
    assert find(["notes.txt", "missing.ply"], ALL) == ["missing.ply", "notes.txt"]


def test_each_file_once(tree: Path) -> None:
    names = ["b.ply", "./b.ply", str(tree / "b.ply"), "sub/../b.ply", "b.ply"]
    assert find(names, ALL) == ["b.ply"]
    assert find(["sub", "sub/c.obj", "."], ALL).count("sub/c.obj") == 1


def test_patterns(tree: Path) -> None:
    assert find(["*.ply"], ALL) == ["b.ply"]
    assert find(["**/*.ply"], ALL) == ["b.ply", "old/e.ply", "sub/deep/d.ply"]
    assert find([f"{tree}/s*/*.obj"], ALL) == [str(tree / "sub/c.obj")]
    assert find(["*.stl"], ALL) == ["*.stl"], "what nothing matches is somebody's mistake"
    assert find(["*.ply"], ALL, patterns=False) == ["*.ply"]
    (tree / "[b].ply").touch()
    assert find(["[b].ply"], ALL) == ["[b].ply"], "the file itself comes before the pattern"


def test_include_and_exclude(tree: Path) -> None:
    def found(**patterns: tuple[str, ...]) -> list[str]:
        return find(["."], Selection(("ply", "obj"), recursive=True, **patterns))

    assert found(include=("*.obj", "b*")) == ["b.ply", "sub/c.obj"]
    assert found(exclude=("sub",)) == ["a.PLY", "b.ply", "old/e.ply"]
    assert found(include=("*.ply",), exclude=("sub/*", "old")) == ["b.ply"]
    assert found(include=("sub/*.ply",)) == ["sub/deep/d.ply"]
    assert find(["b.ply", "sub/c.obj"], Selection((), exclude=("*.obj",))) == ["b.ply"]


def test_the_folder_of_the_output_is_not_looked_into(tree: Path) -> None:
    without = Selection(("ply", "obj"), recursive=True, never="sub/../sub")
    assert find(["."], without) == ["a.PLY", "b.ply", "old/e.ply"]
    assert find(["sub"], without) == ["sub/c.obj", "sub/deep/d.ply"], "unless it is named"


@posix
def test_links(tree: Path) -> None:
    (tree / "sub" / "loop").symlink_to(tree)
    (tree / "sub" / "itself").symlink_to("itself")
    (tree / "link.ply").symlink_to("b.ply")
    (tree / "gone.ply").symlink_to("nowhere.ply")
    found = find(["."], ALL)
    assert found == sorted(
        ["a.PLY", "b.ply", "gone.ply", "link.ply", "old/e.ply", "sub/c.obj", "sub/deep/d.ply"]
    )
    assert find(["sub/loop"], Selection(("obj",), recursive=True)) == ["sub/loop/sub/c.obj"]
    assert len(find(["**/*.ply"], ALL)) == 5


@posix
def test_what_is_no_file_is_not_taken_from_a_folder(tree: Path) -> None:
    os.mkfifo("pipe.ply")
    (tree / "folder.ply").mkdir()
    assert "pipe.ply" not in find(["."], ALL)
    assert "folder.ply" not in find(["*.ply"], ALL)


@posix
def test_any_name(tree: Path) -> None:
    names = ["new\nline.ply", "ünï 网格.ply", os.fsdecode(b"\xff\xfe.ply"), "-x.ply", " .ply"]
    for name in names:
        (tree / "old" / name).touch()
    assert set(find(["old"], ALL)) == {f"old/{name}" for name in [*names, "e.ply"]}


def test_folders_that_cannot_be_listed_are_told(
    tree: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scan = os.scandir

    def scandir(path: str) -> object:
        if path.endswith("deep"):
            raise PermissionError(13, "Permission denied", path)
        return scan(path)

    monkeypatch.setattr(os, "scandir", scandir)
    failed: list[OSError] = []
    assert find(["sub"], ALL, failed=failed.append) == ["sub/c.obj"]
    assert [error.filename for error in failed] == [os.path.join("sub", "deep")]
    with pytest.raises(PermissionError):
        find(["sub"], ALL)


def test_places() -> None:
    assert flat("out", "a/b/c.ply") == os.path.join("out", "c.ply")
    for name in ("a/b/c.ply", "./a//b/c.ply", "/a/b/c.ply", "a/x/../b/c.ply"):
        assert mirrored("out", name) == os.path.join("out", "a", "b", "c.ply")
    for name in ("../c.ply", "a/../../c.ply"):
        with pytest.raises(OptionError, match="no place in a mirror"):
            mirrored("out", name)


def test_outputs_that_collide_are_refused(tree: Path) -> None:
    check_targets([("a", "out/a.dmesh"), ("b", "out/b.dmesh")])
    with pytest.raises(OptionError, match=r"'x/a' and 'y/a' would both be written to '.*a.dmesh'"):
        check_targets([("x/a", "out/a.dmesh"), ("b", "c"), ("y/a", "sub/../out/a.dmesh")])
    with pytest.raises(OptionError, match=r"'a' would be written, but is an input"):
        check_targets([("b", "a"), ("./a", "c")])


@posix
def test_a_collision_through_a_link_to_a_folder_is_one(tree: Path) -> None:
    (tree / "also").symlink_to("sub")
    with pytest.raises(OptionError):
        check_targets([("x", "sub/out"), ("y", "also/out")])


def test_folders_of_a_store_are_searched_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    fsspec = pytest.importorskip("fsspec")
    fs = fsspec.filesystem("memory")
    monkeypatch.setattr(type(fs), "store", {})
    monkeypatch.setattr(type(fs), "pseudo_dirs", [""])
    names = ("a.ply", "b.txt", "draft/c.ply", "deep/d.PLY.gz", "deep/draft.ply", "out/e.ply")
    fs.pipe({f"/shop/{name}": b"x" for name in names})

    def found(*names: str, **rules: object) -> list[str]:
        selection = Selection(("ply",), **rules)
        return [name.removeprefix("memory:///shop/") for name in find(names, selection)]

    top = "memory://shop"
    assert found(top, recursive=True) == [
        "a.ply",
        "deep/d.PLY.gz",
        "deep/draft.ply",
        "draft/c.ply",
        "out/e.ply",
    ]
    assert found(top, recursive=True, exclude=("draft*",), never="memory://shop/out") == [
        "a.ply",
        "deep/d.PLY.gz",
    ]
    assert found(top, recursive=True, include=("*.gz",)) == ["deep/d.PLY.gz"]
    assert found(top) == ["a.ply"]
    assert found(f"{top}/*.ply") == ["a.ply"]
    assert found(f"{top}/none*.ply", "memory://shop/none.ply") == [
        "memory://shop/none*.ply",
        "memory://shop/none.ply",
    ]


def test_files_of_other_places_are_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """A page of a server may name any: this ends, too."""
    listed = ["http://h/in/a.ply", "http://other/in/b.ply", "http://h/c.ply", "x://d.ply", "e.ply"]
    monkeypatch.setattr("deltamesh.batch._finding.is_folder", lambda url: True)
    monkeypatch.setattr("deltamesh.batch._finding.files_below", lambda url, recursive: listed)
    assert find(["http://h/in/"], Selection(("ply",), recursive=True)) == listed[:1]
