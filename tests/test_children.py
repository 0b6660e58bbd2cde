"""The tests' own child processes: none can make them wait for ever."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import children
import pytest

posix = pytest.mark.skipif(os.name != "posix", reason="terminals and process groups of POSIX")

# More than any pipe or terminal holds.
MUCH = 1 << 21


def python(code: str) -> list[str]:
    return [sys.executable, "-I", "-S", "-c", code]


def test_much_is_read_and_written_at_once() -> None:
    code = "import sys; data = sys.stdin.read(); sys.stderr.write(data); sys.stdout.write(data)"
    done = children.run(python(code), given=b"x" * MUCH)
    assert (done.returncode, len(done.stdout), len(done.stderr)) == (0, MUCH, MUCH)


@posix
@pytest.mark.parametrize("stream", ["stdout", "stderr"])
def test_a_terminal_is_read_while_the_program_runs(stream: str) -> None:
    code = f"import sys; print(sys.{stream}.isatty(), {MUCH} * 'x', file=sys.{stream})"
    done = children.run(python(code), terminal=stream)
    assert getattr(done, stream) == b"True " + MUCH * b"x" + b"\r\n"


def test_there_is_no_standard_input_to_wait_for() -> None:
    assert children.run(python("print(repr(input()))"), text=True).stderr.endswith(
        "EOFError: EOF when reading a line\n"
    )


def test_failures_are_told() -> None:
    assert children.run(python("raise SystemExit(3)")).returncode == 3
    with pytest.raises(subprocess.CalledProcessError):
        children.run(python("raise SystemExit(3)"), check=True)
    with pytest.raises(FileNotFoundError):
        children.run(["/no/such/program"], terminal="stderr" if os.name == "posix" else "")


@posix
def test_all_of_a_group_are_killed_when_their_time_is_over(tmp_path: Path) -> None:
    """The child has ended; its own child, which nobody waits for, holds the pipe."""
    beat = "while True: print('.', end='', flush=True); time.sleep(0.02)"
    script = tmp_path / "beat.py"
    script.write_text(f"import time\n{beat}\n")
    code = (
        f"import subprocess, sys; subprocess.Popen([sys.executable, '-I', '-S', {str(script)!r}])"
    )
    start = time.monotonic()
    with pytest.raises(subprocess.TimeoutExpired) as caught:
        children.run(python(code), seconds=2)
    assert time.monotonic() - start < 30
    assert caught.value.output.startswith(b".")


@posix
def test_what_still_runs_ends_with_the_block() -> None:
    with children.started(
        python("import time; print('here', flush=True); time.sleep(99)")
    ) as child:
        children.wait_for(lambda: child.written["stdout"] == b"here\n")
    assert child.process.returncode == -9


def test_nothing_comes_of_it() -> None:
    with pytest.raises(TimeoutError, match=r"within 0\.05 seconds"):
        children.wait_for(lambda: False, seconds=0.05)
