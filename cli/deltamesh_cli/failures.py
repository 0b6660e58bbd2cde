"""What is said when something fails, and the exit code of each cause: both are decided only here.

A command does its work inside `attempt`, which turns whatever goes wrong into a `Failure`: the
file, what failed, why, and what to try. `each` runs a command over its files, reports the failures
and goes on; the exit code is the worst one.
"""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Final, TypeVar

import click

from deltamesh_cli.output import print_json, shown
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
# Plus the number of the signal, as shells count: 130 is Ctrl-C.
SIGNALLED: Final = 128

EXIT_CODES: Final = """\
Exit codes:
  0    done
  1    a file failed: unreadable, not a mesh, exists already, no solution
  2    usage: an unknown option, a bad value, a missing argument
  3    the input is corrupt, or refused for needing more than the limits
  4    the quality asked for cannot be met; bench --check found growth
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
class Settings:
    """What holds for a whole run, whichever the command: the object of the click context."""

    debug: bool = False


class Failure(Exception):  # noqa: N818, a report to the user rather than an error of the library
    """A file that could not be processed.

    Parameters
    ----------
    file : str
        The name as the user gave it; "-" for standard input or output.
    what : str
        What failed, such as "cannot decode".
    error : BaseException
        Why.
    hint : str
        What to try; empty for whatever is known about this kind of error.
    """

    def __init__(self, file: str, what: str, error: BaseException, hint: str = "") -> None:
        super().__init__(file, what, error)
        self.file, self.what, self.error = file, what, error
        self.code = next((c for kind, c in _CODES.items() if isinstance(error, kind)), FAILED)
        self.hint = hint or next((h for kind, h in _HINTS.items() if isinstance(error, kind)), "")
        if not _foreseen(error):
            self.hint = _BUG

    @property
    def why(self) -> str:
        """The reason, without the file name that the reader of mesh files begins with."""
        return reason(self.error).removeprefix(f"{self.file}: ").removeprefix("<stream>: ")

    def __str__(self) -> str:
        """Return the whole message, in one line."""
        text = f"{shown(self.file)}: {self.what}: {self.why}"
        return f"{text} ({self.hint})" if self.hint else text


def _foreseen(error: BaseException) -> bool:
    return isinstance(error, DeltameshError | OSError | MemoryError | RecursionError)


def reason(error: BaseException) -> str:
    """Return why something failed, in one line."""
    if isinstance(error, MemoryError):
        return "not enough memory"
    if isinstance(error, RecursionError):
        return "it is nested too deeply"
    if isinstance(error, OSError) and error.strerror:
        return error.strerror[:1].lower() + error.strerror[1:]
    text = " ".join(str(error).split())
    return text if _foreseen(error) else f"{type(error).__name__}: {text}"


@contextmanager
def attempt(file: str, what: str, hint: str = "") -> Iterator[None]:
    """Turn every exception inside into a `Failure` of `file`, except those that concern the run.

    These are a `Failure` already told, a usage error, and the reader of our output having gone.
    """
    try:
        yield
    except (Failure, click.ClickException, click.exceptions.Exit, BrokenPipeError):
        raise
    except Exception as error:
        raise Failure(file, what, error, hint) from error


def tell_unforeseen(error: Exception, settings: Settings) -> None:
    """Tell an error that no file can be blamed for: printing has failed, or it is a bug.

    All that reads or writes a file is inside an `attempt`, and what a descriptor raises has no file
    name: that one is standard output, where the disk is full for example.
    """
    printing = isinstance(error, OSError) and error.errno is not None and error.filename is None
    why = reason(error)
    told = f"standard output: cannot write: {why}" if printing else f"{why} ({_BUG})"
    with suppress(OSError):  # standard error may be what takes no more
        if settings.debug:
            traceback.print_exception(error)
        click.echo(f"deltamesh: {told}", err=True)


def report(failure: Failure) -> None:
    """Tell a failure on standard error, with the traceback when `--debug` asks for it."""
    if click.get_current_context().ensure_object(Settings).debug:
        traceback.print_exception(failure.error)
    click.echo(f"deltamesh: {failure}", err=True)


def as_object(failure: Failure) -> dict[str, object]:
    """Return a failure for `--json`."""
    return {
        "file": failure.file,
        "error": {
            "kind": type(failure.error).__name__,
            "message": f"{failure.what}: {failure.why}",
            "offset": getattr(failure.error, "offset", None),
        },
        "exit_code": failure.code,
    }


def tried(items: Iterable[_Item], action: Callable[[_Item], object], *, as_json: bool) -> int:
    """Run `action` on every item, whatever happens to the others, and return the worst exit code.

    With `as_json` what failed has its own object on standard output, so that whoever reads that
    finds one object for each item.
    """
    worst = DONE
    for item in items:
        try:
            action(item)
        except Failure as failure:
            report(failure)
            if as_json:
                print_json(as_object(failure))
            worst = max(worst, failure.code)
    return worst


def each(files: Iterable[str], action: Callable[[str], object], *, as_json: bool) -> None:
    """Run `action` on every file as `tried` does, and exit with the worst code."""
    click.get_current_context().exit(tried(files, action, as_json=as_json))
