"""What the program is busy with, on standard error: a spinner on a terminal, lines with `-v`."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final, Protocol

import click

Stage = Callable[[str], None]

COMPILING: Final = "compiling kernels (once per installation)"


class _Display(Protocol):
    """Something that shows the stage, and whether kernels are being compiled."""

    def show(self, stage: str, compiling: bool) -> None: ...


class _Lines:
    """Each stage in a line of its own, told at its end with its seconds."""

    def __init__(self) -> None:
        self.begun: tuple[str, float] | None = None
        self.told = False

    def show(self, stage: str, compiling: bool) -> None:
        if compiling:
            if not self.told:
                click.echo(f"deltamesh: {COMPILING}", err=True)
            self.told = True
        elif self.begun is None or self.begun[0] != stage:
            self.end()
            self.begun = (stage, time.perf_counter())

    def end(self) -> None:
        if self.begun is not None:
            name, start = self.begun
            click.echo(f"deltamesh: {name}: {time.perf_counter() - start:.2f} s", err=True)
            self.begun = None


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


@contextmanager
def progress(wanted: bool | None, *, verbose: bool = False, quiet: bool = False) -> Iterator[Stage]:
    """Give a function that tells the name of the stage that begins.

    Parameters
    ----------
    wanted : bool or None
        `--progress` or `--no-progress`; None for a spinner if standard error is a terminal.
    verbose : bool
        Tell each stage in a line of its own, with the seconds it took.
    quiet : bool
        Tell nothing, unless `wanted` is True.
    """
    terminal = sys.stderr is not None and sys.stderr.isatty()
    if verbose or (wanted and not terminal):
        with _lines() as display, _stages(display) as stage:
            yield stage
    elif wanted or (wanted is None and terminal and not quiet):
        with _spinner() as display, _stages(display) as stage:
            yield stage
    else:
        yield lambda name: None


@contextmanager
def _stages(display: _Display) -> Iterator[Stage]:
    """Pass stages on to a display, and tell when numba compiles a kernel.

    numba announces a compilation when its cache has no machine code (numba manual, "Event API"),
    which is more exact than a look into the cache folder. Kernels that call others nest.
    """
    now, depth = "starting", 0

    def stage(name: str) -> None:
        nonlocal now
        now = name
        display.show(now, depth > 0)

    def compiling(change: int) -> None:
        nonlocal depth
        depth += change
        display.show(now, depth > 0)

    stage(now)
    from numba.core import event  # 0.7 s, which whatever has stages will need anyway

    class Listener(event.Listener):
        def on_start(self, event: object) -> None:
            compiling(+1)

        def on_end(self, event: object) -> None:
            compiling(-1)

    with event.install_listener("numba:compile", Listener()):
        yield stage
