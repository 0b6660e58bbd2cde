"""`.dmesh` files: what they say of themselves, whether they are whole, from and to a path."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from deltamesh_formats.layout import Container
from deltamesh_formats.polymesh import PolyMesh
from deltamesh_formats.reader import read_container


def info(data: bytes | bytearray | memoryview) -> Container:
    """Return what a file says of itself: counts, sections, parameters, achieved errors.

    Every checksum of the bytes is verified; nothing is decoded.

    Raises
    ------
    FormatError
    """
    return read_container(data)


def verify(data: bytes | bytearray | memoryview, **options: Any) -> Container:
    """Decode a file and return what it says of itself; damage of any kind raises.

    Parameters
    ----------
    data : bytes-like
    **options
        Those of `deltamesh.decode`.

    Raises
    ------
    FormatError, LimitError, SolveError
    """
    from deltamesh.codec import decode

    decode(data, **options)
    return read_container(data)


def load(path: str | os.PathLike[str], **options: Any) -> PolyMesh:
    """Decode the `.dmesh` file at a path; the options are those of `deltamesh.decode`."""
    from deltamesh.codec import decode

    return decode(Path(path).read_bytes(), **options)


def save(path: str | os.PathLike[str], mesh: PolyMesh, **options: Any) -> None:
    """Encode a mesh into a file at a path; the options are those of `deltamesh.encode`.

    The file appears whole or not at all; one that exists is replaced.
    """
    from deltamesh.codec import encode

    data = encode(mesh, **options)
    target = Path(path)
    temporary = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        temporary.write_bytes(data)
        os.replace(temporary, target)
    finally:
        temporary.unlink(missing_ok=True)
