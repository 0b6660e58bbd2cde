"""Buffers of a glTF that are not in the file itself: data URIs, and files beside it."""

from __future__ import annotations

import base64
import binascii
from typing import Final
from urllib.parse import unquote, urlsplit

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.beside import OUTSIDE, Beside
from deltamesh_formats.meshfiles.glb.schema import shown

_DATA: Final = "data:"


def outside_bytes(uri: str, beside: Beside | None, most: int) -> bytes:
    """Return the bytes that the URI of a buffer stands for.

    Parameters
    ----------
    uri : str
        A data URI, or the relative path of a file.
    beside : callable, optional
        The files beside the glTF; None for one that came without a folder.
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
    if beside is None:
        raise MeshError(f"is in another file, {shown(uri)}, which a stream has not beside it")
    try:
        name = name_of_file(uri)
        if not name:
            raise MeshError(OUTSIDE)
        return beside(name, most)
    except MeshError as error:
        raise MeshError(f"is in another file, {shown(uri)}, {error}") from None


def name_of_file(uri: str) -> str:
    """Return the relative path that a URI stands for, "" if it stands for anything else."""
    try:
        scheme = urlsplit(uri).scheme
    except ValueError:
        return ""
    name = unquote(uri)
    return "" if scheme or "\0" in name else name
