"""Many files: which they are, who works on which when, and a record of what became of each.

What is done with one file is a function of a `Task` that returns a record, a dictionary fit for
JSON. `run_here`, `run_in_processes` and `run_on_dask` (of `deltamesh.batch.cluster`) are three
ways to call it on many tasks; each yields (task, record) when a task is done, and (task, exception)
where there is no record. `find` and `plan` say which tasks there are, `manifest` keeps the records
on disk. `deltamesh batch` is made of these.
"""

from __future__ import annotations

from deltamesh.batch.find import Selection, find
from deltamesh.batch.manifest import open_manifest, still_done
from deltamesh.batch.plan import Task, check_targets, flat, mirrored
from deltamesh.batch.pool import WorkerError, run_here, run_in_processes
from deltamesh.batch.schedule import share

__all__ = [
    "Selection",
    "Task",
    "WorkerError",
    "check_targets",
    "find",
    "flat",
    "mirrored",
    "open_manifest",
    "run_here",
    "run_in_processes",
    "share",
    "still_done",
]
