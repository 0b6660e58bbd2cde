"""Work on tasks one after the other, and the parts that all engines share."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from typing import TypeAlias

from deltamesh.batch._manifest import Record
from deltamesh.batch._plan import Task
from deltamesh_formats.errors import DeltameshError

Work: TypeAlias = Callable[[Task], Record]
Begin: TypeAlias = Callable[[list[Task]], None]
Outcome: TypeAlias = tuple[Task, Record | Exception]


class WorkerError(DeltameshError):
    """A worker could not do its work: it was killed, it crashed, or it raised."""


def ignore(tasks: list[Task]) -> None:
    """Do nothing when tasks begin."""


def attempted(work: Work, task: Task) -> Record | Exception:
    """Return what the work returns or, since no task may stop the others, what it raises."""
    try:
        return work(task)
    except Exception as error:  # not itself: it may not survive the way to another process
        return WorkerError(f"{type(error).__name__}: {error}")


def run_here(tasks: Iterable[Task], work: Work, *, begin: Begin = ignore) -> Generator[Outcome]:
    """Work on one task after the other, in this process.

    Parameters
    ----------
    tasks : iterable of Task
    work : callable
        Called with each task; returns a record.
    begin : callable
        Called with a list of the task that comes next.

    Yields
    ------
    task, outcome : Task, dict or Exception
    """
    for task in tasks:
        begin([task])
        yield task, attempted(work, task)
