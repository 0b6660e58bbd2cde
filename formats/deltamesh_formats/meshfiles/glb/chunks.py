"""Chunks of a GLB, the JSON of a glTF, and its buffers.

glTF 2.0 (Khronos Group, 2021): section 4 for the chunks, 3.6.1 for buffers.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Final

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.beside import Beside
from deltamesh_formats.meshfiles.glb.accessors import Gltf, whole
from deltamesh_formats.meshfiles.glb.extensions import check_required
from deltamesh_formats.meshfiles.glb.outside import name_of_file, outside_bytes
from deltamesh_formats.meshfiles.glb.schema import Tree, check_types, items, shown

MAGIC: Final = b"glTF"
JSON_CHUNK: Final = b"JSON"
BINARY_CHUNK: Final = b"BIN\0"


def read_chunks(data: bytes, beside: Beside | None = None) -> Gltf:
    """Read the chunks of a GLB, and buffers in files beside it.

    Raises
    ------
    MeshError
        For bytes that are not a GLB, and one that needs an extension that is not read.
    """
    if data[:4] != MAGIC:
        raise MeshError("it does not begin with 'glTF'")
    version, length = (int.from_bytes(data[i : i + 4], "little") for i in (4, 8))
    if version != 2:
        raise MeshError(f"it is glTF version {version}, not 2")
    if length > len(data):
        raise MeshError(
            f"its header announces {length} bytes, it has {len(data)}: is it cut short?"
        )
    chunks: dict[bytes, bytes] = {}
    at = 12
    while at + 8 <= length:
        size, kind = int.from_bytes(data[at : at + 4], "little"), data[at + 4 : at + 8]
        if at + 8 + size > length:
            raise MeshError(f"a chunk at byte {at} has {size} bytes: is it cut short?")
        chunks.setdefault(kind, data[at + 8 : at + 8 + size])
        at += 8 + size
    if JSON_CHUNK not in chunks:
        raise MeshError("it has no JSON")
    return read_json(chunks[JSON_CHUNK], beside, chunks.get(BINARY_CHUNK, b""))


def read_json(text: bytes, beside: Beside | None, binary: bytes = b"") -> Gltf:
    """Read the JSON of a glTF, and its buffers.

    Parameters
    ----------
    text : bytes
    beside : callable, optional
        The files in which other buffers are; None where there are none.
    binary : bytes
        The first buffer, if it has no URI.

    Raises
    ------
    MeshError
        For what is not JSON of a glTF 2.0, and one that needs an extension that is not read.
    """
    tree = _json(text)
    check_types(tree)
    check_required(tree)
    return Gltf(tree, list(_buffers(tree, beside, binary)))


def names_beside(text: bytes) -> list[str]:
    """Return the relative paths of the files in which the buffers of a glTF are.

    Raises
    ------
    MeshError
        For what is not JSON of a glTF 2.0.
    """
    tree = _json(text)
    check_types(tree)
    names = (name_of_file(buffer.get("uri", "")) for buffer in items(tree, "buffers"))
    return [name for name in names if name]


def _json(text: bytes) -> Tree:
    """Return the JSON of a file, if it is that of glTF 2."""
    try:
        tree = json.loads(text)
    except json.JSONDecodeError as error:
        raise MeshError(f"its JSON is not readable: {error}") from None
    except UnicodeDecodeError:
        raise MeshError("its JSON is not UTF-8") from None
    except (ValueError, RecursionError):
        raise MeshError("its JSON has a number that is too long, or too many brackets") from None
    if not isinstance(tree, dict):
        raise MeshError("its JSON is not an object")
    asset = tree.get("asset")
    version = asset.get("version") if isinstance(asset, dict) else None
    if version is not None and str(version).partition(".")[0] != "2":
        raise MeshError(f"it is glTF version {shown(version)}, not 2")
    return tree


def _buffers(tree: Tree, beside: Beside | None, binary: bytes) -> Iterator[bytes]:
    for i, buffer in enumerate(items(tree, "buffers")):
        uri = buffer.get("uri")
        if uri is None:
            yield binary if i == 0 else b""
            continue
        try:
            yield outside_bytes(uri, beside, whole(buffer, "byteLength", 2**53 - 1))
        except MeshError as error:
            raise MeshError(f"buffer {i} {error}") from None
