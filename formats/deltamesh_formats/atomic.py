"""Writer of files that are whole or absent, whoever else reads or writes them meanwhile.

The bytes go into a temporary file beside the target (`temporaries`) and onto the disk; a rename
then makes it the target. Nothing else in deltamesh writes a file at a path, but for the manifest of
a batch, which lines are appended to.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import BinaryIO, Final, Literal, TypeAlias

from deltamesh_formats import remote
from deltamesh_formats.temporaries import remove_left_behind, temporary_of

__all__ = ["Found", "PathOrFile", "found_at", "require_file", "write_file"]

PathOrFile: TypeAlias = str | os.PathLike[str] | BinaryIO

# Kinds of things at a path. A stream takes bytes and keeps none that were there before: a pipe, a
# terminal, /dev/null, /dev/stdout. The others are folders and disks.
Found: TypeAlias = Literal["nothing", "file", "stream", "other"]

_BINARY: Final = getattr(os, "O_BINARY", 0)
_NEW: Final = os.O_WRONLY | os.O_CREAT | os.O_EXCL | _BINARY


def found_at(path: str | os.PathLike[str]) -> Found:
    """Return what is at a path, behind symbolic links.

    Raises
    ------
    OSError
        When the target of a link cannot be found, as for a circle of links.
    """
    return _kind(_status(os.fspath(path)))


def require_file(file: object, use: Literal["read", "write"]) -> None:
    """Refuse what is neither a path nor a file object.

    Raises
    ------
    TypeError
    """
    if not isinstance(file, (str, os.PathLike)) and not hasattr(file, use):
        raise TypeError(f"a path or a binary file is needed, not {type(file).__name__}")


def write_file(target: PathOrFile, data: bytes, *, overwrite: bool = True) -> None:
    """Write bytes to a path, all of them or none, or to a file object.

    A file that is replaced stays as it is until all bytes are on the disk, and its permissions (and
    its owner and group, as far as the system allows) become those of the new one; without one they
    are what the umask leaves. A symbolic link stays, and what it names is written. Pipes and
    devices are written in place. On an error, and on an exception that a signal has raised, no
    temporary file is left; what killed processes have left of theirs in the folder is removed.

    Parameters
    ----------
    target : path, URL or binary file object
        `deltamesh_formats.remote` says how files at URLs are written.
    data : bytes
    overwrite : bool
        Whether a file at the path is replaced. If not, one that appears in the last moment is not
        replaced either.

    Raises
    ------
    FileExistsError
        Without `overwrite`, for a path at which there is something that holds data.
    OSError
        When it cannot be written; `filename` is the path.
    """
    if not isinstance(target, (str, os.PathLike)):
        _write_all(target.write, data)
        return
    path = os.fspath(target)
    if remote.is_url(path):
        local = remote.local_path(path)
        if local is None:
            remote.write(path, data, overwrite=overwrite)
            return
        path = local
    try:
        _write_path(path, data, overwrite)
    except OSError as error:  # of the temporary file, or of a descriptor: neither is known outside
        raise OSError(error.errno, error.strerror, path) from error


def _status(path: str) -> os.stat_result | None:
    try:
        return os.stat(path)
    except FileNotFoundError:
        return None


def _kind(status: os.stat_result | None) -> Found:
    if status is None:
        return "nothing"
    if stat.S_ISREG(status.st_mode):
        return "file" if _printed_to(status) is None else "stream"
    if stat.S_ISCHR(status.st_mode) or stat.S_ISFIFO(status.st_mode):
        return "stream"
    return "other"


def _printed_to(status: os.stat_result) -> int | None:
    """Return the descriptor of standard output or error that goes into this very file, if any.

    /dev/stdout is that file after `> file`. A rename would take it from those who print to it.
    """
    for descriptor in (1, 2):
        with suppress(OSError):  # it is closed
            if os.path.samestat(status, os.fstat(descriptor)):
                return descriptor
    return None


def _write_path(path: str, data: bytes, overwrite: bool) -> None:
    status = _status(path)
    kind = _kind(status)
    if kind in ("file", "other") and not overwrite:
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST))
    if kind in ("nothing", "file"):
        _replace(os.path.realpath(path), data, status, overwrite)
        return
    assert status is not None
    descriptor = _printed_to(status) if stat.S_ISREG(status.st_mode) else None
    if descriptor is not None:
        _write_all(partial(os.write, descriptor), data)
        return
    descriptor = os.open(path, os.O_WRONLY | _BINARY)
    try:
        _write_all(partial(os.write, descriptor), data)
    finally:
        os.close(descriptor)


def _replace(path: str, data: bytes, status: os.stat_result | None, overwrite: bool) -> None:
    """Write a file aside and rename it; `path` has no links, `status` is of what is there."""
    remove_left_behind(os.path.dirname(path))
    temporary = temporary_of(path)
    try:
        _create(temporary, data, status)
        if overwrite:
            os.replace(temporary, path)
        else:
            _name(temporary, path)
    finally:
        with suppress(OSError):  # after a rename it is not there
            os.unlink(temporary)


def _create(path: str, data: bytes, like: os.stat_result | None) -> None:
    """Write a file that is not there yet, onto the disk, with the permissions of another one."""
    mode = 0o666 if like is None else stat.S_IMODE(like.st_mode)
    descriptor = os.open(path, _NEW, mode)
    try:
        if like is not None:
            _permit(descriptor, like)
        _write_all(partial(os.write, descriptor), data)
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _permit(descriptor: int, like: os.stat_result) -> None:
    """Give a file the permissions of another one, and its owner and group where that is allowed.

    Not every file system has them. The file was created with no more than those permissions, so
    nobody can do more with it than with the other one. A file that must not be written on Windows
    cannot be replaced there either.
    """
    if os.name == "nt":
        return
    with suppress(OSError):
        os.fchmod(descriptor, stat.S_IMODE(like.st_mode))
    for owner, group in ((-1, like.st_gid), (like.st_uid, -1)):
        with suppress(OSError):
            os.fchown(descriptor, owner, group)


def _name(temporary: str, path: str) -> None:
    """Give a file its final name, unless there is something of this name.

    A rename would replace that, except on Windows; a link does not. Where there are no hard links
    (FAT, some network file systems) an empty file reserves the name. Readers may see that for a
    moment, and a process killed in that moment leaves it.
    """
    if os.name == "nt":
        os.rename(temporary, path)
        return
    try:
        os.link(temporary, path)
    except FileExistsError:
        raise
    except OSError:
        os.close(os.open(path, _NEW, 0o666))
        try:
            os.replace(temporary, path)
        except BaseException:
            with suppress(OSError):
                if not os.path.getsize(path):  # otherwise somebody has written to it
                    os.unlink(path)
            raise


def _write_all(write: Callable[[memoryview], int | None], data: bytes) -> None:
    rest = memoryview(data)
    while rest:  # a pipe may take a part, and so does a disk of more than 2 GB
        taken = write(rest)
        rest = rest[len(rest) if taken is None else taken :]
