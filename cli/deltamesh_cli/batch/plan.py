"""Plan of `deltamesh batch`: its input files, their outputs, and outputs that exist already."""

from __future__ import annotations

import errno
import io
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
from deltamesh_cli.batch.work import Job, failure_record
from deltamesh_cli.decoding import output_name_and_format
from deltamesh_cli.failures import Failure, attempt
from deltamesh_cli.inputs import DMESH, MESH, Choice
from deltamesh_formats.errors import DeltameshError, FormatError
from deltamesh_formats.meshfiles.beside import read_with
from deltamesh_formats.meshfiles.formats import written_format
from deltamesh_formats.places import absolute, exists, read_bytes, read_head, status
from deltamesh_formats.remote import is_url
from deltamesh_formats.wrappers import beginning, unwrapped, without_wrapper

# At least as many bytes as the header of a `.dmesh` file can have.
_HEADER: Final = 64
# Bytes of a compressed file in which those of the header come: more than a block of zstandard.
_BEGINNING: Final = 1 << 18
# A mesh file that is compressed decompresses to at most so many times its size, or nearly.
_MOST_COMPRESSED: Final = 8

# A task, or the record of a file that failed before the work began.
PlannedFile: TypeAlias = Task | Record


@dataclass(frozen=True)
class Destinations:
    """Folders of the outputs: those of the inputs, one flat folder, or a mirror of the inputs'."""

    flat: str | None = None
    mirror: str | None = None

    @property
    def folder(self) -> str | None:
        """The folder that contains all outputs, if there is one."""
        return self.flat if self.mirror is None else self.mirror

    def path_for(self, source: str) -> str:
        """Return the path of an output that has the same name as its input."""
        if self.flat is not None:
            return flat(self.flat, source)
        return source if self.mirror is None else mirrored(self.mirror, source)


def plan_files(
    job: Job,
    destinations: Destinations,
    names: Sequence[str],
    choice: Choice,
) -> list[PlannedFile]:
    """Return the planned files, sorted by the names of the inputs.

    Parameters
    ----------
    job : Job
    destinations : Destinations
    names : sequence of str
        Files, folders and patterns.
    choice : Choice

    Raises
    ------
    OptionError
        If two files have the same output, or an output is an input.
    Failure
        If a list of files cannot be read.
    """
    problems: list[OSError] = []
    selection = choice.selection(DMESH if job.decode else MESH, destinations.folder)
    found = {*find(names, selection, failed=problems.append)}
    found |= {*find(choice.listed(), selection, patterns=False, failed=problems.append)}
    unique = {absolute(name): name for name in sorted(found, reverse=True)}
    planned = [_plan_file(job, destinations, name) for name in sorted(unique.values())]
    check_targets((one.source, one.target) for one in planned if isinstance(one, Task))
    for problem in problems:
        folder = Task(problem.filename, "", 0)
        failure = Failure(folder.source, "cannot list", problem)
        planned.append(failure_record(job, folder, failure))
    return planned


def _plan_file(job: Job, destinations: Destinations, source: str) -> PlannedFile:
    path, size = destinations.path_for(source), 0
    try:
        with attempt(source, "cannot read"):
            size, _ = status(source)
            if not is_url(source):
                _check_regular(source)
            if job.decode:
                target = _decoded_name(job, source, path)
                return Task(source, target, size, _decoding_memory(source))
            beside = sum(status(one)[0] for one in read_with(source, job.file_format or ""))
    except Failure as failure:
        return failure_record(job, Task(source, "", size), failure)
    grown = size * (_MOST_COMPRESSED if without_wrapper(source)[1] else 1)
    need = memory_for_mesh_file(grown + beside, job.file_format or files.extension(source))
    return Task(source, path + files.SUFFIX, size + beside, need)


def _check_regular(source: str) -> None:
    mode = os.stat(source).st_mode
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, "it is a folder, not a file")
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, "it is not a file, but a pipe or a device")


def _decoded_name(job: Job, source: str, path: str) -> str:
    """Return the name of a mesh file; the content determines its format if `path` does not."""
    stem = files.without_suffix(path)
    if stem is None:
        raise OSError(errno.EINVAL, f"its name does not end in {files.SUFFIX}")
    known = job.file_format or written_format(files.extension(stem)) is not None
    stored = "" if known else _stored_format(source)
    return output_name_and_format(path, None, job.file_format, stored)[0]


def _decoding_memory(source: str) -> int:
    """Return the bytes of memory that decoding a `.dmesh` file takes, according to its header."""
    from deltamesh_formats.container.reader import read_counts

    data = read_head(source, _BEGINNING)
    try:
        return memory_for_counts(*read_counts(beginning(data, _HEADER)))
    except FormatError:  # the decoder will report the damage
        return memory_for_counts(0, 0)


def _stored_format(source: str) -> str:
    """Return the format that a file stores; a compressed one is decompressed for that."""
    from deltamesh_formats.container.reader import read_source_format

    try:
        return read_source_format(io.BytesIO(unwrapped(read_bytes(source))))
    except DeltameshError:  # the decoder will report the damage
        return ""


def settled_record(
    job: Job, task: Task, before: Record | None, *, force: bool, skip_existing: bool
) -> Record | None:
    """Return the record of a task that needs no work, or None if it does need work.

    Parameters
    ----------
    job : Job
    task : Task
    before : dict or None
        The last record of the task in the manifest of an interrupted run.
    force, skip_existing : bool
        Whether an existing output is overwritten or left, unless the interrupted run wrote it.
    """
    if before is not None and still_done(before, job.options(), __version__):
        return before
    if before is not None and wrote_target(before):
        return None
    if skip_existing and exists(task.target):
        return {"status": SKIPPED, "source": task.source, "target": task.target}
    if force or not exists(task.target):
        return None
    error = FileExistsError(errno.EEXIST, "it exists already")
    hint = "-f overwrites it, --skip-existing leaves it"
    return failure_record(job, task, Failure(task.target, "cannot write", error, hint))
