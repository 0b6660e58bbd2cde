"""Parts of the reader and the writer of GLB: chunks, scenes, transforms, semantics, groups."""

from __future__ import annotations

import base64
import json
import tracemalloc
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps
from polygon_meshes import quad_torus

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.glb.accessors import COMPONENTS, Gltf, reals, whole
from deltamesh_formats.meshfiles.glb.chunks import BINARY_CHUNK, JSON_CHUNK, MAGIC, read_chunks
from deltamesh_formats.meshfiles.glb.scene import placed_meshes, scene_losses
from deltamesh_formats.meshfiles.glb.schema import check_types, items
from deltamesh_formats.meshfiles.glb.semantics import name_of, semantic_of
from deltamesh_formats.meshfiles.glb.vertex_groups import grouped
from deltamesh_formats.meshfiles.placement import (
    is_identity,
    is_mirror,
    moved,
    moved_back,
    turned,
)
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh

# ---- Chunks ------------------------------------------------------------------------------------


def glb(*chunks: tuple[bytes, bytes], version: int = 2, more: int = 0) -> bytes:
    body = b"".join(len(data).to_bytes(4, "little") + kind + data for kind, data in chunks)
    length = 12 + len(body) + more
    return MAGIC + version.to_bytes(4, "little") + length.to_bytes(4, "little") + body


def json_chunk(tree: object) -> tuple[bytes, bytes]:
    return JSON_CHUNK, json.dumps(tree).encode()


def test_buffers_are_the_binary_chunk_or_base64() -> None:
    uri = "data:application/octet-stream;base64," + base64.b64encode(b"inline").decode()
    tree = {"buffers": [{"byteLength": 4}, {"uri": uri}, {"byteLength": 9}]}
    found = read_chunks(glb(json_chunk(tree), (BINARY_CHUNK, b"four")))
    assert found.buffers == [b"four", b"inline", b""]
    assert found.tree == tree


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"glTE", "does not begin with 'glTF'"),
        (glb(json_chunk({}), version=1), "glTF version 1, not 2"),
        (glb(json_chunk({}), more=1), "announces .* is it cut short"),
        (glb((JSON_CHUNK, b"{}"))[:-1], "is it cut short"),
        (glb((BINARY_CHUNK, b"")), "it has no JSON"),
        (glb((JSON_CHUNK, b"{")), "its JSON is not readable"),
        (glb((JSON_CHUNK, b"[" * 100_000)), "a number that is too long, or too many brackets"),
        (glb((JSON_CHUNK, b"[" + b"1" * 5000 + b"]")), "a number that is too long"),
        (glb((JSON_CHUNK, b'{"a": "\xff"}')), "its JSON is not UTF-8"),
        (glb((JSON_CHUNK, b"[]")), "its JSON is not an object"),
        (glb(json_chunk({"buffers": {}})), "buffers is {}, not an array"),
        (glb(json_chunk({"buffers": [{"uri": "x.bin"}]})), 'buffer 0 is in another file, "x.bin"'),
        (
            glb(json_chunk({"buffers": [{"uri": "data:;base64,A"}]})),
            "buffer 0 is not readable",
        ),
        (
            glb(json_chunk({"extensionsRequired": ["EXT_mesh_gpu_instancing"]})),
            "needs the glTF extension EXT_mesh_gpu",
        ),
    ],
)
def test_what_is_no_glb_is_refused(data: bytes, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        read_chunks(data)


def gltf(views: list[Any], accessors: list[Any], data: bytes) -> Gltf:
    return Gltf({"bufferViews": views, "accessors": accessors}, [data])


@given(st.sampled_from(sorted(COMPONENTS)), st.integers(0, 5), st.integers(0, 7), st.data())
def test_accessors_step_over_their_buffer(
    code: int, count: int, gap: int, data: st.DataObject
) -> None:
    kind = np.dtype(COMPONENTS[code])
    values = data.draw(nps.arrays(kind, (count, 3)))
    stride = 3 * kind.itemsize + gap
    raw = b"??" + b"".join(row.tobytes() + b"?" * gap for row in values)
    view = {"buffer": 0, "byteOffset": 1, "byteLength": len(raw) - 1, "byteStride": stride}
    accessor = {"bufferView": 0, "byteOffset": 1, "componentType": code, "type": "VEC3"}
    found = gltf([view], [accessor | {"count": count}], raw).accessor(0)
    assert found.tobytes() == values.tobytes()
    assert found.shape == (count, 3)


def test_sparse_accessors_replace_elements() -> None:
    raw = np.array([1, 3], np.uint8).tobytes() + np.array([7, 9], np.uint8).tobytes()
    views = [{"buffer": 0, "byteLength": 2}, {"buffer": 0, "byteOffset": 2, "byteLength": 2}]
    sparse = {
        "count": 2,
        "indices": {"bufferView": 0, "componentType": 5121},
        "values": {"bufferView": 1},
    }
    accessor = {"count": 4, "componentType": 5121, "type": "SCALAR", "sparse": sparse}
    assert gltf(views, [accessor], raw).accessor(0).ravel().tolist() == [0, 7, 0, 9]
    with pytest.raises(MeshError, match="replaces element 3 of 3"):
        gltf(views, [accessor | {"count": 3}], raw).accessor(0)


VIEW = {"buffer": 0, "byteLength": 12}
ACCESSOR = {"bufferView": 0, "count": 3, "componentType": 5126, "type": "SCALAR"}


@pytest.mark.parametrize(
    ("view", "accessor", "message"),
    [
        ({}, {"count": 4}, "buffer view 0 would end at byte 16"),
        ({"byteLength": 13}, {}, "buffer view 0 would end at byte 13"),
        ({"byteStride": 3}, {}, "elements of buffer view 0 overlap"),
        ({"buffer": 1}, {}, "refers to buffer 1, of 1"),
        ({"extensions": {"EXT_meshopt_compression": {}}}, {}, "its byteLength is null"),
        ({}, {"count": -1}, "its count is -1, not a count"),
        ({}, {"count": True}, "its count is true, not a count"),
        ({}, {"componentType": 5124}, "no component type 5124"),
        ({}, {"type": "VEC5"}, 'unknown type "VEC5"'),
        ({}, {"bufferView": 1}, "refers to bufferViews 1, of 1"),
        ({}, {"bufferView": "0"}, 'refers to bufferViews "0", of 1'),
    ],
)
def test_accessors_that_lead_out_are_refused(
    view: dict[str, Any], accessor: dict[str, Any], message: str
) -> None:
    assert gltf([VIEW], [ACCESSOR], bytes(12)).accessor(0).tolist() == [[0], [0], [0]]
    with pytest.raises(MeshError, match=message):
        gltf([VIEW | view], [ACCESSOR | accessor], bytes(12)).accessor(0)


def test_accessors_without_data_are_refused() -> None:
    with pytest.raises(MeshError, match="accessor 0 has no data"):
        gltf([], [{"count": 3}], b"").accessor(0)
    huge = {"count": 2**40, "componentType": 5126, "type": "SCALAR", "sparse": {}}
    with pytest.raises(MeshError, match="elements but hardly any data"):
        gltf([], [huge], b"").accessor(0)


def test_numbers_and_lists_in_json_are_checked() -> None:
    assert whole({}, "n", 3) == 3
    assert items({}, "list") == []
    assert reals({}, "scale", 3) is None
    found = reals({"scale": [1, 2.5, 3]}, "scale", 3)
    assert found is not None
    assert found.tolist() == [1, 2.5, 3]
    for bad in ([1, 2], [1, 2, "3"], [1, 2, float("nan")], [1, 2, 10**400], [1, 2, True], "123"):
        with pytest.raises(MeshError, match="scale is not 3 numbers"):
            reals({"scale": bad}, "scale", 3)


# ---- Scenes ------------------------------------------------------------------------------------


def test_transforms_are_those_of_the_nodes_above() -> None:
    nodes = [
        {"children": [1], "translation": [1, 0, 0], "scale": [2, 2, 2]},
        {"mesh": 0, "name": "leaf", "rotation": [0, 0, 0.5**0.5, 0.5**0.5]},
        {"mesh": 1},
    ]
    tree = {
        "nodes": nodes,
        "meshes": [{}, {}],
        "scenes": [{"nodes": [2]}, {"nodes": [0]}],
        "scene": 1,
    }
    (placed,) = placed_meshes(Gltf(tree, []))
    assert (placed.mesh, placed.name, placed.depth) == (0, "leaf", 1)
    point = placed.matrix @ [1, 0, 0, 1]
    np.testing.assert_allclose(point, [1, 2, 0, 1], atol=1e-12)


def test_meshes_without_nodes_and_nodes_without_a_scene_are_shown() -> None:
    assert [p.mesh for p in placed_meshes(Gltf({"meshes": [{}, {}]}, []))] == [0, 1]
    tree = {"meshes": [{}], "nodes": [{"children": [1]}, {"mesh": 0}]}
    assert [p.depth for p in placed_meshes(Gltf(tree, []))] == [1]


@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        ([{"children": [1, 1]}, {}], "node 1 is twice in the scene"),
        ([{"children": [0]}], "node 0 is twice"),
        ([{"children": [5]}], "refers to nodes 5, of 1"),
        ([{"mesh": 3}], "refers to meshes 3, of 0"),
    ],
)
def test_nodes_that_are_no_tree_are_refused(nodes: list[Any], message: str) -> None:
    with pytest.raises(MeshError, match=message):
        placed_meshes(Gltf({"nodes": nodes, "scenes": [{"nodes": [0]}]}, []))


def test_what_else_a_scene_has_is_named() -> None:
    assert list(scene_losses(Gltf({"materials": [{"name": "red"}]}, []))) == []
    tree = {
        "animations": [{}],
        "images": [{}],
        "materials": [{"name": "red", "alphaMode": "BLEND"}],
        "scenes": [{}, {"extras": {}}],
        "extensions": {"KHR_lights_punctual": {}},
    }
    assert list(scene_losses(Gltf(tree, []))) == [
        "animations",
        "textures",
        "the look of materials",
        "other scenes",
        "lights",
        "custom properties (extras)",
    ]


# ---- Placement ---------------------------------------------------------------------------------

TURN = np.array([[0.0, -1, 0, 3], [1, 0, 0, 4], [0, 0, 2, 5], [0, 0, 0, 1]])


def test_positions_are_moved_and_moved_back() -> None:
    points = np.random.default_rng(2).normal(size=(9, 3))
    np.testing.assert_allclose(moved(points, TURN)[0], (TURN @ [*points[0], 1])[:3])
    np.testing.assert_allclose(moved_back(moved(points, TURN), TURN), points)
    assert moved(points, np.eye(4)) is moved_back(points, np.eye(4)) is points
    shift = np.eye(4)
    shift[:3, 3] = 1, 2, 4
    assert moved_back(np.array([[1.5, 2.5, 4.5]]), shift).tolist() == [[0.5, 0.5, 0.5]]


def test_normals_stay_at_right_angles_to_their_surface() -> None:
    along, normal = np.array([[1.0, 0, 1]]), np.array([[1.0, 0, -1]])
    stretched = along @ TURN[:3, :3].T
    found = turned("normal", normal, TURN)
    assert abs((stretched * found).sum()) < 1e-12
    np.testing.assert_allclose(np.linalg.norm(found), np.linalg.norm(normal))
    assert turned("heat", normal, TURN) is normal


def test_mirrors_change_the_handedness_of_tangents() -> None:
    mirror = np.diag([-1.0, 1, 1, 1])
    assert is_mirror(mirror)
    assert not is_mirror(TURN)
    assert not is_identity(mirror)
    found = turned("tangent", np.array([[1.0, 0, 0, 1]]), mirror)
    assert found.tolist() == [[-1, 0, 0, -1]]


def test_without_an_inverse_normals_stay() -> None:
    flat = np.diag([1.0, 1, 0, 1])
    normal = np.array([[0.0, 0, 1]])
    assert turned("normal", normal, flat) is normal


# ---- Semantics ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("semantic", "name", "role", "width"),
    [
        ("NORMAL", "normal", "normal", 3),
        ("TANGENT", "tangent", "other", 4),
        ("TEXCOORD_0", "uv", "uv", 2),
        ("TEXCOORD_3", "uv3", "uv", 2),
        ("COLOR_0", "colour", "colour", 4),
        ("_HEAT", "HEAT", "other", 1),
        ("JOINTS_0", "JOINTS_0", "other", 4),
    ],
)
def test_semantics_lead_to_names_and_back(semantic: str, name: str, role: str, width: int) -> None:
    assert name_of(semantic) == (name, role)
    attribute = Attribute(name, "vertex", np.zeros((1, width), np.float32), role)
    assert semantic_of(attribute) == semantic


def test_attributes_that_gltf_does_not_know_have_an_underscore() -> None:
    three = Attribute("uv", "vertex", np.zeros((1, 3)), "uv")
    whole_numbers = Attribute("colour", "vertex", np.zeros((1, 4), np.uint8), "colour")
    assert semantic_of(three) == "_uv"
    assert semantic_of(whole_numbers) == "_colour"


# ---- Groups of vertices ------------------------------------------------------------------------


def test_vertices_are_repeated_where_corners_differ() -> None:
    mesh = quad_torus(5, 4)
    corners = Attribute("uv", "corner", np.arange(2.0 * len(mesh.corners)).reshape(-1, 2), "uv")
    found = grouped(mesh, [corners], np.zeros(20, dtype=np.int64))
    assert len(found.vertex) == len(mesh.corners)
    cut = mesh.triangulation()
    np.testing.assert_array_equal(found.vertex[found.faces], cut.faces)
    np.testing.assert_array_equal(found.rows[0][0][found.faces], cut.corners)
    np.testing.assert_array_equal(found.polygon, cut.polygon)
    assert found.lost == ()


def test_objects_are_groups_of_their_own() -> None:
    mesh = quad_torus(5, 4)
    objects = np.repeat([1, 0], 10)
    found = grouped(mesh, [], objects)
    assert found.objects.tolist() == [0, 1]
    assert len(found.starts) == 3
    group = np.searchsorted(found.starts, found.faces, side="right") - 1
    assert (group == group[:, :1]).all()
    assert found.objects[group[:, 0]].tolist() == objects[found.polygon].tolist()


def test_attributes_that_only_some_corners_have_are_named() -> None:
    mesh = quad_torus(5, 4)
    index = np.arange(20)
    index[3] = -1
    partly = Attribute("heat", "vertex", np.zeros((20, 1)), index=index)
    found = grouped(mesh, [partly], np.zeros(20, dtype=np.int64))
    assert found.lost == ("attributes that not all corners of a face have",)
    assert [list(rows) for rows in found.rows] == [[0], []]


def test_many_attributes_of_few_vertices_take_less_than_their_mesh() -> None:
    """Of each only the corners that have it are kept, and not a number for every corner."""
    count = 400
    corners = np.arange(4 * count)
    index = np.where(np.arange(count)[:, None] == corners // 4, corners % 4, -1)
    values = np.zeros((4, 1))
    attributes = [Attribute(f"_{i}", "vertex", values, index=row) for i, row in enumerate(index)]
    squares = np.random.default_rng(0).random((4 * count, 3))
    mesh = PolyMesh(squares, corners, 4 * np.arange(count + 1), tuple(attributes))
    objects = np.zeros(count, dtype=np.int64)
    tracemalloc.start()
    found = grouped(mesh, attributes, objects)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < index.nbytes / 2
    assert found.lost == ()
    assert [list(rows) for rows in found.rows] == [[i] for i in range(count)]
    for i, rows in enumerate(found.rows):
        here = found.vertex[found.starts[i] : found.starts[i + 1]]
        np.testing.assert_array_equal(rows[i], index[i][here])


@pytest.mark.parametrize(
    ("tree", "message"),
    [
        ({"meshes": {}}, "meshes is {}, not an array"),
        ({"meshes": [{}, 5]}, "meshes[1] is 5, not an object"),
        (
            {"meshes": [{"primitives": [{"attributes": {"POSITION": "0"}}]}]},
            'meshes[0].primitives[0].attributes.POSITION is "0", not a number',
        ),
        ({"scene": True}, "scene is true, not a number"),
        ({"buffers": [{"uri": ["x" * 99]}]}, f'buffers[0].uri is ["{"x" * 35}..., not a string'),
    ],
)
def test_types_of_fields(tree: dict[str, Any], message: str) -> None:
    with pytest.raises(MeshError) as refused:
        check_types(tree)
    assert str(refused.value) == message


def test_fields_that_are_not_read_have_any_type() -> None:
    check_types({})
    check_types({"extras": 3, "nodes": [{"name": 7, "mesh": 0.0}], "textures": [None]})
