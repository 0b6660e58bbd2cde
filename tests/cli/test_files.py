"""Files in and out: names, what exists is kept, whatever happens."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable
from pathlib import Path

import children
import pytest
from commandline import PROGRAM, TORUS, cli, posix

from deltamesh_cli import failures

full = pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")


@pytest.mark.parametrize(
    ("name", "arguments", "expected"),
    [
        ("torus.ply.dmesh", "", "torus.ply"),
        ("torus.OFF.dmesh", "", "torus.OFF"),
        ("torus.dmesh", "", "torus.ply"),
        ("scan.2024.dmesh", "", "scan.2024.ply"),
        ("torus.ply.DMESH", "", "torus.ply"),
        ("torus.dmesh", "--output-format obj", "torus.obj"),
        ("torus.ply.dmesh", "--output-format obj", "torus.obj"),
        ("torus.ply.dmesh", "x.stl", "x.stl"),
        ("torus.ply.dmesh", "x.stl --output-format off", "x.stl"),
        ("torus.ply.dmesh", "-o x --output-format glb", "x"),
    ],
)
def test_name_of_the_decoded_file(
    folder: Path, torus_dmesh: bytes, name: str, arguments: str, expected: str
) -> None:
    Path("torus.ply").unlink()
    Path("torus.dmesh").unlink()
    Path(name).write_bytes(torus_dmesh)
    assert cli("decode", name, *arguments.split()) == 0
    assert {path.name for path in folder.iterdir()} == {name, expected}


def test_names_from_everywhere(folder: Path) -> None:
    for name in ("größe 山.ply", "-v", "a\nb.ply"):
        Path(name).write_bytes(TORUS.read_bytes())
        assert cli("encode -q --input-format ply --", name) == 0
        assert cli("decode -q -f --output-format ply --", f"{name}.dmesh") == 0


@posix
def test_a_name_that_is_not_unicode(folder: Path) -> None:
    name = os.fsdecode(b"\xff\xfe.ply")
    try:
        Path(name).write_bytes(TORUS.read_bytes())
    except OSError:
        pytest.skip("the file system takes Unicode names only")
    done = children.run([*PROGRAM, "encode", name], text=True)
    assert done.returncode == 0
    assert "\\udcff\\udcfe.ply" in done.stdout


def test_an_output_that_exists_is_kept(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for command in ("encode torus.ply torus.dmesh", "decode torus.dmesh"):
        assert cli(command) == failures.FAILED
        assert "it exists already (-f overwrites it)" in capsys.readouterr().err
        assert cli(command, "-f") == failures.DONE


@posix
def test_an_overwritten_file_keeps_its_permissions_a_new_one_has_those_of_the_umask(
    folder: Path,
) -> None:
    Path("torus.dmesh").chmod(0o604)
    previous = os.umask(0o027)
    try:
        assert cli("encode -q -f torus.ply torus.dmesh") == 0
        assert cli("encode -q torus.ply new.dmesh") == 0
    finally:
        os.umask(previous)
    modes = [stat.S_IMODE(Path(name).stat().st_mode) for name in ("torus.dmesh", "new.dmesh")]
    assert modes == [0o604, 0o640]


@posix
@pytest.mark.parametrize("make", [os.symlink, os.link])
def test_the_input_is_never_the_output(
    folder: Path, make: Callable[[str, str], None], capsys: pytest.CaptureFixture[str]
) -> None:
    make("torus.ply", "alias.ply")
    for target in ("torus.ply", "./torus.ply", "alias.ply"):
        assert cli("encode -f --force-name torus.ply", target) == failures.FAILED
        assert "it is the input itself" in capsys.readouterr().err
    assert Path("torus.ply").read_bytes() == TORUS.read_bytes()


def test_a_mesh_file_is_no_output_of_encode(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("other.ply").write_bytes(TORUS.read_bytes())
    for line in ("torus.ply other.ply", "-f torus.ply -o other.ply", "torus.ply new"):
        assert cli(f"encode {line}") == failures.USAGE
        assert "does not end in .dmesh. deltamesh batch encodes" in capsys.readouterr().err
    assert Path("other.ply").read_bytes() == TORUS.read_bytes()
    assert not Path("new").exists()
    for name in ("a.dmesh.zst", "b.DMESH", "c.bin --force-name"):
        assert cli(f"encode -q torus.ply {name}") == 0
        assert Path(name.split()[0]).exists()


@posix
def test_a_symbolic_link_is_written_through(folder: Path) -> None:
    os.symlink("torus.dmesh", "link.dmesh")
    before = Path("torus.dmesh").stat().st_ino
    assert cli("encode -q -f torus.ply link.dmesh -b 5") == 0
    assert Path("link.dmesh").is_symlink()
    assert Path("torus.dmesh").stat().st_ino != before


@posix
def test_a_device_is_written_in_place(folder: Path) -> None:
    assert cli("encode -q torus.ply /dev/null") == 0
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)


@pytest.mark.parametrize(
    ("line", "target"),
    [
        ("encode torus.ply new.dmesh", "new.dmesh"),
        ("decode torus.dmesh new.obj", "new.obj"),
        ("bench -q torus.ply --method cartesian --save new.csv", "new.csv"),
    ],
)
def test_an_output_that_appears_during_the_work_is_kept(
    folder: Path,
    line: str,
    target: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    synchronize = os.fsync

    def meanwhile(descriptor: int) -> None:
        synchronize(descriptor)
        Path(target).write_bytes(b"precious")

    monkeypatch.setattr(os, "fsync", meanwhile)
    assert cli(line) == failures.FAILED
    told = capsys.readouterr().err
    assert told == f"deltamesh: {target}: cannot write: it exists already (-f overwrites it)\n"
    assert Path(target).read_bytes() == b"precious"
    monkeypatch.setattr(os, "fsync", synchronize)
    assert cli(line, "-f") == failures.DONE
    assert Path(target).read_bytes() != b"precious"


def test_the_same_output_of_another_process_is_no_failure(
    folder: Path, torus_dmesh: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "fsync", lambda file: Path("new.dmesh").write_bytes(torus_dmesh))
    assert cli("encode -q torus.ply new.dmesh") == failures.DONE
    assert Path("new.dmesh").read_bytes() == torus_dmesh


@full
@pytest.mark.parametrize(
    "line",
    ["encode -q torus.ply /dev/full", "decode -q torus.dmesh /dev/full --output-format obj"],
)
def test_a_full_disk_is_no_bug(folder: Path, line: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli(line) == failures.FAILED
    told = capsys.readouterr().err
    assert told == "deltamesh: /dev/full: cannot write: no space left on device\n"


@full
@pytest.mark.parametrize(
    "line",
    [
        "--help",
        "info torus.dmesh",
        "info --json torus.dmesh",
        "encode -q torus.ply -",
        "encode -q torus.ply /dev/stdout",
        "batch -q torus.dmesh -d -f --json",
    ],
)
def test_standard_output_that_takes_no_more_is_no_bug(folder: Path, line: str) -> None:
    with open("/dev/full", "wb") as device:
        done = children.run([*PROGRAM, *line.split()], stdout=device)
    assert done.returncode == failures.FAILED
    assert done.stderr == b"deltamesh: standard output: cannot write: no space left on device\n"


@full
def test_standard_error_that_takes_no_more(folder: Path) -> None:
    with open("/dev/full", "wb") as device:
        done = children.run([*PROGRAM, "info", "nothing.dmesh"], stdout=device, stderr=device)
    assert done.returncode == failures.FAILED


@posix
@pytest.mark.parametrize(
    "name", ["/dev/stdout", pytest.param("link.dmesh", marks=pytest.mark.slow)]
)
def test_standard_output_by_another_name(folder: Path, torus_dmesh: bytes, name: str) -> None:
    if not os.path.exists("/dev/stdout"):
        pytest.skip("no /dev/stdout")
    os.symlink("/dev/stdout", "link.dmesh")
    quiet = [] if name == "/dev/stdout" else ["-q"]
    command = [*PROGRAM, "encode", "torus.ply", name, *quiet]
    assert children.run(command).stdout == torus_dmesh
    with open("out", "wb") as file:
        assert children.run(command, stdout=file).returncode == failures.DONE
    assert Path("out").read_bytes() == torus_dmesh


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("encode torus.ply nowhere/a.dmesh", "its folder does not exist (create "),
        ("encode torus.ply .", "it is a folder (name a file in it)"),
        ("decode torus.dmesh . --output-format ply", "it is a folder (name a file in it)"),
        ("encode .", "it is a folder, not a file (deltamesh batch takes folders)"),
        ("decode .", "it is a folder, not a file (deltamesh batch takes folders)"),
        ("encode missing.ply", "missing.ply: cannot read: no such file or directory"),
        ("decode missing.dmesh", "missing.dmesh: cannot read: no such file or directory"),
        ("compare torus.ply missing.dmesh", "missing.dmesh: cannot read: no such file"),
        ("encode torus.dmesh", "(deltamesh decode turns it into a mesh file)"),
        ("encode torus.xyz", "(it begins like PLY: --input-format ply)"),
    ],
)
def test_a_file_that_cannot_be_had(
    folder: Path, arguments: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("torus.xyz").write_bytes(TORUS.read_bytes())
    assert cli(arguments) == failures.FAILED
    error = capsys.readouterr().err
    assert message in error
    assert error.startswith("deltamesh: ")
    assert error.count("\n") == 1
