"""Sources of bytes: paths, binary file objects, bytes-like objects."""

from __future__ import annotations

import os
from typing import TypeAlias, cast

from deltamesh_formats.atomic import PathOrFile
from deltamesh_formats.places import read_bytes
from deltamesh_formats.wrappers import DEFAULT_LIMIT, unwrapped

Bytes: TypeAlias = bytes | bytearray | memoryview
Source: TypeAlias = PathOrFile | Bytes


def bytes_of(data: Bytes) -> memoryview:
    """Return a bytes-like object (bytearray, mmap, an array of bytes) as bytes, without a copy.

    Raises
    ------
    TypeError
        For anything else.
    """
    try:
        return memoryview(data).cast("B")
    except TypeError:
        what = type(data).__name__
        raise TypeError(f"bytes are needed, not {what}: load takes a path or a file") from None


def read_file(source: PathOrFile, limit: int = DEFAULT_LIMIT, *, partial: bool = False) -> bytes:
    """Return the bytes in a file, without gzip or zstandard around them.

    Parameters
    ----------
    source : path, URL or binary file object
        A file object is read from where it is to its end, and need not be seekable.
    limit : int
        Bytes that it may decompress to.
    partial : bool
        Whether the file may be cut, and the stream of the compression with it.

    Raises
    ------
    OSError
        When the file cannot be opened or read.
    FormatError
        For damaged compression.
    LimitError
        For more than the limit.
    TypeError
        For anything else, and for a file open in text mode.
    """
    if isinstance(source, (str, os.PathLike)):
        return unwrapped(read_bytes(source), limit, partial=partial)
    if not hasattr(source, "read"):
        what = type(source).__name__
        raise TypeError(f"a path or a binary file is needed, not {what}: decode takes bytes")
    data = source.read()
    if not isinstance(data, bytes):
        raise TypeError(f"a file to read from has to be open in binary mode: {source!r}")
    return unwrapped(data, limit, partial=partial)


def read_source(
    source: Source, limit: int = DEFAULT_LIMIT, *, partial: bool = False
) -> bytes | memoryview:
    """Return the bytes in a file, as `read_file` does, or those of a bytes-like object.

    Raises
    ------
    FormatError, LimitError
        As in `read_file`.
    OSError
        When the file cannot be opened or read.
    TypeError
        For anything else.
    """
    if isinstance(source, (str, os.PathLike)) or hasattr(source, "read"):
        return read_file(cast(PathOrFile, source), limit, partial=partial)
    try:
        return bytes_of(source)
    except TypeError:
        what = type(source).__name__
        raise TypeError(f"a path, a binary file or bytes are needed, not {what}") from None
