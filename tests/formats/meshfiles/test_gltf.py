"""glTF with buffers in the text and beside it, and compressed data in GLB and glTF."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from filetests import named, read, refused
from test_glb import glb, gltf_tree

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.beside import in_folder
from deltamesh_formats.meshfiles.files import read_mesh, write_mesh, written
from deltamesh_formats.meshfiles.glb.compression import (
    DRACO,
    MESHOPT,
    draco_arrays,
    meshopt_bytes,
)
from deltamesh_formats.meshfiles.glb.outside import outside_bytes
from deltamesh_formats.meshfiles.gltf import GLTF
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh, from_triangles

V = np.array([[0, 0, 0], [4, 0, 0], [0, 2, 0], [4, 2, 1], [2, 1, 3]], dtype="<f4")
F = np.array([[0, 1, 2], [2, 1, 3], [4, 1, 0], [3, 4, 2]], dtype="<u4")


def is_the_mesh(mesh: PolyMesh) -> bool:
    """Whether a mesh has the triangles above, in any order and from any corner on."""
    return turned(mesh.vertices[mesh.triangles]) == turned(V[F])


def turned(triangles: np.ndarray) -> list[list[list[float]]]:
    """Triangles in one order, each from one corner on."""
    listed = triangles.astype(float).round(2).tolist()
    return sorted(min(t[i:] + t[:i] for i in range(3)) for t in listed)


# ---- Buffers -----------------------------------------------------------------------------------


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A glTF of two placed meshes in a folder, its buffer beside it under a name with a blank."""
    tree, buffer = gltf_tree()
    folder = tmp_path / "scene"
    (folder / "data").mkdir(parents=True)
    (folder / "data" / "a b.bin").write_bytes(buffer)
    tree["buffers"][0]["uri"] = "data/a%20b.bin"
    (folder / "scene.gltf").write_text(json.dumps(tree), encoding="utf-8-sig")
    return folder / "scene.gltf"


def test_buffers_beside_the_file_are_read(scene: Path) -> None:
    mesh = read_mesh(scene)
    tree, buffer = gltf_tree()
    packed = read(glb(tree, buffer), "glb")
    np.testing.assert_array_equal(mesh.vertices, packed.vertices)
    np.testing.assert_array_equal(mesh.corners, packed.corners)
    assert (mesh.format, mesh.parts_of("object").transforms.shape) == ("gltf", (2, 4, 4))
    with scene.open("rb") as stream:
        np.testing.assert_array_equal(
            read_mesh(stream, folder=scene.parent).vertices, mesh.vertices
        )
    with scene.open("rb") as stream, pytest.raises(MeshError, match="buffer 0 is in another file"):
        read_mesh(stream)


@pytest.mark.parametrize(
    ("uri", "message"),
    [
        ("../secret.bin", "outside the folder"),
        ("data/../../secret.bin", "outside the folder"),
        ("%2e%2e/secret.bin", "outside the folder"),
        ("link.bin", "outside the folder"),
        ("file:///etc/hostname", "outside the folder"),
        ("https://example.org/a.bin", "outside the folder"),
        ("/etc/hostname", "outside the folder"),
        ("a\0b", "outside the folder"),
        ("missing.bin", "which is not there"),
        ("data", "which is not there"),
        ("data:;base64,A", "is not readable"),
        ("data:text/plain,abc", "is not base64"),
    ],
)
def test_nothing_outside_the_folder_is_read(scene: Path, uri: str, message: str) -> None:
    (scene.parent.parent / "secret.bin").write_bytes(bytes(100))
    (scene.parent / "link.bin").symlink_to(scene.parent.parent / "secret.bin")
    with pytest.raises(MeshError, match=message):
        outside_bytes(uri, in_folder(str(scene.parent)), 100)
    tree = json.loads(scene.read_text(encoding="utf-8-sig"))
    tree["buffers"][0]["uri"] = uri
    scene.write_text(json.dumps(tree))
    with pytest.raises(MeshError, match=f"buffer 0 .*{message}"):
        read_mesh(scene)


def test_no_more_than_asked_for_is_read(scene: Path) -> None:
    assert outside_bytes("data/a%20b.bin", in_folder(str(scene.parent)), 5) == gltf_tree()[1][:5]


def test_one_file_is_written_and_read_by_others(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    objects = Parts("object", ("left", "right"), np.array([0, 0, 1, 1]))
    mesh = PolyMesh(V.astype(float), F.ravel().astype(int), 3 * np.arange(5), (), (objects,))
    assert write_mesh(tmp_path / "a.gltf", mesh) == ()
    assert [path.name for path in tmp_path.iterdir()] == ["a.gltf"]
    back = read_mesh(tmp_path / "a.gltf")
    assert named(back, "object") == ["left", "left", "right", "right"]
    assert is_the_mesh(back)
    other = trimesh.load_scene(tmp_path / "a.gltf", process=False).to_mesh()
    assert turned(np.array(other.triangles)) == turned(V[F])
    assert written(mesh, "gltf").data == written(mesh, GLTF.name).data


def test_what_is_no_gltf_is_refused() -> None:
    refused(b"", "gltf", "its JSON is not readable")
    refused(b"[]", "gltf", "its JSON is not an object")
    first = {"asset": {"version": "1.0"}, "scene": "defaultScene", "scenes": {}}
    refused(json.dumps(first), "gltf", 'it is glTF version "1.0", not 2')
    refused('{"asset": {"version": 20}}', "gltf", "it is glTF version 20, not 2")
    refused('{"asset": {"version": "2.1"}}', "gltf", "it holds no mesh")
    refused(written(from_triangles(V.astype(float), F.astype(int)), "glb").data, "gltf", "JSON")


# ---- meshopt -----------------------------------------------------------------------------------


def packed_view(data: bytes, rows: int, stride: int, mode: str, offset: int = 0) -> dict[str, Any]:
    fields = {"byteLength": len(data), "byteOffset": offset, "count": rows, "byteStride": stride}
    return {"buffer": 0, "extensions": {MESHOPT[0]: {"buffer": 0, "mode": mode} | fields}}


def meshopt_file(**changes: object) -> bytes:
    meshopt = pytest.importorskip("meshopt")
    points = bytes(meshopt.encode_gltf_buffer(V, "ATTRIBUTES"))
    indices = bytes(meshopt.encode_gltf_buffer(F.ravel(), "TRIANGLES"))
    views = [
        packed_view(points, len(V), 12, "ATTRIBUTES") | {"byteLength": V.nbytes, "byteStride": 12},
        packed_view(indices, F.size, 4, "TRIANGLES", len(points)) | {"byteLength": F.nbytes},
    ]
    views[0]["extensions"][MESHOPT[0]] |= changes
    tree = {
        "extensionsUsed": [MESHOPT[0]],
        "extensionsRequired": [MESHOPT[0]],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(V), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": F.size, "type": "SCALAR"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": len(points) + len(indices)}],
    }
    return glb(tree, points + indices)


def test_meshopt_is_read() -> None:
    mesh = read(meshopt_file(), "glb")
    np.testing.assert_array_equal(mesh.vertices, V)
    assert is_the_mesh(mesh)
    assert mesh.lost == ()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mode": "OTHER"}, "there is no meshopt mode 'OTHER'"),
        ({"mode": []}, "there is no meshopt mode"),
        ({"filter": "OTHER"}, "there is no meshopt mode 'ATTRIBUTES', 'OTHER'"),
        ({"count": 6}, "buffer view 0 is not 6 rows of 12 bytes"),
        ({"count": 1 << 40}, "buffer view 0 is not 1099511627776 rows of 12 bytes"),
        ({"byteStride": 0}, "is not 5 rows of 0 bytes"),
        ({"byteStride": 10, "count": 6}, "damaged"),
        ({"byteLength": 10}, "damaged"),
        ({"byteLength": 1 << 30}, "buffer view 0 would end at byte 1073741824"),
        ({"buffer": 3}, "refers to buffer 3, of 1"),
    ],
)
def test_damaged_meshopt_is_refused(changes: dict[str, object], message: str) -> None:
    refused(meshopt_file(**changes), "glb", message)


# ---- Draco -------------------------------------------------------------------------------------


def draco_tree() -> tuple[dict[str, Any], bytes]:
    draco = pytest.importorskip("DracoPy")
    colours = np.arange(15, dtype=np.uint8).reshape(5, 3)
    data = draco.encode(V, F, quantization_bits=16, colors=colours)
    faces, arrays = draco_arrays(data)
    point = next(i for i, values in arrays.items() if values.dtype.kind == "f")
    colour = next(i for i, values in arrays.items() if values.dtype == np.uint8)
    extension = {"bufferView": 0, "attributes": {"POSITION": point, "COLOR_0": colour}}
    primitive = {
        "attributes": {"POSITION": 0, "COLOR_0": 1},
        "indices": 2,
        "extensions": {DRACO: extension},
    }
    count = len(arrays[point])
    colours_are = {"componentType": 5121, "normalized": True, "count": count, "type": "VEC3"}
    tree = {
        "extensionsUsed": [DRACO],
        "extensionsRequired": [DRACO],
        "meshes": [{"primitives": [primitive]}],
        "accessors": [
            {"componentType": 5126, "count": count, "type": "VEC3"},
            colours_are,
            {"componentType": 5123, "count": faces.size, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": len(data)}],
        "buffers": [{"byteLength": len(data)}],
    }
    return tree, data


def test_draco_is_read() -> None:
    mesh = read(glb(*draco_tree()), "glb")
    assert is_the_mesh(mesh)
    assert mesh.lost == ()
    (colour,) = mesh.attributes
    assert (colour.name, colour.normalized, colour.values.dtype) == ("colour", True, np.uint8)
    at = [V.tolist().index(point) for point in mesh.vertices.round().tolist()]
    np.testing.assert_array_equal(colour.values, np.arange(15).reshape(5, 3)[at])


def set_in(tree: dict[str, Any], **changes: object) -> None:
    tree["meshes"][0]["primitives"][0]["extensions"][DRACO].update(changes)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: set_in(t, attributes={"POSITION": 99}), "no attribute 99"),
        (lambda t: set_in(t, bufferView=7), "refers to bufferViews 7, of 1"),
        (lambda t: set_in(t, bufferView="0"), f'{DRACO}.bufferView is "0", not a number'),
        (lambda t: t["accessors"][0].update(count=9), "accessor 0 does not fit its Draco data"),
        (lambda t: t["accessors"][1].update(componentType=5126), "accessor 1 does not fit"),
        (lambda t: t["bufferViews"][0].update(byteLength=30), "Draco data are damaged"),
        (lambda t: t["meshes"][0]["primitives"][0].update(mode=5), "has mode 5 with Draco data"),
        (lambda t: t["meshes"][0]["primitives"][0].pop("indices"), "refers to accessors null"),
    ],
)
def test_damaged_draco_is_refused(change: Any, message: str) -> None:
    tree, data = draco_tree()
    change(tree)
    refused(glb(tree, data), "glb", message)


def test_more_rows_than_bytes_can_stand_for_are_refused() -> None:
    with pytest.raises(MeshError, match="9 bytes of meshopt are not 1000000 rows of 4 bytes"):
        meshopt_bytes(bytes(9), 1_000_000, 4, "ATTRIBUTES", "NONE")


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    for package in ("DracoPy", "meshopt"):
        monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(MeshError, match="with Draco, which the package DracoPy reads"):
        draco_arrays(b"DRACO")
    with pytest.raises(MeshError, match="with meshoptimizer, which the package meshopt reads"):
        meshopt_bytes(bytes(9), 1, 4, "ATTRIBUTES", "NONE")
