"""OFF, the format of Geomview, as text and binary."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from deltamesh_formats.meshfiles.file_format import FileFormat, Written

if TYPE_CHECKING:
    from deltamesh_formats.meshfiles.beside import Beside
    from deltamesh_formats.polymesh.mesh import PolyMesh


def _read(data: bytes, beside: Beside | None) -> PolyMesh:
    from deltamesh_formats.meshfiles.off.reader import read

    return read(data)


def _write(mesh: PolyMesh) -> Written:
    from deltamesh_formats.meshfiles.off.writer import write

    return write(mesh)


OFF: Final = FileFormat(
    name="off",
    title="OFF",
    extensions=("off",),
    beginnings=(b"OFF", b"COFF", b"NOFF", b"CNOFF", b"STOFF"),
    is_text=True,
    bytes_per_vertex=50,  # short decimal numbers
    polygons=True,
    gaps=("face",),
    metadata=("comments",),
    read=_read,
    write=_write,
)
