"""Chunks, buffers and accessors of a GLB, as JSON and arrays.

glTF 2.0 (Khronos Group, 2021): section 4 for the chunks, 3.6 for buffers and accessors. Counts of a
file are checked against its length before anything is allocated.
"""

from __future__ import annotations

import base64
import binascii
import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.glb.extensions import COMPRESSED, check_required
from deltamesh_formats.meshfiles.glb.schema import Tree, check_types, items, shown

MAGIC: Final = b"glTF"
JSON_CHUNK: Final = b"JSON"
BINARY_CHUNK: Final = b"BIN\0"
COMPONENTS: Final[Mapping[int, str]] = {
    5120: "i1",
    5121: "u1",
    5122: "i2",
    5123: "u2",
    5125: "u4",
    5126: "f4",
}
# Columns of the elements of each type, and rows; each column of a matrix begins at a multiple of 4.
_SHAPES: Final[Mapping[str, tuple[int, int]]] = {
    "SCALAR": (1, 1),
    "VEC2": (1, 2),
    "VEC3": (1, 3),
    "VEC4": (1, 4),
    "MAT2": (2, 2),
    "MAT3": (3, 3),
    "MAT4": (4, 4),
}


@dataclass(frozen=True)
class Gltf:
    """JSON of a file, and the bytes of its buffers."""

    tree: Tree
    buffers: list[bytes]

    def items(self, name: str) -> list[Any]:
        """Return a list at the top of the JSON, empty if it is not there."""
        return items(self.tree, name)

    def item(self, name: str, index: object) -> Tree:
        """Return an object of such a list by its index.

        Raises
        ------
        MeshError
            For an index out of range.
        """
        found = self.items(name)
        if not isinstance(index, int) or not 0 <= index < len(found):
            raise MeshError(f"it refers to {name} {shown(index)}, of {len(found)}")
        return found[index]  # type: ignore[no-any-return]

    def accessor(self, index: object) -> NDArray[Any]:
        """Return the numbers of an accessor, (count, width), in the type of its components."""
        accessor = self.item("accessors", index)
        if "bufferView" not in accessor and "sparse" not in accessor:
            raise MeshError(f"accessor {index} has no data: it may be compressed")
        count, start = whole(accessor, "count"), whole(accessor, "byteOffset", 0)
        kind = _component(accessor)
        shape = _SHAPES.get(accessor.get("type", ""))
        if shape is None:
            raise MeshError(f"accessor {index} has the unknown type {shown(accessor.get('type'))}")
        width = shape[0] * shape[1]
        if "bufferView" in accessor:
            values = self._view(accessor["bufferView"], start, count, shape, kind)
        else:
            if count > sum(map(len, self.buffers)):
                raise MeshError(f"accessor {index} has {count} elements but hardly any data")
            values = np.zeros((count, width), dtype=kind)
        if "sparse" in accessor:
            self._replace(values, accessor["sparse"], shape, kind)
        return values

    def _view(
        self, index: object, start: int, count: int, shape: tuple[int, int], kind: np.dtype[Any]
    ) -> NDArray[Any]:
        """Return a copy of numbers in a buffer view, (count, columns * rows)."""
        view = self.item("bufferViews", index)
        if any(name in view.get("extensions", {}) for name in COMPRESSED):
            raise MeshError(f"buffer view {index} is compressed, which is not read")
        number = whole(view, "buffer")
        if number >= len(self.buffers):
            raise MeshError(f"it refers to buffer {number}, of {len(self.buffers)}")
        begin, length = whole(view, "byteOffset", 0), whole(view, "byteLength")
        columns, rows = shape
        column = rows * kind.itemsize
        if columns > 1:
            column += -column % 4
        size = columns * column
        stride = whole(view, "byteStride", 0) or size
        if stride < size:
            raise MeshError(f"the elements of buffer view {index} overlap")
        needed = start + (count - 1) * stride + size if count else 0
        if needed > length or begin + length > len(self.buffers[number]):
            message = f"buffer view {index} would end at byte {begin + max(needed, length)}"
            raise MeshError(f"{message} of a buffer of {len(self.buffers[number])}")
        if not count:
            return np.empty((0, columns * rows), dtype=kind)
        data, strides = self.buffers[number], (stride, column, kind.itemsize)
        found = np.ndarray((count, columns, rows), kind, data, begin + start, strides)
        return found.astype(kind, order="C").reshape(count, columns * rows)

    def _replace(
        self, values: NDArray[Any], sparse: Tree, shape: tuple[int, int], kind: np.dtype[Any]
    ) -> None:
        """Replace the elements that a sparse accessor lists."""
        for name in ("indices", "values"):
            if "bufferView" not in sparse.get(name, {}):
                raise MeshError(f"a sparse accessor has no {name} in a buffer view")
        count, at, new = whole(sparse, "count"), sparse["indices"], sparse["values"]
        start = whole(at, "byteOffset", 0)
        indices = self._view(at["bufferView"], start, count, (1, 1), _component(at)).ravel()
        start = whole(new, "byteOffset", 0)
        numbers = self._view(new["bufferView"], start, count, shape, kind)
        if count and int(indices.max()) >= len(values):
            raise MeshError(f"a sparse accessor replaces element {indices.max()} of {len(values)}")
        values[indices.astype(np.int64)] = numbers


def whole(tree: Tree, name: str, default: int | None = None) -> int:
    """Return a count, or another whole number from 0, in an object."""
    value = tree.get(name, default)
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**53:
        raise MeshError(f"its {name} is {shown(value)}, not a count")
    return value


def reals(tree: Tree, name: str, count: int) -> Floats | None:
    """Return a list of `count` finite numbers in an object, None if it is not there."""
    if name not in tree:
        return None
    found = tree[name]
    fits = isinstance(found, list) and len(found) == count
    # JSON has whole numbers of any size; true is none, though Python counts it as one.
    largest = sys.float_info.max
    if not fits or not all(type(x) in (int, float) and abs(x) <= largest for x in found):
        raise MeshError(f"a node's {name} is not {count} numbers")
    return np.array(found, dtype=np.float64)


def _component(accessor: Tree) -> np.dtype[Any]:
    code = whole(accessor, "componentType")
    if code not in COMPONENTS:
        raise MeshError(f"there is no component type {code}")
    return np.dtype("<" + COMPONENTS[code])


def read_chunks(data: bytes) -> Gltf:
    """Read the chunks of a GLB.

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
    try:
        tree = json.loads(chunks[JSON_CHUNK])
    except json.JSONDecodeError as error:
        raise MeshError(f"its JSON is not readable: {error}") from None
    except UnicodeDecodeError:
        raise MeshError("its JSON is not UTF-8") from None
    except (ValueError, RecursionError):
        raise MeshError("its JSON has a number that is too long, or too many brackets") from None
    if not isinstance(tree, dict):
        raise MeshError("its JSON is not an object")
    check_types(tree)
    check_required(tree)
    return Gltf(tree, _buffers(tree, chunks.get(BINARY_CHUNK, b"")))


def _buffers(tree: Tree, binary: bytes) -> list[bytes]:
    found = []
    for i, buffer in enumerate(items(tree, "buffers")):
        uri = buffer.get("uri")
        if uri is None:
            found.append(binary if i == 0 else b"")
        elif isinstance(uri, str) and uri.startswith("data:") and ";base64," in uri:
            try:
                found.append(base64.b64decode(uri.partition(",")[2]))
            except binascii.Error as error:
                raise MeshError(f"buffer {i} is not readable: {error}") from None
        else:
            raise MeshError(f"buffer {i} is in another file, {shown(uri)}: it is not read")
    return found
