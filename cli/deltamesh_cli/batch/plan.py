"""Which files `deltamesh batch` works on, and what becomes of outputs that are there already."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

from deltamesh._limits import memory_for_counts
from deltamesh._version import __version__
from deltamesh.batch import (
    SKIPPED,
    Record,
    Selection,
    Task,
    check_targets,
    find,
    flat,
    memory_for_mesh_file,
    mirrored,
    still_done,
    wrote_target,
)
from deltamesh_cli import files
from deltamesh_cli.batch.work import Job, failed
from deltamesh_cli.commands.decode import destination
from deltamesh_cli.failures import Failure, attempt
from deltamesh_formats.errors import DeltameshError, FormatError
from deltamesh_formats.meshfiles.formats import EXTENSIONS

# As many bytes as the header of a `.dmesh` file may have, and more.
_HEADER: Final = 64

# What there is to do: a task, or the record of one that has failed before it began.
Item: TypeAlias = Task | Record


@dataclass(frozen=True)
class Places:
    """Where outputs go: beside the inputs, all into one folder, or into a mirror of theirs."""

    flat: str | None = None
    mirror: str | None = None

    @property
    def folder(self) -> str | None:
        """The folder of all outputs, if there is one."""
        return self.flat if self.mirror is None else self.mirror

    def of(self, source: str) -> str:
        """Return the name that the output would have if it had that of the input."""
        if self.flat is not None:
            return flat(self.flat, source)
        return source if self.mirror is None else mirrored(self.mirror, source)


def listed(name: str, *, null: bool) -> list[str]:
    """Return the file names in a list, one a line or, with `null`, each ended by a NUL.

    Raises
    ------
    Failure
        The list cannot be read.
    """
    data = files.read_input(name)
    parts = data.split(b"\0") if null else [line.rstrip(b"\r") for line in data.split(b"\n")]
    return [os.fsdecode(part) for part in parts if part]


def selection(
    job: Job, places: Places, include: tuple[str, ...], exclude: tuple[str, ...], recursive: bool
) -> Selection:
    """Return what is taken from folders: what there is to decode, or to encode."""
    kinds = (files.SUFFIX.removeprefix("."),) if job.decode else tuple(EXTENSIONS)
    return Selection(kinds, include, exclude, recursive, places.folder)


def planned(
    job: Job, places: Places, names: Sequence[str], lists: Sequence[str], chosen: Selection
) -> list[Item]:
    """Return what there is to do, sorted by the names of the inputs.

    Parameters
    ----------
    job : Job
    places : Places
    names : sequence of str
        As of `deltamesh.batch.find`, patterns included.
    lists : sequence of str
        The same, each as it is.
    chosen : Selection

    Raises
    ------
    OptionError
        Two files would have one output, an output is an input, or a folder is not to be entered.
    """
    problems: list[OSError] = []
    found = {*find(names, chosen, failed=problems.append)}
    found |= {*find(lists, chosen, patterns=False, failed=problems.append)}
    unique = {os.path.abspath(name): name for name in sorted(found, reverse=True)}
    items = [_item(job, places, name) for name in sorted(unique.values())]
    check_targets((task.source, task.target) for task in items if isinstance(task, Task))
    for problem in problems:
        folder = Task(problem.filename, "", 0)
        items.append(failed(job, folder, Failure(folder.source, "cannot list", problem)))
    return items


def _item(job: Job, places: Places, source: str) -> Item:
    place, size = places.of(source), 0
    try:
        with attempt(source, "cannot read"):
            found = os.stat(source)
            size = found.st_size
            if stat.S_ISDIR(found.st_mode):
                raise IsADirectoryError(errno.EISDIR, "it is a folder, not a file")
            if not stat.S_ISREG(found.st_mode):
                raise OSError(errno.EINVAL, "it is not a file, but a pipe or a device")
            if job.decode:
                return Task(source, _decoded_name(job, source, place), size, _need(source))
    except Failure as failure:
        return failed(job, Task(source, "", size), failure)
    need = memory_for_mesh_file(size, job.file_format or files.extension(source))
    return Task(source, place + files.SUFFIX, size, need)


def _decoded_name(job: Job, source: str, place: str) -> str:
    """Return the name of a mesh, which a file tells when its name does not tell the format."""
    stem, suffix = os.path.splitext(place)
    if suffix.lower() != files.SUFFIX:
        raise OSError(errno.EINVAL, f"its name does not end in {files.SUFFIX}")
    named = job.file_format or files.extension(stem) in EXTENSIONS
    return destination(place, None, job.file_format, "" if named else _stored_format(source))[0]


def _need(source: str) -> int:
    """Return the memory that a `.dmesh` file takes, by its header."""
    from deltamesh_formats.container.reader import read_counts

    with open(source, "rb") as stream:
        header = stream.read(_HEADER)
    try:
        return memory_for_counts(*read_counts(header))
    except FormatError:  # the decoder will say what is wrong with it
        return memory_for_counts(0, 0)


def _stored_format(source: str) -> str:
    from deltamesh_formats.container.reader import read_container

    try:
        with open(source, "rb") as stream:
            meta = read_container(stream.read()).meta
    except DeltameshError:
        return ""
    return "" if meta is None else meta.source


def settled(
    job: Job, task: Task, before: Record | None, *, force: bool, skip_existing: bool
) -> Record | None:
    """Return what is known of a task without any work, None for one that there is work on.

    Parameters
    ----------
    job : Job
    task : Task
    before : dict or None
        The last record of the task in the manifest that is resumed.
    force, skip_existing : bool
        What to do with an output that exists and is not that of a run that was interrupted.
    """
    if before is not None and still_done(before, job.options(), __version__):
        return before
    if before is not None and wrote_target(before):
        return None
    if skip_existing and os.path.lexists(task.target):
        return {"status": SKIPPED, "source": task.source, "target": task.target}
    if force or not os.path.lexists(task.target):
        return None
    error = FileExistsError(errno.EEXIST, "it exists already")
    hint = "-f overwrites it, --skip-existing leaves it"
    return failed(job, task, Failure(task.target, "cannot write", error, hint))
