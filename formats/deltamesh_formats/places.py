"""Places of files: paths of this machine, and URLs, with the same functions for both.

Errors are `OSError`s. Writing is in `deltamesh_formats.atomic`.
"""

from __future__ import annotations

import os
from pathlib import Path
from urllib.parse import urlsplit

from deltamesh_formats import remote
from deltamesh_formats.remote import is_url


def read_bytes(name: str | os.PathLike[str]) -> bytes:
    """Return the bytes of a file."""
    path = os.fspath(name)
    return remote.read(path) if is_url(path) else Path(path).read_bytes()


def read_head(name: str, size: int) -> bytes:
    """Return the first bytes of a file, as many as there are, up to `size`."""
    if is_url(name):
        return remote.read_head(name, size)
    with open(name, "rb") as stream:
        return stream.read(size)


def status(name: str) -> tuple[int, int | None]:
    """Return the bytes of a file, and the time of its last change in ns, None if not known."""
    if is_url(name):
        return remote.status(name)
    found = os.stat(name)
    return found.st_size, found.st_mtime_ns


def exists(name: str) -> bool:
    """Return whether there is anything, were it a link to nowhere."""
    return remote.exists(name) if is_url(name) else os.path.lexists(name)


def make_folder(name: str) -> None:
    """Make a folder, and those above it."""
    if is_url(name):
        remote.make_folder(name)
    else:
        os.makedirs(name or os.curdir, exist_ok=True)


def absolute(name: str) -> str:
    """Return what all names of a file in this folder have in common."""
    return name if is_url(name) else os.path.abspath(name)


def parent(name: str) -> str:
    """Return the folder of a file, "" for a name without one."""
    if is_url(name):
        return remote.without_query(name).rpartition("/")[0]
    return os.path.dirname(name)


def base_name(name: str) -> str:
    """Return the last part of a name."""
    if is_url(name):
        return remote.without_query(name).rpartition("/")[2]
    return os.path.basename(name)


def path_below(name: str) -> str:
    """Return the path of a name without its root, drive or protocol: for a copy of folders."""
    if is_url(name):
        parts = urlsplit(remote.without_query(name))
        return os.path.normpath(f"{parts.netloc}{parts.path}".replace("/", os.sep)).lstrip(os.sep)
    return os.path.normpath(os.path.splitdrive(name)[1]).lstrip(os.sep)


def joined(folder: str, path: str) -> str:
    """Return the name of a file in a folder."""
    if is_url(folder):
        return f"{folder.rstrip('/')}/{path.replace(os.sep, '/')}"
    return os.path.join(folder, path)
