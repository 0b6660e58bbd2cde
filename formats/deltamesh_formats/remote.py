"""Files at URLs, such as s3://bucket/a.ply, which fsspec reads and writes (the extra `remote`).

Whatever goes wrong in a store is an `OSError`. A file appears whole: stores of objects, and servers
of HTTP, take the bytes of a file in one request; elsewhere they are written aside, and moved.
"""

from __future__ import annotations

import errno
import os
import posixpath
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, Final

# Two letters at least: one is a drive of Windows.
_URL: Final = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+://")
# Protocols whose stores take a whole file at once, and have no folders that would be made.
_AT_ONCE: Final = frozenset(
    "http https s3 s3a gs gcs az abfs abfss adl oci ocilake oss r2 obs hf".split()  # noqa: SIM905
)
# Those of them that can refuse to replace a file, in the same request.
_REFUSE: Final = frozenset(["s3", "s3a", "gs", "gcs"])
# How deep folders are looked into: pages of a server may link to themselves.
_DEEPEST: Final = 32
_NUMBERS: Final = {
    FileNotFoundError: errno.ENOENT,
    FileExistsError: errno.EEXIST,
    PermissionError: errno.EACCES,
    IsADirectoryError: errno.EISDIR,
}


def is_url(name: object) -> bool:
    """Return whether the name of a file is a URL; one without "://" is a path."""
    return isinstance(name, str) and _URL.match(name) is not None


def without_query(url: str) -> str:
    """Return a URL of HTTP without what follows its path; others have no such thing."""
    if url.lower().startswith(("http://", "https://")):
        return re.split(r"[?#]", url, maxsplit=1)[0]
    return url


def local_path(url: str) -> str | None:
    """Return the path of a file of this machine, for a URL with "file://"; None for any other."""
    if not url.lower().startswith(("file://", "local://")):
        return None
    _, path = _store(url)
    return path


def read(url: str) -> bytes:
    """Return the bytes of a file."""
    fs, path = _store(url)
    with _faults(url):
        return bytes(fs.cat_file(path))


def read_head(url: str, size: int) -> bytes:
    """Return the first bytes of a file; a server that knows no parts sends all of them."""
    fs, path = _store(url)
    with _faults(url):
        return bytes(fs.cat_file(path, start=0, end=size))[:size]


def status(url: str) -> tuple[int, int | None]:
    """Return the bytes of a file, and the time of its last change in ns, None if that is not known.

    Raises
    ------
    IsADirectoryError
        For a folder.
    """
    fs, path = _store(url)
    with _faults(url):
        info = fs.info(path)
        if info.get("type") == "directory":
            raise IsADirectoryError(path)
        changed = None
        with suppress(Exception):  # most stores that have no such time do not say so
            changed = round(fs.modified(path).timestamp() * 1e9)
        return int(info.get("size") or 0), changed


def exists(url: str) -> bool:
    """Return whether there is a file or a folder."""
    fs, path = _store(url)
    with _faults(url):
        return bool(fs.exists(path))


def is_folder(url: str) -> bool:
    """Return whether there is a folder."""
    fs, path = _store(url)
    with _faults(url):
        return bool(fs.isdir(path))


def files_below(url: str, *, recursive: bool = True) -> list[str]:
    """Return the URLs of the files in a folder, and below it if the search is recursive."""
    fs, path = _store(url)
    with _faults(url):
        found = fs.find(path, maxdepth=_DEEPEST if recursive else 1)
        return [fs.unstrip_protocol(one) for one in found]


def matching(pattern: str) -> list[str]:
    """Return the URLs of the files that match a pattern with "*" or "["."""
    fs, path = _store(pattern)
    with _faults(pattern):
        found = fs.glob(path)
        return [fs.unstrip_protocol(one) for one in found if not fs.isdir(one)]


def make_folder(url: str) -> None:
    """Make a folder, and those above it, where a store has such things."""
    fs, path = _store(url)
    if not _is_of(fs, _AT_ONCE):
        with _faults(url):
            fs.makedirs(path, exist_ok=True)


def write(url: str, data: bytes, *, overwrite: bool) -> None:
    """Write a file, all of its bytes or none.

    Without `overwrite`, a store is asked whether there is one first. S3 and Google's refuse also to
    replace one that appears meanwhile; others may overwrite it.

    Raises
    ------
    FileExistsError
        Without `overwrite`, for a file that exists.
    """
    fs, path = _store(url)
    with _faults(url):
        if not overwrite and fs.exists(path):
            raise FileExistsError(path)
        if _is_of(fs, _AT_ONCE):
            refuse = {} if overwrite or not _is_of(fs, _REFUSE) else {"mode": "create"}
            fs.pipe_file(path, data, **refuse)
            return
        folder = posixpath.dirname(path)
        aside = posixpath.join(folder, f".deltamesh-{os.urandom(12).hex()}.tmp")
        try:
            fs.pipe_file(aside, data)
            if not overwrite and fs.exists(path):
                raise FileExistsError(path)
            fs.mv(aside, path)
        except BaseException:
            with suppress(Exception):
                fs.rm_file(aside)
            raise


def _store(url: str) -> tuple[Any, str]:
    """Return the file system of a URL, and the path in it."""
    try:
        from fsspec.core import url_to_fs
    except ImportError:
        text = "fsspec reads and writes URLs: pip install 'deltamesh[remote]'"
        raise OSError(errno.EPROTONOSUPPORT, text, url) from None
    with _faults(url):
        fs, path = url_to_fs(url, use_listings_cache=False)
        return fs, path


def _is_of(fs: Any, protocols: frozenset[str]) -> bool:
    names = {fs.protocol} if isinstance(fs.protocol, str) else set(fs.protocol)
    return not names.isdisjoint(protocols)


@contextmanager
def _faults(url: str) -> Iterator[None]:
    """Context in which any error becomes an `OSError` with a number, a text and the URL."""
    try:
        yield
    except OSError as error:
        kinds = (number for kind, number in _NUMBERS.items() if isinstance(error, kind))
        number = error.errno or next(kinds, errno.EIO)
        plain = number != errno.EIO or not str(error)
        text = error.strerror or (os.strerror(number) if plain else str(error))
        raise OSError(number, text, url) from error
    except ImportError as error:  # of the package for a protocol: fsspec names it
        raise OSError(errno.EPROTONOSUPPORT, str(error), url) from error
    except Exception as error:
        text = str(error) or type(error).__name__
        raise OSError(errno.EIO, text, url) from error
