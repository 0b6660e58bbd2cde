"""ZIP archives in memory: opened, and read, with messages for what is wrong with them."""

from __future__ import annotations

import io
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager

from deltamesh_formats.errors import MeshError


def opened(data: bytes) -> zipfile.ZipFile:
    """Open a ZIP.

    Raises
    ------
    MeshError
        For bytes that are none.
    """
    try:
        return zipfile.ZipFile(io.BytesIO(data))
    except (zipfile.BadZipFile, ValueError, NotImplementedError, OverflowError) as error:
        raise MeshError(f"it is no ZIP: {error}") from None


@contextmanager
def reading(name: str) -> Iterator[None]:
    """Context in which a file of a ZIP is read.

    Raises
    ------
    MeshError
        For one that is damaged or encrypted.
    """
    try:
        yield
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as bad:
        raise MeshError(f"its {name} is damaged or encrypted: {bad}") from None
