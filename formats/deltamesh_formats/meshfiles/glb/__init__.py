"""GLB, the binary form of glTF 2.0."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from deltamesh_formats.meshfiles.file_format import FileFormat, Written

if TYPE_CHECKING:
    from deltamesh_formats.meshfiles.beside import Beside
    from deltamesh_formats.polymesh.mesh import PolyMesh


def _read(data: bytes, beside: Beside | None) -> PolyMesh:
    from deltamesh_formats.meshfiles.glb.chunks import read_chunks
    from deltamesh_formats.meshfiles.glb.reader import read

    return read(read_chunks(data, beside))


def _write(mesh: PolyMesh) -> Written:
    from deltamesh_formats.meshfiles.glb.writer import glb_bytes, made

    tree, buffer, lost = made(mesh, GLB)
    return Written(glb_bytes(tree, buffer), lost)


GLB: Final = FileFormat(
    name="glb",
    title="GLB",
    extensions=("glb",),
    beginnings=(b"glTF",),
    bytes_per_vertex=24,  # three float32, six 16-bit indices
    unit="meter",
    has_top_left_textures=True,
    transforms=True,
    gaps=("vertex", "corner"),
    parts=("object", "mesh", "material"),
    metadata=("copyright",),
    read=_read,
    write=_write,
)
