"""STL (stereolithography), as text and binary."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from deltamesh_formats.meshfiles.file_format import FileFormat, Written

if TYPE_CHECKING:
    from deltamesh_formats.meshfiles.beside import Beside
    from deltamesh_formats.polymesh.mesh import PolyMesh


def _read(data: bytes, beside: Beside | None) -> PolyMesh:
    from deltamesh_formats.meshfiles.stl.reader import read

    return read(data)


def _write(mesh: PolyMesh) -> Written:
    from deltamesh_formats.meshfiles.stl.writer import write

    return write(mesh)


STL: Final = FileFormat(
    name="stl",
    title="STL",
    extensions=("stl",),
    beginnings=(b"solid",),
    bytes_per_vertex=100,  # binary: two facets
    parts=("object",),
    metadata=("header",),
    read=_read,
    write=_write,
)
