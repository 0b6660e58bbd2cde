"""Decoding of one file into another, for `decode` and `batch`."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Final

from deltamesh._progress import Progress
from deltamesh_cli import files
from deltamesh_cli.meshes import decode_container, further_frames, write_mesh_file
from deltamesh_formats.meshfiles.formats import FORMATS, format_of_extension, written_format
from deltamesh_formats.wrappers import without_wrapper

if TYPE_CHECKING:
    from deltamesh_formats.container.container import Container
    from deltamesh_formats.polymesh.mesh import PolyMesh

# The format for a file that names no format of its own: binary, bit for bit, widely supported.
_FALLBACK_FORMAT: Final = "ply"


def output_name_and_format(
    source: str, target: str | None, output_format: str | None, stored: str
) -> tuple[str, str]:
    """Return the name and the format of the mesh file to write.

    Parameters
    ----------
    source : str
        Name of the `.dmesh` file.
    target, output_format : str or None
        The name and the format that the user asked for.
    stored : str
        The format that was encoded, as the file stores it; "" if it stores none.
    """
    name = (files.without_suffix(source) or source) if target is None else target
    named = written_format(files.extension(name))
    original = stored if stored in FORMATS else _FALLBACK_FORMAT
    file_format = output_format or (original if named is None else named.name)
    if target is not None or (named is not None and named.name == file_format):
        return name, file_format
    stem, wrapper = without_wrapper(name)
    if format_of_extension(files.extension(name)) is not None:  # of a mesh, but of another one
        stem = os.path.splitext(stem)[0]
    return f"{stem}.{FORMATS[file_format].extensions[0]}{wrapper}", file_format


def decode_to_file(
    target: str,
    file_format: str,
    source: str,
    container: Container,
    progress: Progress,
    parameters: dict[str, Any],
    *,
    partial: bool = False,
    force: bool,
) -> tuple[PolyMesh, tuple[str, ...]]:
    """Decode a `.dmesh` file and write its mesh.

    Parameters
    ----------
    target, file_format : str
        Name and format of the mesh file.
    source : str
        Name of the `.dmesh` file.
    container : Container
        The sections of the `.dmesh` file.
    progress : callable
    parameters : dict
        Keywords of `deltamesh.decode`, None for those that the user did not give, and "digits",
        the decimal places of positions in a text. Without "frame", frame 0 of a sequence is
        decoded, and the others are lost.
    partial : bool
        Whether the file may be cut.
    force : bool
        Whether an existing mesh file is overwritten.

    Returns
    -------
    mesh : PolyMesh
    lost : tuple of str
        Descriptions of the content that the format of the mesh file cannot hold.

    Raises
    ------
    Failure
        If the file cannot be decoded, or the mesh file cannot be written.
    """
    keywords = {name: value for name, value in parameters.items() if name != "digits"}
    mesh = decode_container(source, container, progress, partial=partial, **keywords)
    progress("writing")
    digits = parameters.get("digits")
    lost = write_mesh_file(target, mesh, file_format, digits, force=force)
    if parameters.get("frame") is None:
        lost += further_frames(source, container)
    return mesh, lost
