"""The process: pipes, terminals, signals, progress."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

import children
import pytest
from commandline import PROGRAM, TORUS, cli, posix

from deltamesh_cli import failures, files, progress, signals


def test_pipes(folder: Path) -> None:
    encode = [*PROGRAM, "encode", "-", "--input-format", "ply"]
    made = children.run(encode, given=TORUS.read_bytes())
    assert (made.returncode, made.stderr) == (0, b"")
    assert made.stdout == Path("torus.dmesh").read_bytes()
    back = children.run([*PROGRAM, "decode", "-"], given=made.stdout)
    assert (back.returncode, back.stderr) == (0, b"")
    assert back.stdout.startswith(b"ply")


def test_a_reader_that_has_gone_is_no_news(folder: Path) -> None:
    names = [f"{number}.dmesh" for number in range(200)]
    for name in names:
        (folder / name).write_bytes((folder / "torus.dmesh").read_bytes())
    command = [*PROGRAM, "info", *names]
    with children.started(command, stdout=subprocess.PIPE) as child:
        assert child.process.stdout is not None
        child.process.stdout.readline()
        child.process.stdout.close()
        done = child.finish()
    assert (done.returncode, done.stderr) == (failures.FAILED, b"")


@posix
def test_binary_is_not_written_to_a_terminal(folder: Path) -> None:
    done = children.run([*PROGRAM, "encode", "torus.ply", "-"], terminal="stdout")
    assert (done.returncode, done.stdout) == (failures.FAILED, b"")
    assert b"standard output: cannot write: it is a terminal" in done.stderr


@posix
def test_a_mesh_is_not_read_from_a_terminal(folder: Path) -> None:
    command = [*PROGRAM, "encode", "-", "--input-format", "off"]
    done = children.run(command, terminal="stdin")
    assert done.returncode == failures.FAILED
    assert b"standard input: cannot read: it is a terminal" in done.stderr


@posix
def test_progress_is_shown_on_a_terminal_only(folder: Path) -> None:
    def told(*flags: str) -> bytes:
        command = [*PROGRAM, "test", "torus.dmesh", *flags]
        environment = os.environ | {"TERM": "xterm", "COLUMNS": "80"}
        done = children.run(command, terminal="stderr", env=environment)
        assert done.returncode == 0
        return done.stderr

    assert b"starting" in told()
    assert told("--no-progress") == told("-q") == b""


def test_verbose_tells_each_stage(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("encode -v torus.ply --quality 3") == 0
    *lines, note = capsys.readouterr().err.splitlines()
    assert note.startswith("note: torus.ply: triangles that turned over")
    assert lines[1].startswith("deltamesh: reading: ")
    assert all(line.endswith(" s") for line in lines)
    assert len(lines) > 3


def test_a_stage_that_goes_on_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with progress.displayed_progress(None, verbose=True) as stage:
        stage("solving")
        stage("solving")
    lines = capsys.readouterr().err.splitlines()
    assert [line.rpartition(":")[0] for line in lines] == [
        "deltamesh: starting",
        "deltamesh: solving",
    ]


def test_small_meshes_wait_for_no_import_of_others(folder: Path) -> None:
    commands = (["encode", "torus.ply", "new.dmesh"], ["decode", "new.dmesh", "new.ply"])
    for command in commands:
        done = children.run([sys.executable, "-X", "importtime", *PROGRAM[1:], *command])
        assert done.returncode == 0, done.stderr
        imported = {line.rpartition(b"|")[2].strip() for line in done.stderr.splitlines()}
        assert b"numpy" in imported
        assert not imported & {b"numpy.ma", b"scipy", b"rslab", b"trimesh"}


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="Linux only")
def test_numpy_starts_no_thread_for_each_core() -> None:
    code = (
        "import os, deltamesh_cli; from deltamesh_cli import program; "
        "program.run_and_exit = lambda: exec('import numpy'); deltamesh_cli.main(); "
        "print(len(os.listdir('/proc/self/task')))"
    )
    environment = {k: v for k, v in os.environ.items() if not k.endswith("_NUM_THREADS")}
    done = children.run([sys.executable, "-c", code], env=environment)
    assert (done.returncode, done.stdout) == (0, b"1\n"), done.stderr


@posix
def test_ctrl_c_ends_with_130_and_no_file(folder: Path) -> None:
    os.mkfifo("pipe.ply")
    command = [*PROGRAM, "encode", "pipe.ply", "out.dmesh"]
    opened: list[int] = []

    def is_open() -> bool:
        with suppress(OSError):  # until the program has opened it, and waits for bytes
            opened.append(os.open("pipe.ply", os.O_WRONLY | os.O_NONBLOCK))
        return bool(opened)

    with children.started(command) as child:
        children.wait_for(is_open)
        time.sleep(0.2)  # a signal between its opening and its first reading would wake nobody
        child.process.send_signal(signal.SIGINT)
        done = child.finish()
    os.close(*opened)
    assert done.stderr.endswith(b"deltamesh: interrupted\n")
    assert done.returncode == 130
    assert not Path("out.dmesh").exists()


@posix
def test_ctrl_c_is_heard_while_the_codec_works() -> None:
    threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
    start = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        signals.interruptible(lambda: time.sleep(3))
    assert time.perf_counter() - start < 2


def test_what_the_second_thread_raises_is_raised_here() -> None:
    assert signals.interruptible(lambda: 3) == 3
    with pytest.raises(ZeroDivisionError):
        signals.interruptible(lambda: 1 // 0)


@posix
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_signal_while_writing_leaves_no_file(
    folder: Path, number: signal.Signals, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(descriptor: int) -> None:
        os.kill(os.getpid(), number)
        time.sleep(1)

    monkeypatch.setattr(os, "fsync", interrupted)
    # Whoever runs the tests may ignore the signal, as nohup does.
    previous = signal.signal(number, signal.SIG_DFL)
    try:
        with pytest.raises(signals.Stopped) as stopped:
            files.write_output("out.dmesh", b"whole", force=False)
        assert signal.getsignal(number) is signal.SIG_DFL
    finally:
        signal.signal(number, previous)
    assert stopped.value.number == number
    assert not Path("out.dmesh").exists()


@posix
def test_an_ignored_signal_stays_ignored(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "fsync", lambda descriptor: os.kill(os.getpid(), signal.SIGHUP))
    previous = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        files.write_output("out.dmesh", b"whole", force=False)
    finally:
        signal.signal(signal.SIGHUP, previous)
    assert Path("out.dmesh").read_bytes() == b"whole"
