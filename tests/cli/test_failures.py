"""Exit codes and messages."""

from __future__ import annotations

import errno
import json
import os
from pathlib import Path

import pytest
from commandline import TORUS, cli, damaged

from deltamesh_cli import failures
from deltamesh_formats.errors import FormatError, LimitError, MeshError, SolveError, TargetError


@pytest.mark.parametrize(
    "arguments",
    [
        "",
        "frobnicate",
        "encode",
        "encode torus.ply --frobnicate",
        "encode torus.ply -qp 11",
        "encode torus.ply a b",
        "encode torus.ply a -o b",
        "encode torus.ply --bits 99",
        "encode torus.ply --bits -1",
        "encode torus.ply --bits 8 --step 1",
        "encode torus.ply --step 0",
        "encode torus.ply --step nan",
        "encode torus.ply --step inf",
        "encode torus.ply --anchors 0",
        "encode torus.ply --anchors 1.5",
        "encode torus.ply --anchors x",
        "encode torus.ply --seed 18446744073709551616",
        "encode torus.ply --threads 0",
        "encode torus.ply --solver lapack",
        "encode torus.ply --input-format xyz",
        "encode torus.ply --method cartesian --anchors 3",
        "encode torus.ply - --json",
        "encode -",
        "decode torus.ply",
        "decode torus.dmesh a.xyz",
        "decode torus.dmesh --memory lots",
        "info",
        "test",
        "compare torus.ply",
        "compare - -",
    ],
)
def test_usage_errors(folder: Path, arguments: str, capsys: pytest.CaptureFixture[str]) -> None:
    before = set(folder.iterdir())
    assert cli(arguments) == failures.USAGE
    assert capsys.readouterr().err
    assert set(folder.iterdir()) == before


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("encode -fuze.ply", "-fuze.ply"),
        ("encode -oze.ply", "-oze.ply"),
        ("decode -x.ply.dmesh.zst", "-x.ply.dmesh.zst"),
        ("info -there", "-there"),
        ("encode --frobnicate torus.ply", None),
        ("encode -f", None),
        ("encode --drop=a.ply", None),
        ("encode -- -fuze.ply -there a b", None),
    ],
)
def test_names_that_begin_like_options_get_a_hint(
    folder: Path, line: str, name: str | None, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "-there").write_bytes(b"?")
    assert cli(line) == failures.USAGE
    error = capsys.readouterr().err
    hint = f"Hint: if {name} is a file, put -- before it: deltamesh ... -- {name}\n"
    assert error.endswith(hint) if name else "Hint" not in error


def test_damaged_files_are_refused_with_the_offset_and_nothing_is_written(
    folder: Path, torus_dmesh: bytes, capsys: pytest.CaptureFixture[str]
) -> None:
    for data in (damaged(torus_dmesh), torus_dmesh[:-1], torus_dmesh + b"\0", b"", b"ply\n"):
        Path("bad.dmesh").write_bytes(data)
        before = set(folder.iterdir())
        for command in ("decode bad.dmesh", "info bad.dmesh", "test bad.dmesh"):
            assert cli(command) == failures.REFUSED
            assert "at byte " in capsys.readouterr().err
        assert set(folder.iterdir()) == before


def test_ctrl_c_says_how_many_files_are_done(
    capsys: pytest.CaptureFixture[str],
) -> None:
    def action(item: int) -> None:
        if item == 2:
            raise KeyboardInterrupt

    for items, told in (([1, 2, 3], "deltamesh: 1 of 3 files are done\n"), ([2], "")):
        with pytest.raises(KeyboardInterrupt):
            failures.process_all(items, action, as_json=False)
        assert capsys.readouterr() == ("", told)


def test_limits_refuse(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for limit in ("--max-vertices 2591", "--memory 1K"):
        for command in ("decode -f torus.dmesh", "test torus.dmesh"):
            assert cli(f"{command} {limit}") == failures.REFUSED
            assert "--max-vertices and --memory raise the limits" in capsys.readouterr().err
    assert cli("test torus.dmesh --max-vertices 2592 --memory 1G") == failures.DONE


@pytest.mark.parametrize(
    ("error", "code", "message"),
    [
        (MeshError("vertex 3 is not finite"), 1, "vertex 3 is not finite"),
        (SolveError("singular"), 1, "singular (--solver names another solver)"),
        (PermissionError(errno.EACCES, "Permission denied", "x"), 1, "permission denied"),
        (OSError(errno.ENOSPC, "No space left on device"), 1, "no space left on device"),
        (MemoryError(), 1, "not enough memory"),
        (RecursionError("maximum"), 1, "it is nested too deeply"),
        (ZeroDivisionError("by\nzero"), 1, "ZeroDivisionError: by zero (a bug in deltamesh"),
        (FormatError("no end", 12), 3, "no end (at byte 12)"),
        (LimitError("too many"), 3, "too many (--max-vertices"),
        (TargetError("not within 1 degree"), 4, "not within 1 degree"),
    ],
)
def test_every_error_is_one_line_and_has_its_exit_code(
    folder: Path,
    error: Exception,
    code: int,
    message: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fail(*arguments: object, **options: object) -> None:
        raise error

    monkeypatch.setattr("deltamesh._codec.inputs.encode_checked", fail)
    assert cli("encode torus.ply") == code
    printed = capsys.readouterr()
    assert printed.err.startswith(f"deltamesh: torus.ply: cannot encode: {message}")
    assert printed.err.count("\n") == 1
    assert cli("encode torus.ply --json") == code
    told = json.loads(capsys.readouterr().out)
    assert told["exit_code"] == code
    assert told["error"]["offset"] == getattr(error, "offset", None)
    assert cli("encode torus.ply --debug") == code
    assert "Traceback" in capsys.readouterr().err
    monkeypatch.setenv("DELTAMESH_DEBUG", "1")
    assert cli("encode torus.ply") == code
    assert "Traceback" in capsys.readouterr().err


def test_a_failure_outside_of_any_file(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*arguments: object, **options: object) -> None:
        raise ZeroDivisionError("oops")

    monkeypatch.setattr("deltamesh_cli.files.chosen_output", fail)
    assert cli("encode torus.ply") == failures.FAILED
    error = capsys.readouterr().err
    assert error.startswith("deltamesh: ZeroDivisionError: oops (a bug in deltamesh")


def test_a_write_that_fails_leaves_the_old_file(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    assert cli("decode torus.dmesh torus.ply -f") == failures.FAILED
    assert "torus.ply: cannot write: no space left on device" in capsys.readouterr().err
    assert Path("torus.ply").read_bytes() == TORUS.read_bytes()


def test_the_name_of_a_mesh_file_is_told_once(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("points.ply").write_bytes(TORUS.read_bytes().replace(b"element face 5184", b"element x 0"))
    Path("empty.obj").write_bytes(b"")
    for name in ("points.ply", "empty.obj"):
        assert cli("encode", name) == failures.FAILED
        error = capsys.readouterr().err
        assert error.count(name) == 1
        assert "<stream>" not in error


@pytest.mark.parametrize(
    ("name", "start", "hint"),
    [
        ("a.obj", b"ply\nformat ascii 1.0\n", "it begins like PLY: --input-format ply"),
        ("a.ply", b"glTF", "it begins like GLB: --input-format glb"),
        ("a", b"OFF\n", "it begins like OFF: --input-format off"),
        ("a.dmesh", b"", "deltamesh decode turns it into a mesh file"),
        ("a.ply", b"ply\n", None),
        ("a.txt", b"v 0 0 0\n", "--input-format names the format"),
    ],
)
def test_a_file_of_another_format_is_told(
    name: str, start: bytes, hint: str | None, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    torus = Path("torus.dmesh").read_bytes()
    Path(name).write_bytes(start or torus)
    assert cli("encode", name, "out.dmesh") == failures.FAILED
    message = capsys.readouterr().err.rstrip()
    assert message.endswith(f"({hint})") if hint else "--input-format" not in message
