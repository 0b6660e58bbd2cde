"""Engines of `deltamesh batch`: the work is done in this process, in others, or on a cluster."""

from __future__ import annotations

import logging
from collections.abc import Callable, Generator
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

from deltamesh.batch import Task
from deltamesh_cli.batch.work import Job, prepare, work
from deltamesh_cli.failures import attempt

if TYPE_CHECKING:
    from deltamesh.batch import Begin, Outcome

    Engine: TypeAlias = Callable[[Job, list[Task], Begin], Generator[Outcome]]


def here(job: Job, tasks: list[Task], begin: Begin) -> Generator[Outcome]:
    """Work in this process."""
    from deltamesh.batch import run_here

    return run_here(tasks, partial(work, job), begin=begin)


def in_processes(jobs: int, memory: float, timeout: float) -> Engine:
    """Return the engine that works in processes of this machine.

    Parameters
    ----------
    jobs : int
        Number of processes.
    memory : float
        Bytes that all of them may take together, by estimate.
    timeout : float
        Seconds that one file may take.
    """

    def engine(job: Job, tasks: list[Task], begin: Begin) -> Generator[Outcome]:
        from deltamesh.batch import run_in_processes

        with attempt("worker processes", "cannot go on"):
            yield from run_in_processes(
                tasks,
                partial(work, job),
                jobs=jobs,
                memory=memory,
                timeout=timeout,
                prepare=partial(prepare, job),
                begin=begin,
            )

    return engine


def on_dask(address: str | None, workers: int) -> Engine:
    """Return the engine that works on a Dask cluster.

    Parameters
    ----------
    address : str or None
        Address or file of the scheduler; None to start a cluster on this machine.
    workers : int
        Number of processes of the cluster on this machine.
    """

    def engine(job: Job, tasks: list[Task], begin: Begin) -> Generator[Outcome]:
        logging.disable()  # the log of Dask, because failures are reported here
        with attempt(address or "local cluster", "cannot go on"):
            from deltamesh.batch import dask_client, run_on_dask

            with dask_client(address, workers) as client:
                yield from run_on_dask(client, tasks, partial(work, job), begin=begin)

    return engine
