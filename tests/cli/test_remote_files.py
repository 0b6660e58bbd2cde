"""Commands on files at URLs: one file, many, and workers that share no disk."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import children
import pytest
from cubes import OBJ
from servers import served

from deltamesh_cli.failures import Failure
from deltamesh_cli.files import check_output, source_size
from deltamesh_cli.program import run

fsspec = pytest.importorskip("fsspec")


@pytest.fixture
def shop() -> str:
    """A folder in memory with two meshes."""
    fs = fsspec.filesystem("memory")
    fs.store.clear()
    fs.pseudo_dirs[:] = [""]
    fs.pipe({"/shop/a.obj": OBJ.encode(), "/shop/deep/b.obj": OBJ.encode()})
    return "memory://shop"


def stored() -> list[str]:
    return sorted(fsspec.filesystem("memory").store)


def test_one_file_there_and_back(
    shop: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["encode", f"{shop}/a.obj", "--lossless"]) == 0
    assert f"{shop}/a.obj.dmesh: " in capsys.readouterr().out
    assert run(["decode", f"{shop}/a.obj.dmesh", f"{shop}/out.off"]) == 0
    assert run(["decode", f"{shop}/a.obj.dmesh", "here.ply"]) == 0
    assert run(["encode", "here.ply", f"{shop}/again.dmesh.zst"]) == 0
    names = ["a.obj", "a.obj.dmesh", "again.dmesh.zst", "deep/b.obj", "out.off"]
    assert stored() == [f"/shop/{name}" for name in names]
    capsys.readouterr()
    for command in ("info", "test"):
        assert run([command, f"{shop}/again.dmesh.zst"]) == 0
    assert run(["compare", f"{shop}/a.obj", f"{shop}/out.off"]) == 0
    assert "8 vertices, 6 faces" in capsys.readouterr().out


def test_outputs_that_exist_are_not_overwritten(
    shop: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fsspec.filesystem("memory").pipe("/shop/a.obj.dmesh", b"mine")
    assert run(["encode", f"{shop}/a.obj"]) == 1
    assert "it exists already (-f overwrites it)" in capsys.readouterr().err
    assert fsspec.filesystem("memory").cat("/shop/a.obj.dmesh") == b"mine"
    assert run(["encode", f"{shop}/a.obj", "-f"]) == 0
    with pytest.raises(Failure, match="it is the input itself"):
        check_output(f"{shop}/a.obj", f"{shop}/a.obj", force=True)
    assert source_size(f"{shop}/a.obj", b"abc", None) == 3


def test_what_is_not_there_is_named(shop: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["encode", f"{shop}/no.obj"]) == 1
    said = capsys.readouterr().err
    assert said == f"deltamesh: {shop}/no.obj: cannot read: no such file or directory\n"


def test_a_missing_package_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for module in ("fsspec", "fsspec.core"):
        monkeypatch.setitem(sys.modules, module, None)
    assert run(["encode", "s3://bucket/a.obj", "a.dmesh"]) == 1
    assert "pip install 'deltamesh[remote]'" in capsys.readouterr().err


def test_a_folder_into_another_and_again(
    shop: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    call = ["batch", "-r", shop, "--output-dir-mirror", "memory://out", "--manifest", "run.jsonl"]
    assert run([*call, "--resume", "--json"]) == 0
    *records, last = map(json.loads, capsys.readouterr().out.splitlines())
    assert [one["status"] for one in records] == ["done", "done"]
    assert [one["target"] for one in records] == [
        "memory://out/shop/a.obj.dmesh",
        "memory://out/shop/deep/b.obj.dmesh",
    ]
    assert last["summary"]["exit_code"] == 0
    before = fsspec.filesystem("memory").cat("/out/shop/a.obj.dmesh")
    assert run([*call, "--resume"]) == 0
    assert "done before" in capsys.readouterr().out
    fsspec.filesystem("memory").pipe("/shop/a.obj", OBJ.replace("v 1 1 1", "v 1 1 2").encode())
    assert run([*call, "--resume"]) == 0
    assert fsspec.filesystem("memory").cat("/out/shop/a.obj.dmesh") != before
    assert run(["batch", "-d", "-r", "memory://out", "--output-dir-flat", "memory://back"]) == 0
    assert [name for name in stored() if name.startswith("/back")] == ["/back/a.obj", "/back/b.obj"]
    assert run(["batch", "memory://shop/*.obj", "--output-dir-flat", "flat"]) == 0
    assert os.listdir("flat") == ["a.obj.dmesh"]
    assert not any(".tmp" in name for name in stored())


def test_a_batch_says_what_exists_and_what_is_missing(
    shop: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["batch", f"{shop}/a.obj"]) == 0
    assert run(["batch", f"{shop}/a.obj", f"{shop}/none.obj"]) == 1
    said = capsys.readouterr().err
    assert "a.obj.dmesh: cannot write: it exists already" in said
    assert "none.obj: cannot read: no such file" in said
    assert run(["batch", f"{shop}/a.obj", "--skip-existing"]) == 0
    assert run(["batch", f"{shop}/a.obj", "--output-dir-flat", f"{shop}/new", "-n"]) == 0
    assert stored() == ["/shop/a.obj", "/shop/a.obj.dmesh", "/shop/deep/b.obj"]


def test_workers_that_share_no_disk(tmp_path: Path) -> None:
    """Processes in folders of their own, each with its share of a list: a server has all files."""
    pytest.importorskip("aiohttp")
    with served() as (url, files):
        names = [f"{name}.obj" for name in "abcd"]
        files.update({f"in/{name}": OBJ.encode() for name in names})
        files["list"] = "".join(f"{url}/in/{name}\n" for name in names).encode()
        for rank in range(2):
            (tmp_path / str(rank)).mkdir()
            share = ["--rank", str(rank), "--world-size", "2", "--filelist", f"{url}/list"]
            call = ["batch", *share, "--output-dir-flat", f"{url}/out", "--manifest", "run.jsonl"]
            done = children.run(
                [sys.executable, "-m", "deltamesh_cli", *call, "--resume"],
                cwd=tmp_path / str(rank),
                text=True,
            )
            assert done.returncode == 0, done.stderr
            assert sorted(os.listdir(tmp_path / str(rank))) == ["run.jsonl"]
        made = {name: data for name, data in files.items() if name.startswith("out/")}
        assert sorted(made) == [f"out/{name}.dmesh" for name in names]
        assert len(set(made.values())) == 1
        pool = ["batch", "-r", f"{url}/in/", "--output-dir-flat", f"{url}/pool", "-j", "2"]
        done = children.run([sys.executable, "-m", "deltamesh_cli", *pool], cwd=tmp_path, text=True)
        assert done.returncode == 0, done.stderr
        assert {files[f"pool/{name}.dmesh"] for name in names} == set(made.values())
