"""Failures: their messages and the exit code of each cause, both decided only here.

A command does its work inside `attempt`, which turns any exception into a `Failure`: the file, the
problem, the reason, and a hint. `process_all` runs a command on all of its files, reports each
failure and continues with the next file; the exit code is the worst one.
"""

from __future__ import annotations

import traceback
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Final, TypeVar

import click

from deltamesh_cli.output import display_name, message, print_json
from deltamesh_formats.errors import (
    DeltameshError,
    FormatError,
    LimitError,
    OptionError,
    SolveError,
    TargetError,
)

_Item = TypeVar("_Item")

DONE: Final = 0
FAILED: Final = 1
USAGE: Final = 2
REFUSED: Final = 3
MISSED: Final = 4
# A shell adds the number of the signal to this: Ctrl-C makes 130.
SIGNALLED: Final = 128

EXIT_CODES: Final = """\
Exit codes:
  0    done
  1    a file failed: unreadable, not a mesh, exists already, no solution
  2    usage: an unknown option, a bad value, a missing argument
  3    the input is corrupt, or decoding it would exceed the limits
  4    the requested quality cannot be met, or bench --check found growth
  130  interrupted by Ctrl-C (143: by SIGTERM)"""

_CODES: Final[dict[type[BaseException], int]] = {
    FormatError: REFUSED,
    LimitError: REFUSED,
    TargetError: MISSED,
    OptionError: USAGE,
}

_HINTS: Final[dict[type[BaseException], str]] = {
    LimitError: "--max-vertices and --memory raise the limits",
    SolveError: "--solver names another solver",
}

_BUG: Final = "a bug in deltamesh: --debug shows where, please report it"


@dataclass
class RunSettings:
    """Settings of a whole run, whatever the command; the object of the click context."""

    debug: bool = False


class Failure(Exception):  # noqa: N818, a report to the user rather than an error of the library
    """A file that could not be processed.

    Parameters
    ----------
    file : str
        The name as the user gave it; "-" for standard input or output.
    problem : str
        The step that failed, such as "cannot decode".
    error : BaseException
        The exception that the step raised.
    hint : str
        A remedy; if empty, the one that is known for this kind of error.
    """

    def __init__(self, file: str, problem: str, error: BaseException, hint: str = "") -> None:
        super().__init__(file, problem, error)
        self.file, self.problem, self.error = file, problem, error
        self.code = next((c for kind, c in _CODES.items() if isinstance(error, kind)), FAILED)
        self.hint = hint or next((h for kind, h in _HINTS.items() if isinstance(error, kind)), "")
        if not _is_expected(error):
            self.hint = _BUG

    @property
    def reason(self) -> str:
        """The reason, without the file name with which messages of the mesh readers begin."""
        return reason_of(self.error).removeprefix(f"{self.file}: ").removeprefix("<stream>: ")

    def __str__(self) -> str:
        """Return the whole message, in one line."""
        text = f"{display_name(self.file)}: {self.problem}: {self.reason}"
        return f"{text} ({self.hint})" if self.hint else text


def _is_expected(error: BaseException) -> bool:
    return isinstance(error, DeltameshError | OSError | MemoryError | RecursionError)


def reason_of(error: BaseException) -> str:
    """Return the reason that an error gives, in one line."""
    if isinstance(error, MemoryError):
        return "not enough memory"
    if isinstance(error, RecursionError):
        return "it is nested too deeply"
    if isinstance(error, OSError) and error.strerror:
        return error.strerror[:1].lower() + error.strerror[1:]
    text = " ".join(str(error).split())
    return text if _is_expected(error) else f"{type(error).__name__}: {text}"


@contextmanager
def attempt(file: str, problem: str, hint: str = "") -> Iterator[None]:
    """Turn every exception inside into a `Failure` of `file`, unless it concerns the whole run.

    A `Failure`, a usage error, and a broken pipe of our output pass through.
    """
    try:
        yield
    except (Failure, click.ClickException, click.exceptions.Exit, BrokenPipeError):
        raise
    except Exception as error:
        raise Failure(file, problem, error, hint) from error


def report_unexpected(error: Exception, settings: RunSettings) -> None:
    """Report an error that belongs to no file: either printing failed, or it is a bug.

    All code that reads or writes a file is inside an `attempt`. An error of a file descriptor has
    no file name, so the descriptor is standard output, for example on a full disk.
    """
    printing = isinstance(error, OSError) and error.errno is not None and error.filename is None
    reason = reason_of(error)
    text = f"standard output: cannot write: {reason}" if printing else f"{reason} ({_BUG})"
    with suppress(OSError):  # standard error may be the stream that cannot be written
        if settings.debug:
            traceback.print_exception(error)
        click.echo(f"deltamesh: {text}", err=True)


def report_failure(failure: Failure) -> None:
    """Report a failure on standard error, with the traceback when `--debug` asks for it."""
    if click.get_current_context().ensure_object(RunSettings).debug:
        traceback.print_exception(failure.error)
    message(f"deltamesh: {failure}")


def failure_object(failure: Failure) -> dict[str, object]:
    """Return a failure for `--json`."""
    return {
        "file": failure.file,
        "error": {
            "kind": type(failure.error).__name__,
            "message": f"{failure.problem}: {failure.reason}",
            "offset": getattr(failure.error, "offset", None),
        },
        "exit_code": failure.code,
    }


def process_all(
    items: Collection[_Item],
    action: Callable[[_Item], object],
    *,
    as_json: bool,
    kind: str = "files",
) -> int:
    """Run `action` on every item, even after failures, and return the worst exit code.

    With `as_json`, each failure is also an object on standard output, so that a program finds one
    object for each item there. After Ctrl-C, a message says how many of several items are done;
    `kind` is what they are called.
    """
    worst = DONE
    for done, item in enumerate(items):
        try:
            action(item)
        except KeyboardInterrupt:
            if len(items) > 1:
                message(f"deltamesh: {done} of {len(items)} {kind} are done")
            raise
        except Failure as failure:
            report_failure(failure)
            if as_json:
                print_json(failure_object(failure))
            worst = max(worst, failure.code)
    return worst


def process_all_and_exit(
    items: Collection[_Item], action: Callable[[_Item], object], *, as_json: bool
) -> None:
    """Run `action` on every item as `process_all` does, and exit with the worst code."""
    click.get_current_context().exit(process_all(items, action, as_json=as_json))
