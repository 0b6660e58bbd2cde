"""Reader and writer of mesh files in any of the formats, by path or file object.

`deltamesh_formats.meshfiles.formats` has the table of the formats. A reader names in the mesh what
it has to leave out (`lost`); a writer returns descriptions of what its format has no place for.
"""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np

from deltamesh_formats.atomic import PathOrFile, write_file
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.file_format import FileFormat, Written
from deltamesh_formats.meshfiles.formats import FORMATS, format_of_extension
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.polymesh.texture_origin import marked_top_left, with_origin
from deltamesh_formats.polymesh.validation import checked

__all__ = ["mesh_bytes", "mesh_format", "read_mesh", "write_mesh", "written"]


def mesh_format(target: PathOrFile, file_format: str | None = None) -> FileFormat:
    """Return the format that is asked for or, without one, that of the file name's extension.

    Raises
    ------
    MeshError
        When it is not in the table of the formats.
    """
    name = _name(target)
    asked = (file_format or Path(name).suffix).removeprefix(".").lower()
    found = format_of_extension(asked)
    if found is not None:
        return found
    known = ", ".join(FORMATS)
    if asked:
        raise MeshError(f"{name}: {asked!r} is not a known mesh format: {known}")
    raise MeshError(f"{name}: its name has no extension of a mesh format; give one of {known}")


def read_mesh(source: PathOrFile, file_format: str | None = None) -> PolyMesh:
    """Read a mesh file.

    Parameters
    ----------
    source : path or binary file object
    file_format : str, optional
        Name of the format, such as "ply"; by default the one of the file name's extension.

    Returns
    -------
    PolyMesh
        Vertices and polygons in the order of the file, with attributes, names of parts and
        metadata; `lost` names what else the file has. The meshes of a scene become one mesh, each
        at its place.

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
            mesh = checked(replace(known.read(data), format=known.name))
    except (OSError, MemoryError):
        raise
    except MeshError as error:
        raise type(error)(f"{name}: {error}") from None
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise MeshError(f"{name}: not readable as {known.title} ({reason})") from error
    return marked_top_left(mesh) if known.has_top_left_textures else mesh


def written(mesh: PolyMesh, file_format: str) -> Written:
    """Return the bytes of a mesh file, and descriptions of what they do not hold.

    The same mesh gives the same bytes. Positions are exact, or float32 where the format has
    nothing else (binary STL, GLB). Texture coordinates begin where the format has their origin.

    Parameters
    ----------
    mesh : PolyMesh
    file_format : str
        Name of the format.

    Raises
    ------
    MeshError
        For a mesh without faces, and one that the format cannot hold.
    """
    if len(mesh.offsets) < 2:
        raise MeshError("a mesh without faces is not written")
    known = FORMATS[file_format]
    return known.write(with_origin(mesh, top_left=known.has_top_left_textures))


def mesh_bytes(mesh: PolyMesh, file_format: str) -> bytes:
    """Return the bytes of a mesh file; `written` also returns what they do not hold."""
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
        `deltamesh.from_arrays` makes one of plain arrays.
    file_format : str, optional
        Name of the format, such as "ply"; by default the one of the file name's extension.

    Returns
    -------
    tuple of str
        Descriptions of what the format has no place for.

    Raises
    ------
    MeshError
        For an unknown format, and a mesh that the format cannot hold.
    OSError
        When the file cannot be written.
    """
    made = written(mesh, mesh_format(target, file_format).name)
    write_file(target, made.data)
    return made.lost


def _name(target: PathOrFile) -> str:
    if isinstance(target, (str, os.PathLike)):
        return os.fspath(target)
    return str(getattr(target, "name", "") or "<stream>")
