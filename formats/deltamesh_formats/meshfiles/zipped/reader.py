"""Reader of a ZIP with one mesh file in it; nothing is unpacked on the disk.

Files that the mesh names are read beside it, in its folder of the ZIP or below that. Whatever else
is there is named as lost.
"""

from __future__ import annotations

import posixpath
import zipfile
from collections.abc import Iterable
from dataclasses import replace
from typing import Final

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.beside import MISSING, OUTSIDE, Beside
from deltamesh_formats.meshfiles.file_format import FileFormat
from deltamesh_formats.meshfiles.formats import READABLE, format_of_extension
from deltamesh_formats.meshfiles.zip_files import opened, reading
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.wrappers import DEFAULT_LIMIT, unwrapped, without_wrapper

_MOST_NAMES: Final = 4  # in a message
# Folders and files of what systems, not people, put into archives.
_OF_SYSTEMS: Final = ("__MACOSX", "Thumbs.db", "desktop.ini")


def read(data: bytes) -> PolyMesh:
    """Read the mesh of a ZIP.

    Returns
    -------
    PolyMesh
        With the format of the mesh file.

    Raises
    ------
    MeshError
        For what is no ZIP, one without a mesh file, one with several, which are named, and one
        whose mesh file is damaged, encrypted or larger than 16 GiB.
    """
    archive = opened(data)
    files = {one.filename: one for one in archive.infolist() if _is_of_people(one)}
    meshes = {name: known for name in files if (known := _format_of(name)) is not None}
    if not meshes:
        raise MeshError(f"the ZIP has no mesh file in it: {_listed(files) or 'it is empty'}")
    if len(meshes) > 1:
        text = f"the ZIP has {len(meshes)} mesh files in it: {_listed(meshes)}"
        raise MeshError(f"{text}; unpack it, and give one of them")
    ((name, known),) = meshes.items()
    used = {name}

    def beside(path: str, most: int) -> bytes:
        found = posixpath.normpath(posixpath.join(posixpath.dirname(name), path))
        if found.startswith(("../", "/")):
            raise MeshError(OUTSIDE)
        if found not in files:
            raise MeshError(MISSING)
        used.add(found)
        return _contents(archive, files[found], most)

    mesh = _read(known, name, unwrapped(_contents(archive, files[name], DEFAULT_LIMIT)), beside)
    others = [one for one in files if one not in used]
    lost = (f"other files of the ZIP ({_listed(others)})",) if others else ()
    return replace(mesh, format=known.name, lost=(*mesh.lost, *lost))


def _read(known: FileFormat, name: str, data: bytes, beside: Beside) -> PolyMesh:
    try:
        return known.read(data, beside)
    except MeshError as error:
        raise type(error)(f"{_shown(name)}: {error}") from None


def _is_of_people(one: zipfile.ZipInfo) -> bool:
    parts = one.filename.split("/")
    hidden = any(part.startswith(".") or part in _OF_SYSTEMS for part in parts)
    return not (one.is_dir() or hidden)


def _format_of(name: str) -> FileFormat | None:
    """Return the format of a mesh file; a ZIP in a ZIP is none."""
    known = format_of_extension(posixpath.splitext(without_wrapper(name)[0])[1])
    return None if known is READABLE["zip"] else known


def _contents(archive: zipfile.ZipFile, one: zipfile.ZipInfo, most: int) -> bytes:
    if one.file_size > DEFAULT_LIMIT:
        raise MeshError(f"its {_shown(one.filename)} has more than {DEFAULT_LIMIT} bytes")
    with reading(_shown(one.filename)), archive.open(one) as stream:
        return stream.read(most)


def _listed(names: Iterable[str]) -> str:
    found = [_shown(name) for name in names]
    more = f" and {len(found) - _MOST_NAMES} more" if len(found) > _MOST_NAMES else ""
    return ", ".join(found[:_MOST_NAMES]) + more


def _shown(name: str) -> str:
    return name if len(name) <= 80 else name[:77] + "..."
