"""glTF 2.0 as JSON, with its buffers in the text or in files beside it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from deltamesh_formats.meshfiles.file_format import Written
from deltamesh_formats.meshfiles.glb import GLB

if TYPE_CHECKING:
    from deltamesh_formats.meshfiles.beside import Beside
    from deltamesh_formats.polymesh.mesh import PolyMesh


def _read(data: bytes, beside: Beside | None) -> PolyMesh:
    from deltamesh_formats.meshfiles.glb.chunks import read_json
    from deltamesh_formats.meshfiles.glb.reader import read

    return read(read_json(data, beside))


def _names_beside(data: bytes) -> list[str]:
    from deltamesh_formats.meshfiles.glb.chunks import names_beside

    return names_beside(data)


def _write(mesh: PolyMesh) -> Written:
    """Write one file: the buffer is a data URI in it."""
    import base64
    import json

    from deltamesh_formats.meshfiles.glb.writer import made

    tree, buffer, lost = made(mesh, GLTF)
    uri = f"data:application/octet-stream;base64,{base64.b64encode(buffer).decode()}"
    tree["buffers"][0]["uri"] = uri
    return Written(json.dumps(tree, separators=(",", ":")).encode(), lost)


GLTF: Final = replace(
    GLB,
    name="gltf",
    title="glTF",
    extensions=("gltf",),
    beginnings=(),
    read=_read,
    names_beside=_names_beside,
    write=_write,
)
