"""Buffers of a glTF that are not in the file itself: data URIs, and files beside it."""

from __future__ import annotations

import base64
import binascii
from pathlib import Path
from typing import Final
from urllib.parse import unquote, urlsplit

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.glb.schema import shown

_DATA: Final = "data:"


def outside_bytes(uri: str, folder: Path | None, most: int) -> bytes:
    """Return the bytes that the URI of a buffer stands for.

    Parameters
    ----------
    uri : str
        A data URI, or the relative path of a file.
    folder : Path, optional
        Of the glTF; nothing outside is read. None for one that came without a folder.
    most : int
        Bytes of a file that are read at most.

    Raises
    ------
    MeshError
        Whose message follows the name of the buffer: for data that are no base64, and a file
        that is missing or outside the folder.
    OSError
        For a file that cannot be read.
    """
    if uri.startswith(_DATA):
        head, _, body = uri.partition(",")
        if not head.endswith(";base64"):
            raise MeshError(f"has the URI {shown(uri)}, which is not base64")
        try:
            return base64.b64decode(body)
        except (binascii.Error, ValueError) as error:
            raise MeshError(f"is not readable: {error}") from None
    if folder is None:
        raise MeshError(f"is in another file, {shown(uri)}, which a stream has not beside it")
    path = _inside(uri, folder)
    if not path.is_file():
        raise MeshError(f"is in another file, {shown(uri)}, which is not there")
    with path.open("rb") as stream:
        return stream.read(most)


def _inside(uri: str, folder: Path) -> Path:
    """Return the path of a file in a folder, links followed."""
    name = unquote(uri)
    home = folder.resolve()
    try:
        if "\0" not in name and not urlsplit(uri).scheme:
            path = (home / name).resolve()
            if path.is_relative_to(home):
                return path
    except (ValueError, OSError, RuntimeError):  # such as a name that is too long
        pass
    raise MeshError(f"is in another file, {shown(uri)}, outside the folder: it is not read")
