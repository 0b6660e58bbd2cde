"""Work on tasks in processes of this machine, each of which may be killed.

The pools of concurrent.futures and loky break when one worker dies, so does that of Pebble when
the worker was idle, and only Pebble's can kill a task. Here each worker has a pipe of its own and
shares nothing, no lock and no queue: whenever and however it ends, one file is concerned.
"""

from __future__ import annotations

import math
import multiprocessing
import os
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import islice
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Final

from deltamesh.batch._plan import Task
from deltamesh.batch._schedule import startable
from deltamesh.batch._serial import Begin, Outcome, Work, WorkerError, attempted, ignore
from deltamesh_formats.arguments import require_limit, require_whole

# A worker is one of many: none may start threads of its own for every core.
ONE_THREAD: Final = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "RAYON_NUM_THREADS": "1",
    "VECLIB_MAXIMUM_THREADS": "1",
}

# Workers that may die before they are ready, until every other is expected to die as well.
_FALSE_STARTS: Final = 4


def run_in_processes(
    tasks: Iterable[Task],
    work: Work,
    *,
    jobs: int,
    memory: float = math.inf,
    timeout: float = math.inf,
    prepare: Callable[[], None] | None = None,
    begin: Begin = ignore,
) -> Generator[Outcome]:
    """Work on tasks in `jobs` processes, each with one thread for linear algebra.

    Tasks start in their order. When a worker dies, its task is tried once more with nothing beside
    it, since what kills workers is too little memory as a rule; then it is given up. When the
    iterator is closed, all workers are killed; when this process is killed, they end themselves.

    Parameters
    ----------
    tasks : iterable of Task
    work : callable
        As of `run_here`; it and what it returns must survive pickling.
    jobs : int
        How many processes.
    memory : float
        How much the running tasks may need together, in bytes. One that needs more runs alone.
    timeout : float
        Seconds after which a task is given up and its process killed.
    prepare : callable, optional
        Called in each process before its first task, on nobody's time.
    begin : callable
        Called with a list of the task that starts next.

    Yields
    ------
    task, outcome : Task, dict or Exception
        `TimeoutError`, or `WorkerError` when the process died.

    Raises
    ------
    WorkerError
        If processes die before they begin.
    OptionError
        If there are no jobs, or a limit is no number.
    """
    require_whole("jobs", jobs, 1)
    require_limit("memory", memory)
    require_limit("timeout", timeout)
    pool = _Pool(deque(tasks), jobs, memory, timeout, work, prepare)
    try:
        while pool.waiting or pool.running():
            pool.start(begin)
            yield from pool.listen()
    finally:
        pool.end()


@dataclass
class _Worker:
    """A process, our end of its pipe, and what it is doing."""

    process: BaseProcess
    pipe: Connection
    ready: bool = False
    task: Task | None = None
    deadline: float = math.inf

    def end(self) -> int | None:
        """End the process, whatever it is doing, and return its exit code."""
        self.process.kill()
        self.process.join()
        self.pipe.close()
        return self.process.exitcode


@dataclass
class _Pool:
    """The tasks that wait, and the workers with those that run."""

    waiting: deque[Task]
    jobs: int
    memory: float
    timeout: float
    work: Work
    prepare: Callable[[], None] | None
    workers: list[_Worker] = field(default_factory=list)
    tried: set[Task] = field(default_factory=set)
    false_starts: int = 0

    def running(self) -> list[Task]:
        """Return the tasks that run."""
        return [worker.task for worker in self.workers if worker.task is not None]

    def need(self, task: Task) -> float:
        """Return the memory for a task; one that a worker has died of gets all."""
        return math.inf if task in self.tried else task.need

    def start(self, begin: Begin) -> None:
        """Start as many processes and tasks as may run now."""
        running = self.running()
        while len(self.workers) < min(self.jobs, len(running) + len(self.waiting)):
            self.workers.append(_started(self.work, self.prepare))
        next_ones = [self.need(task) for task in islice(self.waiting, self.jobs)]
        count = startable(next_ones, [self.need(task) for task in running], self.jobs, self.memory)
        idle = [worker for worker in self.workers if worker.ready and worker.task is None]
        for worker in idle[:count]:
            worker.task = self.waiting.popleft()
            begin([worker.task])
            worker.deadline = time.monotonic() + self.timeout
            # A worker that has died meanwhile is noticed when it is listened to.
            with suppress(OSError):
                worker.pipe.send(worker.task)

    def listen(self) -> Generator[Outcome]:
        """Wait until something happens, and yield what became of tasks."""
        patience = min(worker.deadline for worker in self.workers) - time.monotonic()
        pipes = [worker.pipe for worker in self.workers]
        heard = wait(pipes, None if patience == math.inf else max(patience, 0))
        for worker in list(self.workers):
            if worker.pipe in heard:
                yield from self.receive(worker)
            elif time.monotonic() >= worker.deadline:
                self.dismiss(worker)
                assert worker.task is not None
                yield worker.task, TimeoutError(f"it took more than {self.timeout:g} seconds")

    def receive(self, worker: _Worker) -> Generator[Outcome]:
        """Take what a worker has sent: that it is ready, an outcome, or its end."""
        try:
            outcome = worker.pipe.recv()
        except (EOFError, OSError):
            yield from self.bury(worker)
            return
        task, worker.task, worker.ready, worker.deadline = worker.task, None, True, math.inf
        if task is not None:
            yield task, outcome

    def bury(self, worker: _Worker) -> Generator[Outcome]:
        """Let the task of a worker that has died wait once more, or give it up."""
        death = f"its process died ({_cause(self.dismiss(worker))})"
        if worker.task is None:
            self.false_starts += not worker.ready
            if self.false_starts == _FALSE_STARTS:
                raise WorkerError(f"a worker could not begin: {death}")
        elif worker.task in self.tried:
            yield worker.task, WorkerError(f"{death}, twice")
        else:
            self.tried.add(worker.task)
            self.waiting.appendleft(worker.task)

    def dismiss(self, worker: _Worker) -> int | None:
        """End a worker and forget it; another one will be started in its place."""
        self.workers.remove(worker)
        return worker.end()

    def end(self) -> None:
        """Kill all workers."""
        for worker in self.workers:
            worker.end()


def _cause(exit_code: int | None) -> str:
    if exit_code is not None and exit_code < 0:
        with suppress(ValueError):
            return signal.Signals(-exit_code).name
    return f"exit code {exit_code}"


def _started(work: Work, prepare: Callable[[], None] | None) -> _Worker:
    """Start a worker: by spawn, since a fork would inherit locks that threads of ours may hold."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_serve, args=(theirs, work, prepare), daemon=True)
    process.start()
    theirs.close()
    return _Worker(process, ours)


def _serve(pipe: Connection, work: Work, prepare: Callable[[], None] | None) -> None:
    """Work on what comes through the pipe until nothing comes any more: the life of a worker."""
    os.environ.update(ONE_THREAD)  # before anything that reads it is imported
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for who started us, and ends us
    threading.Thread(target=_end_with_parent, daemon=True).start()
    if prepare is not None:
        prepare()
    pipe.send(None)
    while True:
        try:
            task = pipe.recv()
        except EOFError:
            return
        pipe.send(attempted(work, task))


def _end_with_parent() -> None:
    """Wait for the end of the process that has started this one, and end with it."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
