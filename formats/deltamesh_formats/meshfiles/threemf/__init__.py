"""3MF, the format of 3D printing: a ZIP with XML in it (3MF Consortium, Core Specification 1.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from deltamesh_formats.meshfiles.file_format import FileFormat, Written

if TYPE_CHECKING:
    from deltamesh_formats.meshfiles.beside import Beside
    from deltamesh_formats.polymesh.mesh import PolyMesh


def _read(data: bytes, beside: Beside | None) -> PolyMesh:
    from deltamesh_formats.meshfiles.threemf.reader import read

    return read(data)


def _write(mesh: PolyMesh) -> Written:
    from deltamesh_formats.meshfiles.threemf.writer import write

    return write(mesh)


THREEMF: Final = FileFormat(
    name="3mf",
    title="3MF",
    extensions=("3mf",),
    bytes_per_vertex=10,  # packed; measured on meshes of few digits
    gaps=("vertex", "corner", "face"),
    parts=("object", "material"),
    metadata=("units",),
    read=_read,
    write=_write,
)
