"""Reader and writer of mesh files in any of the formats, by path or file object.

`deltamesh_formats.meshfiles.formats` has the table of the formats. A reader names in the mesh what
it has to leave out (`lost`); a writer returns descriptions of what its format has no place for.
"""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np

from deltamesh_formats.arguments import require, require_type, require_whole
from deltamesh_formats.atomic import PathOrFile, require_file, write_file
from deltamesh_formats.errors import FormatError, LimitError, MeshError
from deltamesh_formats.meshfiles.beside import in_folder
from deltamesh_formats.meshfiles.file_format import FileFormat, Written
from deltamesh_formats.meshfiles.float32 import rounding_error
from deltamesh_formats.meshfiles.formats import (
    FORMATS,
    MAX_DIGITS,
    READABLE,
    advice,
    format_of_extension,
)
from deltamesh_formats.meshfiles.number_text import with_places
from deltamesh_formats.places import parent, read_bytes
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.polymesh.texture_origin import marked_top_left, with_origin
from deltamesh_formats.polymesh.validation import check_arrays, check_indices, checked
from deltamesh_formats.wrappers import unwrapped, without_wrapper, wrapped

__all__ = ["mesh_bytes", "mesh_format", "read_mesh", "write_mesh", "written"]


def mesh_format(target: PathOrFile, file_format: str | None = None) -> FileFormat:
    """Return the format that is asked for or, without one, that of the file name's extension.

    That is the one before ".gz" or ".zst", if the name ends so.

    Raises
    ------
    MeshError
        When it is not in the table of the formats.
    """
    name = _name(target)
    if file_format is not None:
        require_type("file_format", file_format, str)
    asked = (file_format or Path(without_wrapper(name)[0]).suffix).removeprefix(".").lower()
    found = format_of_extension(asked)
    if found is not None:
        return found
    known = ", ".join(READABLE)
    if asked and advice(asked):
        raise MeshError(f"{name}: {asked!r} is not read: {advice(asked)}")
    if asked:
        raise MeshError(f"{name}: {asked!r} is not a known mesh format: {known}")
    raise MeshError(f"{name}: its name has no extension of a mesh format; give one of {known}")


def read_mesh(
    source: PathOrFile,
    file_format: str | None = None,
    *,
    folder: str | os.PathLike[str] | None = None,
) -> PolyMesh:
    """Read a mesh file, with gzip or zstandard around it or not.

    Parameters
    ----------
    source : path, URL or binary file object
        URLs take the extra `remote`. What is compressed is known by its first bytes, and
        decompresses to 16 GiB at most.
    file_format : str, optional
        Name of the format, such as "ply"; by default the one of the file name's extension.
    folder : path or URL, optional
        Where files that it names are, such as the buffers of a glTF; nothing outside is read. By
        default the folder of a path, and none for a file object, which has to be whole by itself.

    Returns
    -------
    PolyMesh
        Vertices and polygons in the order of the file, with attributes, names of parts and
        metadata; `lost` names what else the file has. The meshes of a scene become one mesh, each
        at its place.

    Raises
    ------
    MeshError
        For an unknown format, a file that is not one of that format, one without faces, and damaged
        compression.
    LimitError
        For a file that decompresses to more.
    OptionError
        For a format, or a folder, that is no text.
    OSError
        When the file cannot be opened or read.
    TypeError
        For anything but a path or a file.
    """
    name, known = _name(source), mesh_format(source, file_format)
    if folder is not None:
        fits = isinstance(folder, (str, os.PathLike))
        require(fits, "folder must be a path", folder)
    if isinstance(source, (str, os.PathLike)):
        data, home = read_bytes(source), parent(os.fspath(source))
    else:
        require_file(source, "read")
        data, home = source.read(), None
    home = home if folder is None else os.fspath(folder)
    try:
        data = unwrapped(data)
        with np.errstate(all="ignore"):  # what overflows is refused as not finite
            mesh = known.read(data, None if home is None else in_folder(home))
            mesh = checked(replace(mesh, format=mesh.format or known.name))
    except (OSError, MemoryError, LimitError):
        raise
    except FormatError as error:
        raise MeshError(f"{name}: {error}") from None
    except MeshError as error:
        raise type(error)(f"{name}: {error}") from None
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise MeshError(f"{name}: not readable as {known.title} ({reason})") from error
    return marked_top_left(mesh) if READABLE[mesh.format].has_top_left_textures else mesh


def written(mesh: PolyMesh, file_format: str, digits: int | None = None) -> Written:
    """Return the bytes of a mesh file, and descriptions of what they do not hold.

    The same mesh gives the same bytes. Positions are exact, or rounded by at most the margin of the
    mesh: to fewer digits in a text, to float32 in a PLY whose source had that. What loses more,
    because the format has nothing but float32 (binary STL, GLB), is described. Texture coordinates
    begin where the format has their origin.

    Parameters
    ----------
    mesh : PolyMesh
    file_format : str
        Name of the format.
    digits : int, optional
        Decimal places of the positions in a text, 0 to 20; binary formats have no use for it.
        Default: as many as the margin of the mesh asks for.

    Raises
    ------
    MeshError
        For a mesh without faces, and one that the format cannot hold.
    OptionError
        For digits that are not a number from 0 to 20.
    """
    if digits is not None:
        require_whole("digits", digits, 0, MAX_DIGITS)
    if len(mesh.offsets) < 2:
        raise MeshError("a mesh without faces is not written")
    known = READABLE[file_format]
    if known.write is None:
        raise MeshError(f"{known.title} is only read; written are {', '.join(FORMATS)}")
    placed = with_origin(mesh, top_left=known.has_top_left_textures)
    if digits is None or not known.is_text:
        return known.write(placed)
    vertices = with_places(mesh.vertices, digits)
    error = rounding_error(vertices, mesh.vertices)
    made = known.write(replace(placed, vertices=vertices, margin=0.0))
    if error <= mesh.margin:
        return made
    loss = f"positions beyond {digits} decimal places (by up to {error:.2g})"
    return made._replace(lost=(*made.lost, loss))


def mesh_bytes(mesh: PolyMesh, file_format: str) -> bytes:
    """Return the bytes of a mesh file; `written` also returns what they do not hold."""
    return written(mesh, file_format).data


def write_mesh(
    target: PathOrFile,
    mesh: PolyMesh,
    file_format: str | None = None,
    *,
    digits: int | None = None,
) -> tuple[str, ...]:
    """Write a mesh file; all its bytes are made before the first one is written.

    A file at a path appears whole or not at all; one that exists is replaced and keeps its
    permissions.

    Parameters
    ----------
    target : path, URL or binary file object
        A path or URL that ends in ".gz" or ".zst" gets a compressed file; a file object gets
        the bytes as they are.
    mesh : PolyMesh
        `deltamesh.from_arrays` makes one of plain arrays.
    file_format : str, optional
        Name of the format, such as "ply"; by default the one of the file name's extension.
    digits : int, optional
        Decimal places of the positions in a text, 0 to 20. Default: the fewest that lose nothing
        or, of a mesh that was decoded, a small share of the error that it has.

    Returns
    -------
    tuple of str
        Descriptions of what the format has no place for, and of positions that are rounded by more
        than that share.

    Raises
    ------
    MeshError
        For an unknown format, a mesh that the format cannot hold, or one whose arrays are at fault.
    OptionError
        For digits that are not a number from 0 to 20, and other arguments of a wrong type.
    OSError
        When the file cannot be written.
    TypeError
        For anything but a path or a file.
    """
    require_file(target, "write")
    require_type("mesh", mesh, PolyMesh)
    check_arrays(mesh)
    check_indices(mesh)
    made = written(mesh, mesh_format(target, file_format).name, digits)
    is_path = isinstance(target, (str, os.PathLike))
    write_file(target, wrapped(_name(target), made.data) if is_path else made.data)
    return made.lost


def _name(target: PathOrFile) -> str:
    if isinstance(target, (str, os.PathLike)):
        return os.fspath(target)
    return str(getattr(target, "name", "") or "<stream>")
