"""Many files: which they are, who works on which when, and a record of what became of each.

What is done with one file is a function of a `Task` that returns a record, a dictionary fit for
JSON. `run_here`, `run_in_processes` and `run_on_dask` (with a `dask_client`) are three ways to call
it on many tasks; each yields (task, record) when a task is done, and (task, exception) where there
is no record. `find` and `check_targets` say which tasks there are, a manifest keeps the records on
disk. `deltamesh batch` is made of these. They are imported when one of them is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from deltamesh.batch.cluster import dask_client, run_on_dask
    from deltamesh.batch.finding import Selection, find
    from deltamesh.batch.manifest import open_manifest, still_done
    from deltamesh.batch.plan import Task, check_targets, flat, mirrored
    from deltamesh.batch.pool import run_in_processes
    from deltamesh.batch.schedule import share
    from deltamesh.batch.serial import WorkerError, run_here

_HOME = {
    "Selection": "finding",
    "Task": "plan",
    "WorkerError": "serial",
    "check_targets": "plan",
    "dask_client": "cluster",
    "find": "finding",
    "flat": "plan",
    "mirrored": "plan",
    "open_manifest": "manifest",
    "run_here": "serial",
    "run_in_processes": "pool",
    "run_on_dask": "cluster",
    "share": "schedule",
    "still_done": "manifest",
}

__all__ = [
    "Selection",
    "Task",
    "WorkerError",
    "check_targets",
    "dask_client",
    "find",
    "flat",
    "mirrored",
    "open_manifest",
    "run_here",
    "run_in_processes",
    "run_on_dask",
    "share",
    "still_done",
]


def __getattr__(name: str) -> Any:
    """Import what was asked for."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return __all__
