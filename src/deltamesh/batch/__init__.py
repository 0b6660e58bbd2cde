"""Batches of files: finding them, working on them in parallel, and records of their outcomes.

The work on one file is a function of a `Task` that returns a record, a dictionary fit for JSON.
`run_here`, `run_in_processes` and `run_on_dask` (with a `dask_client`) call it on many tasks; each
yields (task, record) when a task is done, and (task, exception) where there is no record. `find`
and `check_targets` plan the tasks, and a manifest keeps the records on disk. `deltamesh batch` is
made of these. A name is imported when it is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from deltamesh.batch._cluster import dask_client as dask_client, run_on_dask as run_on_dask
    from deltamesh.batch._finding import Selection as Selection, find as find
    from deltamesh.batch._manifest import (
        DONE as DONE,
        FAILED as FAILED,
        SKIPPED as SKIPPED,
        Append as Append,
        ManifestError as ManifestError,
        Record as Record,
        begun_record as begun_record,
        file_state as file_state,
        open_manifest as open_manifest,
        read_records as read_records,
        record_key as record_key,
        still_done as still_done,
        wrote_target as wrote_target,
    )
    from deltamesh.batch._plan import (
        Task as Task,
        check_targets as check_targets,
        flat as flat,
        mirrored as mirrored,
    )
    from deltamesh.batch._pool import run_in_processes as run_in_processes
    from deltamesh.batch._schedule import (
        available_cores as available_cores,
        memory_for_mesh_file as memory_for_mesh_file,
        physical_memory as physical_memory,
        share as share,
    )
    from deltamesh.batch._serial import (
        Begin as Begin,
        Outcome as Outcome,
        Work as Work,
        WorkerError as WorkerError,
        run_here as run_here,
    )
else:
    from deltamesh._lazy import lazy_names

    __getattr__, __dir__, __all__ = lazy_names(
        __name__,
        {
            "deltamesh.batch._cluster": ("dask_client", "run_on_dask"),
            "deltamesh.batch._finding": ("Selection", "find"),
            "deltamesh.batch._manifest": (
                "DONE",
                "FAILED",
                "SKIPPED",
                "Append",
                "ManifestError",
                "Record",
                "begun_record",
                "file_state",
                "open_manifest",
                "read_records",
                "record_key",
                "still_done",
                "wrote_target",
            ),
            "deltamesh.batch._plan": ("Task", "check_targets", "flat", "mirrored"),
            "deltamesh.batch._pool": ("run_in_processes",),
            "deltamesh.batch._schedule": (
                "available_cores",
                "memory_for_mesh_file",
                "physical_memory",
                "share",
            ),
            "deltamesh.batch._serial": ("Begin", "Outcome", "Work", "WorkerError", "run_here"),
        },
    )
