"""Run of `deltamesh batch`: it settles files that need no work, works on the rest, and records all.

The manifest has a line for each step, so that an interrupted run can be resumed.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import click

from deltamesh.batch import (
    Append,
    Record,
    Task,
    begun_record,
    open_manifest,
    read_records,
    record_key,
)
from deltamesh_cli.batch.plan import PlannedFile, settled_record
from deltamesh_cli.batch.report import Totals, displayed_files, names_of, report_record
from deltamesh_cli.batch.settings import ExistingFiles, Verbosity
from deltamesh_cli.batch.work import Job, failure_record
from deltamesh_cli.failures import Failure, attempt
from deltamesh_cli.output import message, print_json
from deltamesh_cli.progress import on_terminal
from deltamesh_cli.signals import Stopped
from deltamesh_formats.places import exists, make_folder, parent
from deltamesh_formats.temporaries import remove_temporaries

if TYPE_CHECKING:
    from deltamesh_cli.batch.engines import Engine

Records: TypeAlias = dict[tuple[str, str], Record]
# Called with each record, and whether an earlier run made it.
Report: TypeAlias = Callable[[Record, bool], None]


def run_batch(
    planned: list[PlannedFile],
    job: Job,
    engine: Engine,
    existing: ExistingFiles,
    verbosity: Verbosity,
    listen: Report = lambda record, before: None,
) -> int:
    """Work on all planned files, report them, and return the exit code.

    `listen` gets each record, and whether an earlier run made it.

    Raises
    ------
    Failure
        If the run itself fails: its manifest, its folders, its workers. A failure of a file is in
        the record of that file.
    """
    totals = Totals()

    def report(record: Record, before: bool) -> None:
        totals.add(record, before)
        listen(record, before)
        report_record(record, as_json=verbosity.as_json, quiet=verbosity.quiet or before)

    try:
        with _manifest(existing) as (records, append):
            remaining = _settle(planned, job, records, existing, append, report)
            _work_on(remaining, job, engine, append, report, verbosity)
    except (KeyboardInterrupt, Stopped):
        message(
            f"deltamesh: {totals.count} of {len(planned)} files are done: {_resuming(existing)}"
        )
        raise
    finally:
        _print_totals(totals, verbosity)
    return totals.exit_code


def _resuming(existing: ExistingFiles) -> str:
    """Return how an interrupted run is completed, in words."""
    option = "--skip-existing" if existing.manifest is None else "--resume"
    given = existing.skip_existing if existing.manifest is None else existing.resume
    return f"the same command{'' if given else f' with {option}'} does the others"


def dry_run(
    planned: list[PlannedFile], job: Job, existing: ExistingFiles, verbosity: Verbosity
) -> int:
    """Report the work of a run without writing anything, and return the exit code known so far."""
    totals, records = Totals(), _recorded(existing)
    for one in planned:
        record = _settled(one, job, records, existing)
        if record is None:
            assert isinstance(one, Task)
            record = {"status": "planned", "source": one.source, "target": one.target}
        totals.add(record, before=False)
        report_record(record, as_json=verbosity.as_json, quiet=verbosity.quiet)
        if not verbosity.as_json and "message" not in record:
            names, status = names_of(record), record["status"]
            click.echo(names if status == "planned" else f"{names}: {status}")
    return totals.exit_code


def _recorded(existing: ExistingFiles) -> Records:
    """Return the records of the manifest without changing it."""
    if not (existing.resume and existing.manifest and os.path.exists(existing.manifest)):
        return {}
    with attempt(existing.manifest, "cannot resume"), open(existing.manifest, "rb") as file:
        return {record_key(record): record for record in read_records(file.read())}


def _settled(
    one: PlannedFile, job: Job, records: Records, existing: ExistingFiles
) -> Record | None:
    """Return the record of a planned file that needs no work, or None if it does need work."""
    if not isinstance(one, Task):
        return one
    before = records.get((one.source, one.target))
    return settled_record(
        job, one, before, force=existing.force, skip_existing=existing.skip_existing
    )


@contextmanager
def _manifest(existing: ExistingFiles) -> Iterator[tuple[Records, Append]]:
    """Open the manifest; without one, yield no records and an `append` that does nothing."""
    path = existing.manifest
    if path is None:
        yield {}, lambda records: None
        return
    _make_folder(os.path.dirname(path))
    begin_hint = "--resume goes on with it, -f begins it anew"
    hint = begin_hint if os.path.exists(path) and not existing.resume else ""
    with ExitStack() as stack:
        with attempt(path, "cannot keep a manifest", hint):
            opened = open_manifest(path, resume=existing.resume, force=existing.force)
            records, append = stack.enter_context(opened)

        def append_or_fail(new: Iterable[Record]) -> None:
            with attempt(path, "cannot write"):
                append(new)

        yield records, append_or_fail


def _settle(
    planned: list[PlannedFile],
    job: Job,
    records: Records,
    existing: ExistingFiles,
    append: Append,
    report: Report,
) -> list[Task]:
    """Record the files that need no work, and return the tasks that remain."""
    remaining, new = [], []
    for one in planned:
        record = _settled(one, job, records, existing)
        if record is None:
            assert isinstance(one, Task)
            # An output that exists now may be overwritten; one that appears later may not.
            overwrite = existing.force or exists(one.target)
            remaining.append(replace(one, overwrite=overwrite))
            continue
        before = record is records.get(record_key(record))
        if not before:
            new.append(record)
        report(record, before)
    append(new)
    return remaining


def _work_on(
    tasks: list[Task],
    job: Job,
    engine: Engine,
    append: Append,
    report: Report,
    verbosity: Verbosity,
) -> None:
    """Work on tasks; each is recorded before it begins, and again when it is done."""
    _make_folders(tasks)
    remove_temporaries(task.target for task in tasks)

    def begin(begun: list[Task]) -> None:
        append(begun_record(task.source, task.target) for task in begun)

    display = displayed_files(
        verbosity.show_progress,
        [task.size for task in tasks],
        verbose=verbosity.verbose,
        quiet=verbosity.quiet or (verbosity.as_json and on_terminal(sys.stdout)),
    )
    try:
        with display as advance, closing(engine(job, tasks, begin)) as outcomes:
            for task, outcome in outcomes if tasks else ():
                record = _record(job, task, outcome)
                append([record])
                report(record, False)
                advance(record, task.size)
    finally:
        # Files that are done may have some, too: an earlier worker may have died of them.
        remove_temporaries(task.target for task in tasks)


def _record(job: Job, task: Task, outcome: Record | Exception) -> Record:
    """Return the record of a task, with the file names that the user gave."""
    if isinstance(outcome, Exception):
        remove_temporaries([task.target])
        return failure_record(job, task, Failure(task.source, job.problem, outcome))
    return {**outcome, "source": task.source, "target": task.target}


def _make_folders(tasks: list[Task]) -> None:
    for folder in sorted({parent(task.target) for task in tasks}):
        _make_folder(folder)


def _make_folder(folder: str) -> None:
    with attempt(folder, "cannot create the folder"):
        make_folder(folder)


def _print_totals(totals: Totals, verbosity: Verbosity) -> None:
    if verbosity.as_json:
        print_json({"summary": totals.as_object()})
    elif not verbosity.quiet:
        click.echo(totals.as_text())
