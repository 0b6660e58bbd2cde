"""Writer of PLY, binary and little-endian."""

from __future__ import annotations

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.meshfiles import text
from deltamesh_formats.meshfiles.file_format import Written
from deltamesh_formats.meshfiles.float32 import stored_positions
from deltamesh_formats.meshfiles.ply import PLY
from deltamesh_formats.meshfiles.ply.properties import (
    INDICES,
    NAMES,
    POSITION,
    WEDGE_UV,
    properties_of,
)
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh
from deltamesh_formats.polymesh.names import distinct_names
from deltamesh_formats.polymesh.permutations import distinct

_METADATA: Final = {"comments": "comment", "obj_info": "obj_info"}


class _List(NamedTuple):
    """List property of the faces, with as many numbers for each corner: values (c, width)."""

    name: str
    values: NDArray[Any]


def write(mesh: PolyMesh) -> Written:
    """Write a PLY: attributes with their names and types, and positions."""
    kept = []
    for attribute in mesh.attributes:
        values = _known_type(attribute.dense())
        if values is not None:
            kept.append((attribute, values))
    position = stored_positions(mesh)
    vertex = [(name, position[:, i]) for i, name in enumerate(POSITION)]
    vertex += _scalars([pair for pair in kept if pair[0].domain == "vertex"], POSITION)
    lists = [_List(INDICES[0], _indices(mesh))] + [
        _List(_list_name(attribute), values)
        for attribute, values in kept
        if attribute.domain == "corner"
    ]
    names = distinct_names((each.name for each in lists), reserved=POSITION, stem="list")
    lists = [each._replace(name=name) for each, name in zip(lists, names, strict=True)]
    face = _scalars([pair for pair in kept if pair[0].domain == "face"], names)
    counts = [_count_type(mesh, each) for each in lists]
    header = ["ply", "format binary_little_endian 1.0"]
    for key, word in _METADATA.items():
        header += [f"{word} {text.one_line(line)}" for line in mesh.metadata.get(key, ())]
    header += [f"element vertex {len(mesh.vertices)}", *_properties(vertex)]
    header += [f"element face {len(mesh.sizes)}"]
    for each, count in zip(lists, counts, strict=True):
        kind = NAMES[each.values.dtype.str[1:]]
        header.append(f"property list {NAMES[count]} {kind} {each.name}")
    head = "\n".join([*header, *_properties(face), "end_header", ""]).encode(*text.ENCODING)
    body = _records(vertex).data, _face_bytes(mesh, lists, counts, face).data
    return Written(b"".join((head, *body)), PLY.losses(mesh, [attribute for attribute, _ in kept]))


def _known_type(values: NDArray[Any]) -> NDArray[Any] | None:
    """Return numbers in a little-endian type of PLY that holds them all, or None."""
    kind = values.dtype.str[1:]
    if kind in NAMES:
        return values.astype("<" + kind)
    wider = {"b1": "u1", "f2": "f4"}.get(kind)
    if wider is not None:
        return values.astype("<" + wider)
    if kind in ("i8", "u8"):
        for fitting in ("i4", "u4"):
            limits = np.iinfo(fitting)
            if limits.min <= values.min(initial=0) and values.max(initial=0) <= limits.max:
                return values.astype("<" + fitting)
        if np.abs(values.astype(float)).max(initial=0) <= 2**53:
            return values.astype("<f8")
    return None


def _property_name(name: str) -> str:
    return "_".join(name.split()) or "property"


def _scalars(
    attributes: list[tuple[Attribute, NDArray[Any]]], taken: Any
) -> list[tuple[str, NDArray[Any]]]:
    """Return names and values of the properties of some attributes."""
    columns = [
        (_property_name(name), values[:, i])
        for attribute, values in attributes
        for i, name in enumerate(properties_of(attribute.name, attribute.width))
    ]
    names = distinct_names((name for name, _ in columns), reserved=taken, stem="property")
    return [(name, values) for name, (_, values) in zip(names, columns, strict=True)]


def _list_name(attribute: Attribute) -> str:
    return WEDGE_UV if attribute.name == "uv" else _property_name(attribute.name)


def _properties(columns: list[tuple[str, NDArray[Any]]]) -> list[str]:
    return [f"property {NAMES[values.dtype.str[1:]]} {name}" for name, values in columns]


def _records(columns: list[tuple[str, NDArray[Any]]]) -> NDArray[np.void]:
    kind = [(f"f{i}", values.dtype.newbyteorder("<")) for i, (_, values) in enumerate(columns)]
    count = len(columns[0][1]) if columns else 0
    records = np.empty(count, dtype=kind)
    for (field, _), (_, values) in zip(kind, columns, strict=True):
        records[field] = values
    return records


def _indices(mesh: PolyMesh) -> NDArray[Any]:
    return mesh.corners.astype("<i4" if len(mesh.vertices) <= 2**31 else "<u4")[:, None]


def _count_type(mesh: PolyMesh, each: _List) -> str:
    longest = int(mesh.sizes.max(initial=0)) * each.values.shape[1]
    return next(kind for kind in ("u1", "u2", "u4") if longest <= np.iinfo(kind).max)


def _face_bytes(
    mesh: PolyMesh,
    lists: list[_List],
    counts: list[str],
    columns: list[tuple[str, NDArray[Any]]],
) -> NDArray[np.uint8]:
    """Return the bytes of the faces; records of one size are packed as one array."""
    sizes = mesh.sizes
    of_size = {int(k): _face_type(int(k), lists, counts, columns) for k in distinct(sizes)}
    if len(of_size) == 1:
        [(size, kind)] = of_size.items()
        return _packed(size, kind, lists, columns)
    lengths = np.zeros(len(sizes), dtype=np.int64)
    for size, kind in of_size.items():
        lengths[sizes == size] = kind.itemsize
    starts = np.cumsum(lengths) - lengths
    out = np.empty(int(lengths.sum()), dtype=np.uint8)
    for size, kind in of_size.items():
        mine = np.flatnonzero(sizes == size)
        at = mesh.offsets[mine, None] + np.arange(size)
        some = [each._replace(values=each.values[at.ravel()]) for each in lists]
        raw = _packed(size, kind, some, [(name, values[mine]) for name, values in columns])
        out[starts[mine, None] + np.arange(kind.itemsize)] = raw.reshape(len(mine), -1)
    return out


def _packed(
    size: int,
    kind: np.dtype[np.void],
    lists: list[_List],
    columns: list[tuple[str, NDArray[Any]]],
) -> NDArray[np.uint8]:
    """Return the bytes of faces of one size, in the order of their corners."""
    count = len(lists[0].values) // size
    records = np.empty(count, dtype=kind)
    for i, each in enumerate(lists):
        width = size * each.values.shape[1]
        records[f"n{i}"] = width
        records[f"l{i}"] = each.values.reshape(count, width)
    for i, (_, values) in enumerate(columns):
        records[f"f{i}"] = values
    return records.view(np.uint8)


def _face_type(
    size: int, lists: list[_List], counts: list[str], columns: list[tuple[str, NDArray[Any]]]
) -> np.dtype[np.void]:
    fields: list[Any] = []
    for i, (each, count) in enumerate(zip(lists, counts, strict=True)):
        fields.append((f"n{i}", "<" + count))
        fields.append((f"l{i}", each.values.dtype.newbyteorder("<"), size * each.values.shape[1]))
    fields += [(f"f{i}", v.dtype.newbyteorder("<")) for i, (_, v) in enumerate(columns)]
    return np.dtype(fields)
