"""Work on several processes."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import Any, TypeVar

import click

Task = TypeVar("Task")
Result = TypeVar("Result")


def each(function: Callable[[Task], Result], tasks: Iterable[Task], jobs: int) -> Iterator[Result]:
    """Yield the function's results in order; the function must be one of a module."""
    if jobs == 1:
        yield from map(function, tasks)
        return
    # spawn is what every platform has; a forked child could inherit a lock of the solver's threads.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context) as pool:
        try:
            yield from pool.map(function, tasks)
        finally:
            pool.shutdown(cancel_futures=True)


def jobs(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option `--jobs`."""
    return click.option(
        "-j",
        "--jobs",
        type=click.IntRange(1),
        default=2,
        show_default=True,
        help="Work on so many processes.",
    )(command)
