"""Child processes of the tests: their output is read while they run, and none outlives its time.

A program stops as soon as a pipe or a terminal that nobody reads is full. Whoever reads it only
after the program has ended would wait for ever.
"""

from __future__ import annotations

import os
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any, Final

# The machine may have much else to do. The time limit of a test, in pyproject.toml, is a larger
# one: this one says which program it was.
SECONDS: Final = 240.0


class Child:
    """A program that runs, with what it has written so far.

    Attributes
    ----------
    process : subprocess.Popen
    written : dict of str to bytearray
        By "stdout" and "stderr", and by the stream that is a terminal.
    """

    def __init__(self, process: subprocess.Popen[bytes]) -> None:
        self.process = process
        self.written = {"stdout": bytearray(), "stderr": bytearray()}
        self.readers: list[threading.Thread] = []

    def read(self, stream: str, descriptor: int) -> None:
        """Read a descriptor from now on, in a thread, to its end."""
        into = self.written.setdefault(stream, bytearray())

        def drain() -> None:
            # A terminal ends with an error (Linux), all else with nothing.
            with suppress(OSError):
                while data := os.read(descriptor, 1 << 16):
                    into.extend(data)

        self.readers.append(threading.Thread(target=drain, daemon=True))
        self.readers[-1].start()

    def finish(self, given: bytes = b"") -> subprocess.CompletedProcess[bytes]:
        """Give it its standard input; wait for its end and for that of all who write beside it."""
        if self.process.stdin is not None:
            with suppress(BrokenPipeError), self.process.stdin as stream:
                stream.write(given)
        for reader in self.readers:
            reader.join()
        code = self.process.wait()
        out, err = (bytes(self.written[stream]) for stream in ("stdout", "stderr"))
        return subprocess.CompletedProcess(self.process.args, code, out, err)


@contextmanager
def started(
    command: Sequence[Any], *, seconds: float = SECONDS, terminal: str = "", **options: Any
) -> Iterator[Child]:
    """Start a program in a process group of its own, which is killed when the `with` ends.

    Parameters
    ----------
    command : sequence
    seconds : float
        When it is killed at the latest.
    terminal : "stdin", "stdout", "stderr" or ""
        The stream that is a terminal.
    **options
        Those of `subprocess.Popen`. A stream among them is not read.

    Raises
    ------
    subprocess.TimeoutExpired
        If its time was over, whatever else has come of that.
    """
    ours = theirs = -1
    if terminal:
        ours, theirs = os.openpty()
        options[terminal] = theirs
    streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    expired = threading.Event()
    try:
        process = subprocess.Popen(command, start_new_session=True, **(streams | options))
    except BaseException:
        if terminal:
            os.close(ours)
        raise
    finally:
        if terminal:
            os.close(theirs)

    def expire() -> None:
        expired.set()
        kill(process)

    timer = threading.Timer(seconds, expire)
    timer.daemon = True
    timer.start()
    child = Child(process)
    try:
        for stream in ("stdout", "stderr"):
            if stream not in options:
                child.read(stream, getattr(process, stream).fileno())
        if terminal:
            child.read(terminal, ours)
        yield child
    finally:
        timer.cancel()
        kill(process)
        process.wait()
        for reader in child.readers:
            reader.join(10)
            assert not reader.is_alive(), "someone outside of its group still writes"
        for file in (process.stdin, process.stdout, process.stderr):
            if file is not None:
                with suppress(BrokenPipeError):
                    file.close()
        if terminal:
            os.close(ours)
        if expired.is_set():
            out, err = (bytes(child.written[stream]) for stream in ("stdout", "stderr"))
            raise subprocess.TimeoutExpired(process.args, seconds, out, err)


def run(
    command: Sequence[Any],
    *,
    given: bytes | None = None,
    text: bool = False,
    check: bool = False,
    **options: Any,
) -> subprocess.CompletedProcess[Any]:
    """Run a program to its end; its output is that of the result.

    Parameters
    ----------
    command : sequence
    given : bytes, optional
        Its standard input, which is empty without.
    text : bool
        Whether its output is given as text.
    check : bool
        Whether it must not fail.
    **options
        Those of `started`.

    Raises
    ------
    subprocess.TimeoutExpired
        If its time was over.
    subprocess.CalledProcessError
        If it failed and `check` is set.
    """
    if given is not None:
        options["stdin"] = subprocess.PIPE
    with started(command, **options) as child:
        done: subprocess.CompletedProcess[Any] = child.finish(given or b"")
    if text:
        done.stdout, done.stderr = (
            stream.decode().replace(os.linesep, "\n") for stream in (done.stdout, done.stderr)
        )
    if check and done.returncode:
        print(done.stderr)  # what pytest shows of a test that failed
        done.check_returncode()
    return done


def seconds_of(command: Sequence[Any], **options: Any) -> float:
    """The processor's time that a program takes at best, whatever else is at work here."""

    def once() -> float:
        start = os.times()
        run(command, **options)
        end = os.times()
        return end.children_user + end.children_system - start.children_user - start.children_system

    return min(once() for _ in range(5))


def kill(process: subprocess.Popen[bytes]) -> None:
    """Kill a program of `started` and what else is in its group."""
    if hasattr(os, "killpg"):
        # Nobody is left; or, on macOS, only those who have ended.
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()


def wait_for(condition: Callable[[], object], seconds: float = SECONDS) -> None:
    """Wait until a condition holds.

    Raises
    ------
    TimeoutError
        If it does not hold in time.
    """
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError(f"nothing has come of it within {seconds:g} seconds")
        time.sleep(0.005)
