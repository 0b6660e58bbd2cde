"""Ctrl-C, SIGTERM and SIGHUP: the program stops soon and leaves no half-written file.

Python runs the handler of a signal on the main thread between two byte codes. A sparse
factorization is one call into machine code that takes seconds. Therefore the codec runs on a second
thread (the compiled core and the solvers release the interpreter lock), and the main thread is
free to notice Ctrl-C.

SIGTERM and SIGHUP end a process at once, which is right as long as there is nothing to clean up.
Only while a temporary file is open do they become an exception.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Final, NoReturn, TypeVar

_Result = TypeVar("_Result")

# Windows checks for Ctrl-C this often while it waits; elsewhere a signal ends the wait.
_POLL_SECONDS: Final = 0.1

_ENDING: Final = tuple(
    getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)
)


class Stopped(BaseException):
    """A signal asked this process to end; no `Exception`, because nothing should swallow it."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def interruptible(function: Callable[[], _Result]) -> _Result:
    """Return `function()`, computed on a second thread; Ctrl-C raises `KeyboardInterrupt` here.

    The abandoned thread is a daemon, and `deltamesh_cli.program` ends the process without waiting
    for it.
    """
    results: list[_Result] = []
    errors: list[BaseException] = []

    def work() -> None:
        try:
            results.append(function())
        except BaseException as error:
            errors.append(error)

    thread = threading.Thread(target=work, name="deltamesh", daemon=True)
    thread.start()
    while thread.is_alive():
        thread.join(_POLL_SECONDS)
    if errors:
        raise errors[0]
    return results[0]


def _stop(number: int, frame: FrameType | None) -> NoReturn:
    raise Stopped(number)


@contextmanager
def stopping_cleanly() -> Iterator[None]:
    """Make SIGTERM and SIGHUP raise `Stopped` inside, so that `finally` clauses run.

    A signal that the environment of the process ignores (`nohup`) stays ignored. Handlers can be
    set on the main thread only; on any other thread this does nothing.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    previous = {number: signal.getsignal(number) for number in _ENDING}
    try:
        for number, handler in previous.items():
            if handler is not signal.SIG_IGN:
                signal.signal(number, _stop)
        yield
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)
