"""A run of `deltamesh batch`: settle what is known, work on the rest, and keep a record of all."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, replace
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
from deltamesh_cli.batch.plan import Item, settled
from deltamesh_cli.batch.report import Tell, Totals, progress, tell_record
from deltamesh_cli.batch.work import Job, failed
from deltamesh_cli.failures import Failure, attempt
from deltamesh_cli.output import print_json, shown
from deltamesh_formats.temporaries import remove_temporaries

if TYPE_CHECKING:
    from deltamesh_cli.batch.engines import Engine

Records: TypeAlias = dict[tuple[str, str], Record]


@dataclass(frozen=True)
class Keeping:
    """What happens to files that exist: outputs, and the manifest.

    Attributes
    ----------
    manifest : str or None
        Name of the manifest, if one is kept.
    resume : bool
        Whether what it says is done is not done again.
    force, skip_existing : bool
        Overwrite outputs, or leave those that exist.
    """

    manifest: str | None = None
    resume: bool = False
    force: bool = False
    skip_existing: bool = False


@dataclass(frozen=True)
class Telling:
    """What is printed: the options that all commands have."""

    as_json: bool = False
    quiet: bool = False
    verbose: bool = False
    show_progress: bool | None = None


def run(items: list[Item], job: Job, engine: Engine, keeping: Keeping, telling: Telling) -> int:
    """Work on everything, tell what became of it, and return the exit code.

    Raises
    ------
    Failure
        Of the run: its manifest, its folders, its workers. What fails with a file is in its record.
    """
    totals = Totals()

    def tell(record: Record, before: bool) -> None:
        totals.add(record, before)
        tell_record(record, as_json=telling.as_json)

    try:
        with _manifest(keeping) as (records, append):
            todo = _settle(items, job, records, keeping, append, tell)
            _work_on(todo, job, engine, append, tell, telling)
    finally:  # after Ctrl-C too
        _sum_up(totals, telling)
    return totals.exit_code


def dry_run(items: list[Item], job: Job, keeping: Keeping, telling: Telling) -> int:
    """Tell what a run would do, write nothing, and return the exit code it has at least."""
    totals, records = Totals(), _known(keeping)
    for item in items:
        record = _known_of(item, job, records, keeping)
        if record is None:
            assert isinstance(item, Task)
            record = {"status": "planned", "source": item.source, "target": item.target}
        totals.add(record, before=False)
        tell_record(record, as_json=telling.as_json)
        if not telling.as_json and "message" not in record:
            names = f"{shown(record['source'])} -> {shown(record['target'])}"
            click.echo(names if record["status"] == "planned" else f"{names}: {record['status']}")
    return totals.exit_code


def _known(keeping: Keeping) -> Records:
    """Return what the manifest says, without touching it."""
    if not (keeping.resume and keeping.manifest and os.path.exists(keeping.manifest)):
        return {}
    with attempt(keeping.manifest, "cannot resume"), open(keeping.manifest, "rb") as file:
        return {record_key(record): record for record in read_records(file.read())}


def _known_of(item: Item, job: Job, records: Records, keeping: Keeping) -> Record | None:
    """Return the record of an item that there is no work on, None for one that there is."""
    if not isinstance(item, Task):
        return item
    before = records.get((item.source, item.target))
    return settled(job, item, before, force=keeping.force, skip_existing=keeping.skip_existing)


@contextmanager
def _manifest(keeping: Keeping) -> Iterator[tuple[Records, Append]]:
    """Open the manifest, or stand in for one."""
    path = keeping.manifest
    if path is None:
        yield {}, lambda records: None
        return
    _make_folder(os.path.dirname(path))
    begin_hint = "--resume goes on with it, -f begins it anew"
    hint = begin_hint if os.path.exists(path) and not keeping.resume else ""
    with ExitStack() as stack:
        with attempt(path, "cannot keep a manifest", hint):
            opened = open_manifest(path, resume=keeping.resume, force=keeping.force)
            records, append = stack.enter_context(opened)

        def keep(new: Iterable[Record]) -> None:
            with attempt(path, "cannot write"):
                append(new)

        yield records, keep


def _settle(
    items: list[Item], job: Job, records: Records, keeping: Keeping, append: Append, tell: Tell
) -> list[Task]:
    """Record what there is no work on, and return the tasks that are left."""
    todo, new = [], []
    for item in items:
        record = _known_of(item, job, records, keeping)
        if record is None:
            assert isinstance(item, Task)
            # What exists and is not refused is ours, and goes. What appears from now on is not.
            overwrite = keeping.force or os.path.lexists(item.target)
            todo.append(replace(item, overwrite=overwrite))
            continue
        before = record is records.get(record_key(record))
        if not before:
            new.append(record)
        tell(record, before)
    append(new)
    return todo


def _work_on(
    todo: list[Task], job: Job, engine: Engine, append: Append, tell: Tell, telling: Telling
) -> None:
    """Work on tasks; each is on record before it begins, and again when it is done."""
    _make_folders(todo)
    remove_temporaries(task.target for task in todo)

    def begin(tasks: list[Task]) -> None:
        append(begun_record(task.source, task.target) for task in tasks)

    shown_progress = progress(
        telling.show_progress,
        [task.size for task in todo],
        verbose=telling.verbose,
        quiet=telling.quiet,
    )
    try:
        with shown_progress as advance, closing(engine(job, todo, begin)) as outcomes:
            for task, outcome in outcomes if todo else ():
                record = _record(job, task, outcome)
                append([record])
                tell(record, False)
                advance(record, task.size)
    finally:
        # Of files that are done too: a worker may have died of them at first.
        remove_temporaries(task.target for task in todo)


def _record(job: Job, task: Task, outcome: Record | Exception) -> Record:
    """Return the record of a task, with the names that the user has given."""
    if isinstance(outcome, Exception):
        remove_temporaries([task.target])
        return failed(job, task, Failure(task.source, job.what, outcome))
    return {**outcome, "source": task.source, "target": task.target}


def _make_folders(todo: list[Task]) -> None:
    for folder in sorted({os.path.dirname(task.target) for task in todo}):
        _make_folder(folder)


def _make_folder(folder: str) -> None:
    with attempt(folder, "cannot create the folder"):
        os.makedirs(folder or os.curdir, exist_ok=True)


def _sum_up(totals: Totals, telling: Telling) -> None:
    if telling.as_json:
        print_json({"summary": totals.as_object()})
    elif not telling.quiet:
        click.echo(totals.as_text())
