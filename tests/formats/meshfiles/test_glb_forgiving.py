"""GLB as exporters write it: integer normals, matrices, extensions, colours of some objects."""

from __future__ import annotations

import json
import struct
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from cubes import TRIANGLES, VERTICES, is_cube
from filetests import again, read, refused, rows
from numpy.typing import NDArray

from deltamesh_formats.meshfiles.files import mesh_bytes, written
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh, from_triangles

CODES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
HALF = np.sqrt(0.5)


class File:
    """A GLB that is made of one mesh after the other."""

    def __init__(self, **others: Any) -> None:
        self.tree: dict[str, Any] = {"asset": {"version": "2.0"}, **others}
        for name in ("nodes", "meshes", "accessors", "bufferViews"):
            self.tree[name] = []
        self.data = b""

    def accessor(self, values: NDArray[Any], kind: str, *, normalized: bool = False) -> int:
        """Add an accessor; elements of vectors and matrices begin at multiples of four bytes."""
        raw = values.tobytes()
        size = len(raw) // len(values)
        stride = size if kind == "SCALAR" else size + -size % 4
        elements = (raw[i * size : (i + 1) * size] for i in range(len(values)))
        padded = b"".join(element.ljust(stride, b"\0") for element in elements)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(padded)}
        if kind != "SCALAR":
            view["byteStride"] = stride
        self.data += padded + bytes(-len(padded) % 4)
        self.tree["bufferViews"].append(view)
        code = CODES[values.dtype.str[1:]]
        accessor = {"bufferView": len(self.tree["bufferViews"]) - 1, "componentType": code}
        accessor |= {"count": len(values), "type": kind, "normalized": normalized}
        self.tree["accessors"].append(accessor)
        return len(self.tree["accessors"]) - 1

    def add(self, points: Any, triangles: Any, more: dict[str, int], **node: Any) -> None:
        """Add a mesh of attributes, which are accessors, and a node."""
        position = self.accessor(np.asarray(points, dtype="<f4"), "VEC3")
        indices = self.accessor(np.asarray(triangles, dtype="<u2").reshape(-1, 1), "SCALAR")
        primitive = {"attributes": {"POSITION": position, **more}, "indices": indices}
        self.tree["meshes"].append({"primitives": [primitive]})
        self.tree["nodes"].append({"mesh": len(self.tree["meshes"]) - 1, **node})

    def bytes(self) -> bytes:
        self.tree["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(self.tree).encode()
        text += b" " * (-len(text) % 4)
        size = 12 + 8 + len(text) + 8 + len(self.data)
        head = struct.pack("<4sIIII", b"glTF", 2, size, len(text), 0x4E4F534A)
        return head + text + struct.pack("<II", len(self.data), 0x004E4942) + self.data


# The corners of the cube one by one, with the normals of their faces.
CORNERS = VERTICES[TRIANGLES].reshape(-1, 3)
NORMALS = np.repeat(
    np.cross(*(VERTICES[TRIANGLES[:, i]] - VERTICES[TRIANGLES[:, 0]] for i in (1, 2))), 3, axis=0
)


def cosines(mesh: PolyMesh, name: str, at: int) -> NDArray[np.float64]:
    """Of a direction at each corner and the normal, or the first edge, of its triangle."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    right = np.repeat(np.cross(b - a, c - a) if at else b - a, 3, axis=0)
    (attribute,) = (one for one in mesh.attributes if one.name == name)
    given = attribute.dense()[mesh.corners][:, :3].astype(float)
    lengths = np.linalg.norm(right, axis=1) * np.linalg.norm(given, axis=1)
    found: NDArray[np.float64] = (right * given).sum(axis=1) / lengths
    return found


NODES: dict[str, dict[str, Any]] = {
    "quarter turn": {"rotation": [HALF, 0, 0, HALF]},
    "turn": {"rotation": [0.2, 0.4, 0.4, 0.8]},
    "scale": {"rotation": [0.2, 0.4, 0.4, 0.8], "scale": [1, 1, 5]},
    "mirror": {"scale": [-2, 1, 0.5]},
    "shear": {"matrix": [1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0.25, 1, 0, 7, 8, 9, 1]},
    "none": {},
}


@pytest.mark.parametrize("kind", ["i1", "i2", "f4"])
@pytest.mark.parametrize("node", NODES)
def test_normals_and_tangents_turn_with_their_node(kind: str, node: str) -> None:
    unit = np.iinfo(kind).max if kind != "f4" else 1
    tangents = np.repeat(CORNERS[1::3] - CORNERS[::3], 3, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    tangents = np.append(tangents, np.ones((36, 1)), axis=1) * unit
    file = File()
    more = {
        "NORMAL": file.accessor((NORMALS * unit).astype("<" + kind), "VEC3", normalized=unit > 1),
        "TANGENT": file.accessor(
            np.round(tangents).astype("<" + kind), "VEC4", normalized=unit > 1
        ),
    }
    file.add(CORNERS, np.arange(36), more, **NODES[node])
    mesh = read(file.bytes(), "glb")
    assert [a.values.dtype for a in mesh.attributes] == [np.dtype(kind)] * 2
    assert cosines(mesh, "normal", 1).min() > 0.9999
    handedness = -unit if node == "mirror" else unit
    assert {row[3] for row in rows(mesh, "tangent", "vertex") if row} == {handedness}
    if node != "mirror":  # which reverses the winding of the faces, and so their first edges
        assert cosines(mesh, "tangent", 0).min() > 0.9999


def test_the_shortest_integers_do_not_run_over() -> None:
    """-128 is no number of a normalized accessor, and 128 none of its type."""
    file = File()
    normals = np.full((36, 3), -128, dtype="i1")
    more = {"NORMAL": file.accessor(normals, "VEC3", normalized=True)}
    file.add(CORNERS, np.arange(36), more, rotation=[1, 0, 0, 0])
    values = read(file.bytes(), "glb").attributes[0].values
    np.testing.assert_array_equal(values, [[-127, 127, 127]] * 36)


def test_unsigned_normals_and_flat_nodes_stay() -> None:
    file = File()
    more = {"NORMAL": file.accessor(np.full((36, 3), 9, dtype="u1"), "VEC3", normalized=True)}
    file.add(CORNERS, np.arange(36), more, rotation=[1, 0, 0, 0])
    assert (read(file.bytes(), "glb").attributes[0].values == 9).all()


@pytest.mark.parametrize("size", [2, 3, 4])
@pytest.mark.parametrize("kind", ["i1", "u1", "i2", "u2", "u4", "f4"])
def test_matrices_are_rows_of_numbers(kind: str, size: int) -> None:
    """Their columns begin at multiples of four bytes."""
    values = np.arange(8 * size * size).reshape(8, size, size) % 100
    column = size * np.dtype(kind).itemsize
    rows_of = -(-column // 4) * 4 // np.dtype(kind).itemsize
    padded = np.full((8, size, rows_of), 111, dtype="<" + kind)
    padded[:, :, :size] = values
    file = File()
    accessor = file.accessor(padded, f"MAT{size}")
    file.add(VERTICES, TRIANGLES, {"_M": accessor})
    mesh = read(file.bytes(), "glb")
    assert is_cube(mesh)
    (attribute,) = mesh.attributes
    assert (attribute.name, attribute.values.dtype) == ("M", np.dtype(kind))
    np.testing.assert_array_equal(attribute.values, values.reshape(8, -1))
    if size > 2:
        assert written(mesh, "glb").lost == ("M of vertices",)


def test_sparse_matrices() -> None:
    file = File()
    file.add(VERTICES, TRIANGLES, {"_M": 2})
    new = file.accessor(np.full((1, 3, 4), 7, dtype="i1"), "MAT3")
    at = file.accessor(np.array([[5]], dtype="<u2"), "SCALAR")
    file.tree["accessors"] = file.tree["accessors"][:2]
    views = {"indices": {"bufferView": at, "componentType": 5123}, "values": {"bufferView": new}}
    sparse = {"count": 1, **views}
    accessor = {"componentType": 5120, "count": 8, "type": "MAT3", "sparse": sparse}
    file.tree["accessors"].append(accessor)
    (attribute,) = read(file.bytes(), "glb").attributes
    np.testing.assert_array_equal(attribute.values, np.eye(8)[:, 5:6] * np.full(9, 7))


@pytest.mark.parametrize(
    ("required", "message"),
    [
        (["VENDOR_mesh_magic"], "it needs the glTF extension VENDOR_mesh_magic, which is not read"),
        (["KHR_mesh_quantization", "EXT_mesh_gpu_instancing"], "EXT_mesh_gpu_instancing"),
        (["y" * 500], "y{80}, which"),
    ],
)
def test_required_extensions_are_refused(required: list[str], message: str) -> None:
    file = File(extensionsUsed=required, extensionsRequired=required)
    file.add(VERTICES, TRIANGLES, {})
    refused(file.bytes(), "glb", message)


def test_extensions_that_are_left_out_are_named() -> None:
    file = File(extensionsUsed=["EXT_structural_metadata", "VRM", "KHR_mesh_quantization"])
    file.add(VERTICES, TRIANGLES, {}, extensions={"MSFT_lod": {"ids": []}})
    mesh = read(file.bytes(), "glb")
    assert is_cube(mesh)
    assert mesh.lost == ("the glTF extensions EXT_structural_metadata, VRM, MSFT_lod",)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"count": [1] * 93}, r"its count is \[1, 1.{32}\.\.\., not a count"),
        ({"type": "x" * 93}, r"unknown type \"x{36}\.\.\."),
        ({"bufferView": 10**93}, r"bufferViews 10{36}\.\.\., of"),
    ],
)
def test_messages_are_short(change: dict[str, Any], message: str) -> None:
    file = File()
    file.add(VERTICES, TRIANGLES, {})
    file.tree["accessors"][0] |= change
    refused(file.bytes(), "glb", message)


@pytest.mark.parametrize(
    ("values", "white"),
    [
        (np.full((8, 3), 0.25, dtype="<f4"), [1, 1, 1]),
        (np.full((8, 4), 7, dtype="u1"), [255] * 4),
        (np.full((8, 3), 7, dtype="<u2"), [65535] * 3),
    ],
)
@pytest.mark.parametrize("file_format", ["ply", "off"])
def test_gaps_of_colours_are_white_and_said(
    values: NDArray[Any], white: list[float], file_format: str
) -> None:
    file, integer = File(), values.dtype.kind == "u"
    colour = file.accessor(values, f"VEC{values.shape[1]}", normalized=integer)
    file.add(VERTICES, TRIANGLES, {"COLOR_0": colour}, name="coloured")
    file.add(VERTICES, TRIANGLES, {}, name="plain", translation=[3, 0, 0])
    mesh = read(file.bytes(), "glb")
    made = written(mesh, file_format)
    assert "gaps in colours (filled with white)" in made.lost
    found = np.array(rows(read(made.data, file_format), "colour", "vertex"))
    expected = np.array([*values.tolist(), *[white] * 8], dtype=float)
    if file_format == "off" and values.dtype == np.uint16:
        expected /= 65535  # OFF has bytes, or fractions
    np.testing.assert_allclose(found, expected, rtol=1e-6)
    for whole in ("obj", "glb"):
        assert not any("gaps" in words for words in written(mesh, whole).lost)
        assert rows(again(mesh, whole), "colour", "vertex")[8:] == [None] * 8


def test_other_gaps_are_said_too() -> None:
    file = File()
    more = {
        "NORMAL": file.accessor(np.ones((8, 3), dtype="<f4"), "VEC3"),
        "_ID": file.accessor(np.arange(8, dtype="<u2").reshape(-1, 1), "SCALAR"),
    }
    file.add(VERTICES, TRIANGLES, more)
    file.add(VERTICES, TRIANGLES, {}, translation=[3, 0, 0])
    made = written(read(file.bytes(), "glb"), "ply")
    assert made.lost[-2:] == (
        "gaps in normals (filled with NaN)",
        "gaps in ID of vertices (filled with 0)",
    )
    assert mesh_bytes(read(made.data, "ply"), "ply")


def tree_of(data: bytes) -> dict[str, Any]:
    """Return the JSON of a GLB."""
    found = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
    assert isinstance(found, dict)
    return found


@pytest.mark.parametrize("kind", ["i1", "i2"])
def test_normals_and_tangents_of_integers_are_written_as_such(kind: str) -> None:
    unit, normals = np.iinfo(kind).max, np.round(NORMALS * np.iinfo(kind).max)
    mesh = from_triangles(CORNERS, np.arange(36).reshape(-1, 3))
    tangents = np.append(normals[:, [1, 2, 0]], np.full((36, 1), unit), axis=1)
    given = (
        Attribute("normal", "vertex", normals.astype(kind), "normal", normalized=True),
        Attribute("tangent", "vertex", tangents.astype(kind), "other", normalized=True),
        Attribute("uv", "vertex", normals[:, :2].astype(kind), "uv", normalized=True),
    )
    made = written(replace(mesh, attributes=given), "glb")
    assert made.lost == ()
    tree = tree_of(made.data)
    (primitive,) = tree["meshes"][0]["primitives"]
    assert list(primitive["attributes"]) == ["POSITION", "NORMAL", "TANGENT", "TEXCOORD_0"]
    of_normals = tree["accessors"][primitive["attributes"]["NORMAL"]]
    assert of_normals["normalized"] is True
    assert of_normals["componentType"] == {"i1": 5120, "i2": 5122}[kind]
    for key in ("extensionsUsed", "extensionsRequired"):
        assert tree[key] == ["KHR_mesh_quantization"]
    found = read(made.data, "glb")
    for one, other in zip(given[:2], found.attributes[:2], strict=True):
        assert (other.name, other.role, other.normalized) == (one.name, one.role, True)
        assert other.values.dtype == one.values.dtype
        assert other.dense().tolist() == one.values.tolist()


def test_integers_that_are_no_fractions_keep_their_names_only() -> None:
    mesh = from_triangles(CORNERS, np.arange(36).reshape(-1, 3))
    given = (
        Attribute("normal", "vertex", (NORMALS * 9).astype("i1"), "normal"),
        Attribute("colour", "vertex", (NORMALS * 9).astype("i1"), "colour", normalized=True),
        Attribute("uv", "vertex", (NORMALS[:, :2] * 9).astype("i4"), "uv", normalized=True),
    )
    tree = tree_of(written(replace(mesh, attributes=given), "glb").data)
    (primitive,) = tree["meshes"][0]["primitives"]
    assert list(primitive["attributes"]) == ["POSITION", "_normal", "_colour", "_uv"]
    assert "extensionsUsed" not in tree
    assert "normalized" not in tree["accessors"][primitive["attributes"]["_uv"]]
