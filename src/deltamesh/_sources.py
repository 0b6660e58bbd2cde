"""Readers of sources: paths, binary file objects, bytes, and containers that were read before."""

from __future__ import annotations

import os
from pathlib import Path
from typing import BinaryIO, TypeAlias

from deltamesh_formats.container.container import Container
from deltamesh_formats.container.reader import read_container

Bytes: TypeAlias = bytes | bytearray | memoryview
Source: TypeAlias = str | os.PathLike[str] | BinaryIO | Bytes


def open_container(source: Source | Container) -> Container:
    """Return the container of a file, wherever it is; a container is returned as it is.

    Parameters
    ----------
    source : path, binary file object, bytes-like or Container

    Raises
    ------
    FormatError
        For anything but a whole, undamaged file of this version.
    OSError, TypeError
        As `read_source`.
    """
    return source if isinstance(source, Container) else read_container(read_source(source))


def read_source(source: Source) -> bytes | memoryview:
    """Return the bytes of a file, wherever it is.

    Parameters
    ----------
    source : path, binary file object or bytes-like
        A file object is read from where it is to its end, and need not be seekable; a bytes-like
        object (bytearray, mmap, an array of bytes) is not copied.

    Raises
    ------
    OSError
        When the file cannot be opened or read.
    TypeError
        For anything else.
    """
    if isinstance(source, (str, os.PathLike)):
        return Path(source).read_bytes()
    if hasattr(source, "read"):
        data = source.read()
        if not isinstance(data, bytes):
            raise TypeError(f"a file to read from has to be open in binary mode: {source!r}")
        return data
    try:
        return memoryview(source).cast("B")
    except TypeError:
        what = type(source).__name__
        raise TypeError(f"a path, a binary file or bytes are needed, not {what}") from None
