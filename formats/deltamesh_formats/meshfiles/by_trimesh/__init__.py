"""Formats that trimesh reads (github.com/mikedh/trimesh): COLLADA, with the package pycollada."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from deltamesh_formats.meshfiles.file_format import FileFormat

if TYPE_CHECKING:
    from deltamesh_formats.meshfiles.beside import Beside
    from deltamesh_formats.polymesh.mesh import PolyMesh


def _read(data: bytes, beside: Beside | None) -> PolyMesh:
    from deltamesh_formats.meshfiles.by_trimesh.reader import read_collada

    return read_collada(data)


COLLADA: Final = FileFormat(
    name="dae",
    title="COLLADA",
    extensions=("dae",),
    bytes_per_vertex=24,
    parts=("object", "material"),
    metadata=("units",),
    read=_read,
)
