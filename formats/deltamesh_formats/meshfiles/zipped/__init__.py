"""ZIP with one mesh file in it, and the files that belong to that."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from deltamesh_formats.meshfiles.file_format import FileFormat

if TYPE_CHECKING:
    from deltamesh_formats.meshfiles.beside import Beside
    from deltamesh_formats.polymesh.mesh import PolyMesh


def _read(data: bytes, beside: Beside | None) -> PolyMesh:
    from deltamesh_formats.meshfiles.zipped.reader import read

    return read(data)


ZIP: Final = FileFormat(
    name="zip",
    title="ZIP",
    extensions=("zip",),
    bytes_per_vertex=10,  # packed; measured on meshes of few digits
    read=_read,
)
