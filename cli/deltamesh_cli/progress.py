"""Progress on standard error: a spinner on a terminal, lines with `-v`."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import TYPE_CHECKING, TextIO

from deltamesh._progress import Progress, silent
from deltamesh_cli.output import message, messages_by

if TYPE_CHECKING:
    from rich.console import Console

_STARTING = "starting"


class _Lines:
    """A display that prints each stage on its own line when it ends, with its seconds."""

    def __init__(self) -> None:
        self.current: tuple[str, float] | None = None

    def show(self, stage: str) -> None:
        if self.current is None or self.current[0] != stage:
            self.end()
            self.current = (stage, time.perf_counter())

    def end(self) -> None:
        if self.current is not None:
            name, start = self.current
            message(f"deltamesh: {name}: {time.perf_counter() - start:.2f} s")
            self.current = None


@contextmanager
def _lines() -> Iterator[Progress]:
    display = _Lines()
    yield display.show
    display.end()


@contextmanager
def _spinner() -> Iterator[Progress]:
    # Imported here: rich takes 0.1 s, and most runs have no terminal to draw on.
    from rich.console import Console

    console = Console(stderr=True)
    with console.status("") as status, messages_above(console):
        yield status.update


def messages_above(console: Console) -> AbstractContextManager[None]:
    """Print messages above what a console draws, as they are."""
    return messages_by(
        lambda text: console.print(text, markup=False, highlight=False, soft_wrap=True)
    )


def use_lines(show: bool | None, *, verbose: bool) -> bool:
    """Return whether progress is printed in lines: with `-v`, or on request without a terminal."""
    return verbose or (bool(show) and not on_terminal(sys.stderr))


def use_drawing(show: bool | None, *, quiet: bool) -> bool:
    """Return whether progress is drawn: on request, or on a terminal unless `-q` is given."""
    return bool(show) or (show is None and on_terminal(sys.stderr) and not quiet)


def on_terminal(stream: TextIO | None) -> bool:
    """Return whether a standard stream, which may be closed, is a terminal."""
    return stream is not None and stream.isatty()


@contextmanager
def displayed_progress(
    show: bool | None, *, verbose: bool = False, quiet: bool = False
) -> Iterator[Progress]:
    """Yield a function that takes the name of each stage as it begins, and displays it.

    Parameters
    ----------
    show : bool or None
        `--progress` or `--no-progress`; None for a spinner if standard error is a terminal.
    verbose : bool
        Print each stage on its own line, with the seconds it took.
    quiet : bool
        Display nothing, unless `show` is True.
    """
    if use_lines(show, verbose=verbose):
        with _lines() as progress:
            progress(_STARTING)
            yield progress
    elif use_drawing(show, quiet=quiet):
        with _spinner() as progress:
            progress(_STARTING)
            yield progress
    else:
        yield silent
