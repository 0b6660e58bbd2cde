"""Accessors of a glTF, as arrays.

glTF 2.0 (Khronos Group, 2021), section 3.6. Counts of a file are checked against its length before
anything is allocated.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.glb.compression import (
    DRACO,
    MESHOPT,
    draco_arrays,
    meshopt_bytes,
)
from deltamesh_formats.meshfiles.glb.schema import EACH, Tree, check, items, shown

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
    """JSON of a file, and the bytes of its buffers.

    Attributes
    ----------
    tree : mapping
    buffers : list of bytes
    unpacked : dict
        Buffer views that were compressed, by their numbers.
    decoded : dict
        Accessors whose numbers are in Draco data, by their numbers; the view that these are in.
    """

    tree: Tree
    buffers: list[bytes]
    unpacked: dict[int, bytes] = field(default_factory=dict)
    decoded: dict[int, tuple[int, NDArray[Any]]] = field(default_factory=dict)

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
        if index in self.decoded:
            return self.decoded[index][1]
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
        buffer, begin, length = self._bytes_of_view(index, view)
        columns, rows = shape
        column = rows * kind.itemsize
        if columns > 1:
            column += -column % 4
        size = columns * column
        stride = whole(view, "byteStride", 0) or size
        if stride < size:
            raise MeshError(f"the elements of buffer view {index} overlap")
        needed = start + (count - 1) * stride + size if count else 0
        if needed > length or begin + length > len(buffer):
            message = f"buffer view {index} would end at byte {begin + max(needed, length)}"
            raise MeshError(f"{message} of a buffer of {len(buffer)}")
        if not count:
            return np.empty((0, columns * rows), dtype=kind)
        strides = (stride, column, kind.itemsize)
        found = np.ndarray((count, columns, rows), kind, buffer, begin + start, strides)
        return found.astype(kind, order="C").reshape(count, columns * rows)

    def _bytes_of_view(self, index: object, view: Tree) -> tuple[bytes, int, int]:
        """Return the bytes in which a buffer view is, its first byte in them, and its length."""
        length, extensions = whole(view, "byteLength"), view.get("extensions", {})
        packed = next((extensions[name] for name in MESHOPT if name in extensions), None)
        if packed is None:
            return self._buffer(view), whole(view, "byteOffset", 0), length
        assert isinstance(index, int)
        if index not in self.unpacked:
            if not isinstance(packed, dict):
                raise MeshError(f"the compression of buffer view {index} is no object")
            begin, size = whole(packed, "byteOffset", 0), whole(packed, "byteLength")
            data = self._buffer(packed)[begin : begin + size]
            if len(data) < size:
                raise MeshError(f"buffer view {index} would end at byte {begin + size}")
            count, stride = whole(packed, "count"), whole(packed, "byteStride")
            if count * stride != length:
                raise MeshError(f"buffer view {index} is not {count} rows of {stride} bytes")
            mode, filter_ = packed.get("mode"), packed.get("filter", "NONE")
            self.unpacked[index] = meshopt_bytes(data, count, stride, mode, filter_)
        return self.unpacked[index], 0, length

    def _buffer(self, view: Tree) -> bytes:
        number = whole(view, "buffer")
        if number >= len(self.buffers):
            raise MeshError(f"it refers to buffer {number}, of {len(self.buffers)}")
        return self.buffers[number]

    def decode_draco(self, primitive: Tree) -> None:
        """Decode the indices and attributes of a primitive, if they are in Draco data.

        Raises
        ------
        MeshError
            When they do not fit the accessors.
        """
        packed = primitive.get("extensions", {}).get(DRACO)
        if packed is None:
            return
        check(packed, {"bufferView": "a number", "attributes": {EACH: "a number"}}, DRACO)
        number, ids = packed.get("bufferView"), packed.get("attributes", {})
        accessors = primitive.get("attributes", {})
        wanted = {ids[name]: accessors[name] for name in ids if name in accessors}
        some = [*wanted.values(), primitive.get("indices")]
        if all(self.decoded.get(one, (None,))[0] == number for one in some):
            return
        view = self.item("bufferViews", number)
        buffer, begin, length = self._bytes_of_view(number, view)
        faces, arrays = draco_arrays(buffer[begin : begin + length])
        self._keep(primitive.get("indices"), number, faces.reshape(-1, 1))
        for id_, accessor in wanted.items():
            if id_ not in arrays:
                raise MeshError(f"its Draco data have no attribute {id_}")
            self._keep(accessor, number, arrays[id_])

    def _keep(self, index: object, view: int, values: NDArray[Any]) -> None:
        """Keep the numbers of an accessor that were in Draco data, in the type that it has."""
        accessor = self.item("accessors", index)
        assert isinstance(index, int)
        kind, shape = _component(accessor), _SHAPES.get(accessor.get("type", ""), (0, 0))
        fits = values.shape == (whole(accessor, "count"), shape[0] * shape[1])
        if not fits or (values.dtype.kind == "f") != (kind.kind == "f"):
            raise MeshError(f"accessor {index} does not fit its Draco data")
        if self.decoded.setdefault(index, (view, values.astype(kind)))[0] != view:
            raise MeshError(f"accessor {index} is in several Draco data")

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
