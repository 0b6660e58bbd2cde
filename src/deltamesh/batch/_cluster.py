"""Work on tasks on a cluster of Dask distributed; paths travel, and meshes do not.

M. Rocklin, "Dask: Parallel Computation with Blocked algorithms and Task Scheduling", SciPy 2015.
The scheduler gives the task of a worker that has died to another one, and gives it up when as many
workers have died of it as its setting `distributed.scheduler.allowed-failures` allows.
"""

from __future__ import annotations

import logging
import os
import signal
import time
from collections.abc import Generator, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any, Final

from deltamesh._version import __version__
from deltamesh.batch._manifest import Record
from deltamesh.batch._plan import Task
from deltamesh.batch._schedule import groups
from deltamesh.batch._serial import Begin, Outcome, Work, WorkerError, attempted, ignore
from deltamesh_formats.places import absolute

# A message of the scheduler takes milliseconds, and a small file takes not many more.
GROUP_BYTES: Final = 1 << 20
GROUP_FILES: Final = 16

# Time limits for a scheduler and for its first worker, in seconds.
PATIENCE: Final = 60


@contextmanager
def dask_client(address: str | None, workers: int = 0) -> Iterator[Any]:
    """Connect to the scheduler at an address, or start one here with workers of its own.

    Parameters
    ----------
    address : str or None
        Such as "tcp://node1:8786", or the name of the file that `dask scheduler --scheduler-file`
        writes; None for a cluster of this machine.
    workers : int
        How many processes that has, of one thread each.

    Raises
    ------
    WorkerError
        If distributed is not installed, there is no worker, or one has another version of deltamesh
        or none.
    OSError
        If there is no scheduler at that address.
    """
    try:
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise WorkerError("distributed is missing: pip install 'deltamesh[cluster]'") from error
    if address is not None:
        with Client(**_where(address), set_as_default=False) as client:
            _check_workers(client)
            yield client
        return
    with (
        LocalCluster(
            workers, threads_per_worker=1, dashboard_address=None, silence_logs=logging.ERROR
        ) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        client.run(_ignore_ctrl_c)
        yield client


def _ignore_ctrl_c() -> None:
    """Leave Ctrl-C to who has started the cluster, and ends it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _where(address: str) -> dict[str, str]:
    """Return the scheduler as `Client` takes it, which would wait for a file for ever."""
    if "://" in address:
        return {"address": address}
    deadline = time.monotonic() + PATIENCE
    while not os.path.exists(address):
        if time.monotonic() > deadline:
            raise WorkerError(f"no scheduler has written this file in {PATIENCE} seconds")
        time.sleep(0.1)
    return {"scheduler_file": address}


def _check_workers(client: Any) -> None:
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        raise WorkerError(f"no worker of the cluster has come in {PATIENCE} seconds") from None
    for worker, version in client.run(_version, on_error="return").items():
        if isinstance(version, OSError):  # it has died meanwhile
            continue
        if isinstance(version, Exception):
            raise WorkerError(f"deltamesh does not run on {worker}: {version}")
        if version != __version__:
            raise WorkerError(f"{worker} has deltamesh {version}, not {__version__}")


def _version() -> str:
    return __version__


def run_on_dask(
    client: Any,
    tasks: Iterable[Task],
    work: Work,
    *,
    size: int = GROUP_BYTES,
    count: int = GROUP_FILES,
    begin: Begin = ignore,
) -> Generator[Outcome]:
    """Work on tasks on the workers of a cluster, which see the same files by absolute names.

    Small files are grouped. The files of a group of which workers have died are tried once more at
    the end, one after the other, so that one is given up and not all. When the iterator is closed,
    what has not begun is cancelled.

    Parameters
    ----------
    client : distributed.Client
    tasks : iterable of Task
    work : callable
        As of `run_here`; it and what it returns must survive pickling.
    size, count : int
        The most bytes of input, and files, of a group.
    begin : callable
        Called with a list of all tasks.

    Yields
    ------
    task, outcome : Task, dict or Exception
        In the order in which groups are done; `WorkerError` for a task of which workers have died.

    Raises
    ------
    WorkerError
        If the scheduler has gone.
    """
    from distributed import as_completed

    listed, lost = list(tasks), []
    begin(listed)
    running = {_submit(client, work, group): group for group in groups(listed, size, count)}
    try:
        for future in as_completed(list(running), loop=client.loop):
            group = running.pop(future)
            outcomes = _outcomes(future)
            if isinstance(outcomes, list):
                yield from zip(group, outcomes, strict=True)
            else:
                lost += group
        # The scheduler blames whatever waited at a worker for its death. With nothing else
        # about, the blame is right.
        for task in lost:
            future = _submit(client, work, [task])
            running[future] = [task]
            outcomes = _outcomes(future)
            del running[future]
            yield task, outcomes[0] if isinstance(outcomes, list) else outcomes
    finally:
        client.cancel(list(running))


def _submit(client: Any, work: Work, group: list[Task]) -> Any:
    # Not pure: the same task has to be done again in a second run.
    return client.submit(_work_on, work, [_absolute(task) for task in group], pure=False)


def _absolute(task: Task) -> Task:
    """Return the task as another process in another folder has to see it."""
    source, target = absolute(task.source), absolute(task.target)
    return replace(task, source=source, target=target)


def _work_on(work: Work, group: list[Task]) -> list[Record | Exception]:
    return [attempted(work, task) for task in group]


def _outcomes(future: Any) -> list[Record | Exception] | WorkerError:
    """Wait for what became of a group, or for why nobody knows."""
    from distributed import KilledWorker

    try:
        outcomes: list[Record | Exception] = future.result()
    except KilledWorker:
        return WorkerError("the workers that tried it died")
    except Exception as error:
        if future.client.status != "running":
            raise WorkerError("the scheduler has gone") from error
        return WorkerError(f"the cluster gave it up: {type(error).__name__}: {error}")
    return outcomes
