"""Work that the tests give to processes: light, so that a process starts quickly."""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path
from typing import Any

from deltamesh.batch import Task


def task(name: str, need: float = 0.0, size: int = 1) -> Task:
    """A task of that name, whose target is a file of that name."""
    return Task(name, name, size, need)


def tell(task: Task) -> dict[str, Any]:
    """Tell who worked on what, with which threads."""
    return {
        "source": task.source,
        "pid": os.getpid(),
        "threads": os.environ.get("OMP_NUM_THREADS"),
        "numpy": "numpy" in sys.modules,
    }


def obey(task: Task) -> dict[str, Any]:
    """Do what the last part of the name says."""
    order = Path(task.source).name.split("-")[0]
    if order == "hang":
        time.sleep(60)
    elif order == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    elif order == "raise":
        raise LookupError("nothing there")
    elif order == "once":  # dies when it is tried first
        mark = Path(task.target)
        if not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
    elif order == "nap":
        time.sleep(0.1)
    elif order == "beat":
        beat(task)
    return tell(task)


def log_interval(task: Task) -> dict[str, Any]:
    """Tell when the work began and ended, by a clock that all processes share."""
    begin = time.monotonic()
    time.sleep(0.1)
    return {"source": task.source, "begin": begin, "end": time.monotonic()}


def beat(task: Task) -> dict[str, Any]:
    """Append to a file for a minute."""
    with open(task.target, "ab", buffering=0) as file:
        for _ in range(3000):
            file.write(b".")
            time.sleep(0.02)
    return {}


def refuse() -> None:
    """Prepare a process so that it cannot begin."""
    os._exit(7)
