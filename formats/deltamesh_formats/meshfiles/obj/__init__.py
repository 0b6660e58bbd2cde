"""Wavefront OBJ, a text format."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from deltamesh_formats.meshfiles.file_format import FileFormat, Written

if TYPE_CHECKING:
    from deltamesh_formats.meshfiles.beside import Beside
    from deltamesh_formats.polymesh.mesh import PolyMesh


def _read(data: bytes, beside: Beside | None) -> PolyMesh:
    from deltamesh_formats.meshfiles.obj.reader import read

    return read(data)


def _write(mesh: PolyMesh) -> Written:
    from deltamesh_formats.meshfiles.obj.writer import write

    return write(mesh)


OBJ: Final = FileFormat(
    name="obj",
    title="OBJ",
    extensions=("obj",),
    is_text=True,
    bytes_per_vertex=50,  # short decimal numbers
    polygons=True,
    gaps=("vertex", "corner"),
    parts=("object", "group", "material", "smoothing"),
    metadata=("comments", "mtllib"),
    read=_read,
    write=_write,
)
