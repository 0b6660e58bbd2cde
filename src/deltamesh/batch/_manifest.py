"""Manifest of a run on disk, as JSON Lines that are only appended to.

A line is written and synchronized before the next step is taken: "begun" before a file is worked
on, "done", "failed" or "skipped" when it has its output. What was running when a process was
killed is known therefore: it has begun and not ended, and the run has written its output, if any.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, Final, TypeAlias

from deltamesh_formats.errors import DeltameshError
from deltamesh_formats.meshfiles.beside import read_with
from deltamesh_formats.places import read_bytes, status
from deltamesh_formats.remote import is_url

Record: TypeAlias = dict[str, Any]
Append: TypeAlias = Callable[[Iterable[Record]], None]

BEGUN: Final = "begun"
DONE: Final = "done"
FAILED: Final = "failed"
SKIPPED: Final = "skipped"

# The beginning of each line: nothing else is taken for a torn line, and cut off.
_START: Final = b'{"status": "'

_PIECE: Final = 1 << 20


class ManifestError(DeltameshError):
    """A file that is no manifest, or one that another run is writing."""


def record_key(record: Record) -> tuple[str, str]:
    """Return what a record is about: source and target."""
    return record["source"], record["target"]


def begun_record(source: str, target: str) -> Record:
    """Return the record of a file that is about to be worked on."""
    return {"status": BEGUN, "source": source, "target": target}


def line(record: Record) -> bytes:
    """Return a record as a line; `status` comes first, any file name survives."""
    ordered = {"status": record["status"], **record}
    return json.dumps(ordered, allow_nan=False).encode("ascii") + b"\n"


def read_records(data: bytes) -> list[Record]:
    """Return the records of a manifest; a last line that was cut short is left out.

    Raises
    ------
    ManifestError
        If any other line is not a record.
    """
    return [_record(number, text) for number, text in enumerate(data.split(b"\n")[:-1], 1)]


def _record(number: int, text: bytes) -> Record:
    try:
        record = json.loads(text)
        if all(isinstance(record[name], str) for name in ("status", "source", "target")):
            return dict(record)
    except (ValueError, TypeError, KeyError):
        pass
    raise ManifestError(f"line {number} is not a record of deltamesh batch")


@contextmanager
def open_manifest(
    path: str, *, resume: bool, force: bool = False
) -> Iterator[tuple[dict[tuple[str, str], Record], Append]]:
    """Open a manifest, for this process alone.

    Parameters
    ----------
    path : str
    resume : bool
        Whether the records of a file that exists are read and kept.
    force : bool
        Whether a file that exists is begun anew otherwise.

    Yields
    ------
    records : dict
        The last record of each (source, target).
    append : callable
        Writes records; when it returns they are on the disk.

    Raises
    ------
    ManifestError
        If it is no manifest, or another run is writing it.
    OSError
        If it exists and neither `resume` nor `force` is given, or cannot be opened.
    """
    flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | getattr(os, "O_BINARY", 0)
    if not (resume or force):
        flags |= os.O_EXCL
    descriptor = os.open(path, flags, 0o666)
    try:
        _lock(descriptor)
        if not resume:
            os.ftruncate(descriptor, 0)
        yield (
            {record_key(record): record for record in _whole_records(descriptor)},
            _appender(descriptor),
        )
    finally:
        os.close(descriptor)


def _lock(descriptor: int) -> None:
    """Take the lock that ends with this process, however it ends; Windows goes without."""
    try:
        import fcntl
    except ImportError:
        return
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise ManifestError("another run is writing it") from None
    except OSError:  # a file system without locks
        return


def _whole_records(descriptor: int) -> list[Record]:
    """Read all records, and cut off the line in the middle of which a process was killed."""
    with open(descriptor, "rb", closefd=False) as file:
        data = file.read()
    records = read_records(data)
    torn = data[data.rfind(b"\n") + 1 :]
    if torn:
        if torn[: len(_START)] != _START[: len(torn)]:
            raise ManifestError("it does not end with a record of deltamesh batch")
        os.ftruncate(descriptor, len(data) - len(torn))
    return records


def _appender(descriptor: int) -> Append:
    def append(records: Iterable[Record]) -> None:
        data = b"".join(map(line, records))
        while data:
            data = data[os.write(descriptor, data) :]
        os.fsync(descriptor)

    return append


def digest_of(paths: Iterable[str]) -> str:
    """Return the SHA-256 of files, one after the other, in hexadecimal digits."""
    import hashlib

    digest = hashlib.sha256()
    for path in paths:
        if is_url(path):
            digest.update(read_bytes(path))
            continue
        with open(path, "rb") as file:
            while piece := file.read(_PIECE):
                digest.update(piece)
    return digest.hexdigest()


def file_state(path: str, prefix: str) -> Record:
    """Return size, time of the last change and SHA-256 of a file, as a part of a record.

    With it count the files that are read with it, such as the buffers of a glTF. The time is None
    in a store that does not know it.
    """
    paths = [path, *read_with(path)]
    return {**_size_and_time(paths, prefix), f"{prefix}_sha256": digest_of(paths)}


def _size_and_time(paths: list[str], prefix: str) -> Record:
    sizes, times = zip(*map(status, paths), strict=True)
    newest = None if None in times else max(times)
    return {f"{prefix}_bytes": sum(sizes), f"{prefix}_mtime_ns": newest}


def unchanged(record: Record, path: str, prefix: str) -> bool:
    """Return whether a file is the one of the record.

    Where size and time of the last change are equal, the content is taken to be; where only the
    time differs, the content decides.
    """
    try:
        paths = [path, *read_with(path)]
        now = _size_and_time(paths, prefix)
        if now[f"{prefix}_bytes"] != record.get(f"{prefix}_bytes"):
            return False
        time = now[f"{prefix}_mtime_ns"]
        same_time = time is not None and time == record.get(f"{prefix}_mtime_ns")
        return same_time or digest_of(paths) == record.get(f"{prefix}_sha256")
    except OSError:
        return False


def still_done(record: Record, options: Record, version: str) -> bool:
    """Return whether the work of a record need not be done again.

    It was done, by this version and with these options, and neither file has changed since.
    """
    return (
        record["status"] == DONE
        and (record.get("options"), record.get("version")) == (options, version)
        and unchanged(record, record["source"], "source")
        and unchanged(record, record["target"], "target")
    )


def wrote_target(record: Record) -> bool:
    """Return whether what has the name of the target was written by the run of the record."""
    if record["status"] == DONE:
        return unchanged(record, record["target"], "target")
    return bool(record["status"] == BEGUN)
