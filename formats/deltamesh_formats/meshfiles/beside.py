"""Files beside a mesh file, which are read with it: those of its folder, or of its ZIP.

A reader gets them as a function of a relative path and of the bytes to read at most. It raises
`MeshError`, with the end of a sentence about the file, where there is no such file.
"""

from __future__ import annotations

import os
import posixpath
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Final, TypeAlias

from deltamesh_formats import places, remote
from deltamesh_formats.errors import DeltameshError, MeshError
from deltamesh_formats.meshfiles.formats import format_of_extension
from deltamesh_formats.wrappers import unwrapped, without_wrapper

Beside: TypeAlias = Callable[[str, int], bytes]

OUTSIDE: Final = "outside the folder: it is not read"
MISSING: Final = "which is not there"


def in_folder(folder: str) -> Beside:
    """Return the files in a folder and below it, links followed; nothing outside is read.

    Parameters
    ----------
    folder : str
        A path, "" for the current folder, or a URL.
    """
    return lambda name, most: places.read_head(_path_in(folder, name), most)


def read_with(path: str, file_format: str = "") -> Iterator[str]:
    """Yield the paths of the files that are read with a mesh file, such as the buffers of a glTF.

    Parameters
    ----------
    path : str
        Of the mesh file, or its URL. One that is not readable has no others: its reader will say
        so.
    file_format : str
        Name of its format; by default that of its extension.
    """
    known = format_of_extension(file_format or os.path.splitext(without_wrapper(path)[0])[1])
    if known is None or known.names_beside is None:
        return
    with suppress(DeltameshError, OSError):
        for name in known.names_beside(unwrapped(places.read_bytes(path))):
            with suppress(MeshError):
                yield _path_in(places.parent(path), name)


def _path_in(folder: str, name: str) -> str:
    """Return the path of a file in a folder, links followed, or its URL."""
    if remote.is_url(folder):
        return _url_in(folder, name)
    path = None
    with suppress(ValueError, OSError, RuntimeError):  # such as a name that is too long
        home = Path(folder).resolve()
        path = (home / name).resolve()
        if not path.is_relative_to(home):
            path = None
    if path is None:
        raise MeshError(OUTSIDE)
    if not path.is_file():
        raise MeshError(MISSING)
    return str(path)


def _url_in(folder: str, name: str) -> str:
    inside = posixpath.normpath(name)
    if inside.startswith(("/", "../")) or inside == ".." or "\\" in inside:
        raise MeshError(OUTSIDE)
    url = places.joined(folder, inside)
    if not remote.exists(url):
        raise MeshError(MISSING)
    return url
