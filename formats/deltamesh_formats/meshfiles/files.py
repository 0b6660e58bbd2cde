"""Mesh files in and out: OBJ, PLY, OFF, STL and GLB, everything in them that a `PolyMesh` holds.

The readers and writers are in the packages beside this module. A reader names what it has to leave
out in the mesh (`lost`), a writer names what its format has no place for in what it returns.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Final

import numpy as np

from deltamesh_formats.atomic import PathOrFile, write_file
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.glb import reader as glb_in
from deltamesh_formats.meshfiles.glb import writer as glb_out
from deltamesh_formats.meshfiles.obj import reader as obj_in
from deltamesh_formats.meshfiles.obj import writer as obj_out
from deltamesh_formats.meshfiles.off import reader as off_in
from deltamesh_formats.meshfiles.off import writer as off_out
from deltamesh_formats.meshfiles.ply import reader as ply_in
from deltamesh_formats.meshfiles.ply import writer as ply_out
from deltamesh_formats.meshfiles.stl import reader as stl_in
from deltamesh_formats.meshfiles.stl import writer as stl_out
from deltamesh_formats.meshfiles.written import Written
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.polymesh.texture_origin import with_origin
from deltamesh_formats.polymesh.validation import checked

__all__ = ["FORMATS", "mesh_bytes", "mesh_format", "read_mesh", "write_mesh", "written"]

_READERS: Final[dict[str, Callable[[bytes], PolyMesh]]] = {
    "obj": obj_in.read,
    "ply": ply_in.read,
    "off": off_in.read,
    "stl": stl_in.read,
    "glb": glb_in.read,
}
_WRITERS: Final[dict[str, Callable[[PolyMesh], Written]]] = {
    "obj": obj_out.write,
    "ply": ply_out.write,
    "off": off_out.write,
    "stl": stl_out.write,
    "glb": glb_out.write,
}
FORMATS: Final = tuple(_READERS)


def mesh_format(target: PathOrFile, file_format: str | None = None) -> str:
    """Return the format that is asked for or, without one, that of the file name's extension.

    Raises
    ------
    MeshError
        When it is not one of `FORMATS`.
    """
    name = _name(target)
    found = (file_format or Path(name).suffix).removeprefix(".").lower()
    if found in FORMATS:
        return found
    known = ", ".join(FORMATS)
    if found:
        raise MeshError(f"{name}: {found!r} is not a mesh format known here: {known}")
    raise MeshError(f"{name}: the name does not tell the mesh format; give one of {known}")


def read_mesh(source: PathOrFile, file_format: str | None = None) -> PolyMesh:
    """Read a mesh file.

    Parameters
    ----------
    source : path or binary file object
    file_format : str, optional
        One of `FORMATS`; by default the file name's extension tells.

    Returns
    -------
    PolyMesh
        Vertices and polygons in the order of the file, attributes, names; `faces` has the polygons
        cut into triangles. The meshes of a GLB scene are one, each in its place.

    Raises
    ------
    MeshError
        For an unknown format, a file that is not one of that format, and one without faces.
    OSError
        When the file cannot be opened or read.
    """
    name, known = _name(source), mesh_format(source, file_format)
    data = Path(source).read_bytes() if isinstance(source, (str, os.PathLike)) else source.read()
    try:
        with np.errstate(all="ignore"):  # what overflows is refused as not finite
            return checked(_READERS[known](data))
    except (OSError, MemoryError):
        raise
    except MeshError as error:
        raise MeshError(f"{name}: {error}") from None
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise MeshError(f"{name}: not readable as {known.upper()} ({reason})") from error


def written(mesh: PolyMesh, file_format: str) -> Written:
    """Return the bytes of a mesh file, and words for what they do not hold.

    The same mesh gives the same bytes. Positions are kept to the last bit by OBJ, OFF, PLY and an
    STL with names; a binary STL and GLB round them to float32. Texture coordinates count from the
    corner of the picture that the format has them count from.

    Parameters
    ----------
    mesh : PolyMesh
    file_format : str
        One of `FORMATS`.

    Raises
    ------
    MeshError
        For a mesh without faces, and one that the format cannot hold.
    """
    if len(mesh.offsets) < 2:
        raise MeshError("a mesh without faces is not written")
    return _WRITERS[file_format](with_origin(mesh, top_left=file_format == "glb"))


def mesh_bytes(mesh: PolyMesh, file_format: str) -> bytes:
    """Return the bytes of a mesh file; `written` also tells what they do not hold."""
    return written(mesh, file_format).data


def write_mesh(
    target: PathOrFile, mesh: PolyMesh, file_format: str | None = None
) -> tuple[str, ...]:
    """Write a mesh file; all its bytes are made before the first one is written.

    A file at a path appears whole or not at all; one that exists is replaced and keeps its
    permissions.

    Parameters
    ----------
    target : path or binary file object
    mesh : PolyMesh
        `polymesh.from_triangles` makes one of plain arrays.
    file_format : str, optional
        One of `FORMATS`; by default the file name's extension tells.

    Returns
    -------
    tuple of str
        Words for what the format has no place for.

    Raises
    ------
    MeshError
        For an unknown format, and a mesh that the format cannot hold.
    OSError
        When the file cannot be written.
    """
    made = written(mesh, mesh_format(target, file_format))
    write_file(target, made.data)
    return made.lost


def _name(target: PathOrFile) -> str:
    if isinstance(target, (str, os.PathLike)):
        return os.fspath(target)
    return str(getattr(target, "name", "") or "<stream>")
