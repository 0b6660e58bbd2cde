"""PLY, the Stanford polygon file format, as text and binary."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from deltamesh_formats.meshfiles.file_format import FileFormat, Written

if TYPE_CHECKING:
    from deltamesh_formats.meshfiles.beside import Beside
    from deltamesh_formats.polymesh.mesh import PolyMesh


def _read(data: bytes, beside: Beside | None) -> PolyMesh:
    from deltamesh_formats.meshfiles.ply.reader import read

    return read(data)


def _write(mesh: PolyMesh) -> Written:
    from deltamesh_formats.meshfiles.ply.writer import write

    return write(mesh)


PLY: Final = FileFormat(
    name="ply",
    title="PLY",
    extensions=("ply",),
    beginnings=(b"ply",),
    bytes_per_vertex=38,  # binary: 32-bit numbers
    polygons=True,
    metadata=("comments", "obj_info"),
    read=_read,
    write=_write,
)
