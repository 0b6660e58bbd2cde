"""Progress on standard error: a spinner on a terminal, lines with `-v`."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final, Protocol

import click

from deltamesh._progress import Progress, silent

COMPILING: Final = "compiling kernels (once per installation)"


class _Display(Protocol):
    """A display of the current stage and of the compilation of kernels."""

    def show(self, stage: str, compiling: bool) -> None: ...


class _Lines:
    """A display that prints each stage on its own line when it ends, with its seconds."""

    def __init__(self) -> None:
        self.current: tuple[str, float] | None = None
        self.announced = False

    def show(self, stage: str, compiling: bool) -> None:
        if compiling:
            if not self.announced:
                click.echo(f"deltamesh: {COMPILING}", err=True)
            self.announced = True
        elif self.current is None or self.current[0] != stage:
            self.end()
            self.current = (stage, time.perf_counter())

    def end(self) -> None:
        if self.current is not None:
            name, start = self.current
            click.echo(f"deltamesh: {name}: {time.perf_counter() - start:.2f} s", err=True)
            self.current = None


@contextmanager
def _lines() -> Iterator[_Display]:
    display = _Lines()
    yield display
    display.end()


@contextmanager
def _spinner() -> Iterator[_Display]:
    # Imported here: rich takes 0.1 s, and most runs have no terminal to draw on.
    from rich.console import Console
    from rich.status import Status

    class Spinner:
        def __init__(self, status: Status) -> None:
            self.status = status

        def show(self, stage: str, compiling: bool) -> None:
            self.status.update(f"{stage}: {COMPILING}" if compiling else stage)

    with Console(stderr=True).status("") as status:
        yield Spinner(status)


def use_lines(show: bool | None, *, verbose: bool) -> bool:
    """Return whether progress is printed in lines: with `-v`, or on request without a terminal."""
    return verbose or (bool(show) and not _is_terminal())


def use_drawing(show: bool | None, *, quiet: bool) -> bool:
    """Return whether progress is drawn: on request, or on a terminal unless `-q` is given."""
    return bool(show) or (show is None and _is_terminal() and not quiet)


def _is_terminal() -> bool:
    return sys.stderr is not None and sys.stderr.isatty()


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
        with _lines() as display, _stages(display) as progress:
            yield progress
    elif use_drawing(show, quiet=quiet):
        with _spinner() as display, _stages(display) as progress:
            yield progress
    else:
        yield silent


@contextmanager
def _stages(display: _Display) -> Iterator[Progress]:
    """Pass stages to a display, and announce when numba compiles a kernel.

    numba reports a compilation when its cache has no machine code (numba manual, "Event API"),
    which is more reliable than a look into the cache folder. Kernels that call others nest.
    """
    current, depth = "starting", 0

    def progress(stage: str) -> None:
        nonlocal current
        current = stage
        display.show(current, depth > 0)

    def compiling(change: int) -> None:
        nonlocal depth
        depth += change
        display.show(current, depth > 0)

    progress(current)
    from numba.core import event  # 0.7 s, but every command with stages needs numba anyway

    class Listener(event.Listener):
        def on_start(self, event: object) -> None:
            compiling(+1)

        def on_end(self, event: object) -> None:
            compiling(-1)

    with event.install_listener("numba:compile", Listener()):
        yield progress
