"""GLB: scenes, accessors of every form, what trimesh makes of our files, and what is no GLB."""

from __future__ import annotations

import base64
import io
import json
import re
import struct
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest
from filetests import POINTS, again, named, polygons, read, refused, rows

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.files import mesh_bytes, written
from deltamesh_formats.polymesh.mesh import Attribute, Parts, from_triangles
from deltamesh_formats.polymesh.texture_origin import with_origin

TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="<f4")


def glb(tree, data=b""):
    text = tree if isinstance(tree, bytes) else json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(data)
    head = struct.pack("<4sIIII", b"glTF", 2, size, len(text), 0x4E4F534A)
    return head + text + struct.pack("<II", len(data), 0x004E4942) + data


def gltf_tree(**primitive):
    """Return one triangle as glTF, with two nodes that place it, and its buffer."""
    buffer = TRIANGLE.tobytes() + np.array([0, 1, 2, 0], dtype="<u2").tobytes()
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [
            {"mesh": 0, "translation": [0, 0, 5]},
            {"children": [2], "scale": [-2, 2, 2]},
            {"mesh": 0, "translation": [1, 0, 0]},
        ],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4} | primitive]}
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 8},
        ],
        "buffers": [{"byteLength": 44}],
    }
    return tree, buffer


def file_of(accessors, primitives, **others):
    """A GLB of one mesh: arrays with their types as accessors, primitives by their numbers."""
    tree = {"accessors": [], "bufferViews": [], "meshes": [{"primitives": primitives}]} | others
    codes = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
    data = b""
    for values, kind in accessors:
        normalized = kind.endswith("n")
        array = np.array(values, dtype="<" + kind.removesuffix("n"))
        width = 1 if array.ndim == 1 else array.shape[1]
        view = {"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes}
        accessor = {
            "bufferView": len(tree["bufferViews"]),
            "componentType": codes[kind.removesuffix("n")],
            "count": len(array),
            "type": ["SCALAR", "VEC2", "VEC3", "VEC4"][width - 1],
        }
        tree["bufferViews"].append(view)
        tree["accessors"].append(accessor | ({"normalized": True} if normalized else {}))
        data += array.tobytes() + bytes(-array.nbytes % 4)
    tree["buffers"] = [{"byteLength": len(data)}]
    return glb(tree, data)


# Scenes


def test_scene_is_put_together():
    mesh = read(glb(*gltf_tree()), "glb")
    first = [[0, 0, 5], [1, 0, 5], [0, 1, 5]]
    mirrored = [[-2, 0, 0], [-4, 0, 0], [-2, 2, 0]]
    np.testing.assert_array_equal(mesh.vertices, first + mirrored)
    # A mirror turns the winding round, so that outside stays outside.
    np.testing.assert_array_equal(mesh.faces, [[0, 1, 2], [5, 4, 3]])
    assert mesh.lost == ("the hierarchy of nodes", "the sharing of a mesh by nodes")
    back = again(mesh, "glb")
    np.testing.assert_array_equal(back.vertices, mesh.vertices)
    np.testing.assert_array_equal(back.faces, mesh.faces)
    placed = [mesh.parts_of("object").transforms for mesh in (mesh, back)]
    np.testing.assert_array_equal(*placed)


def test_names_of_nodes_meshes_and_materials():
    tree, buffer = gltf_tree(material=1)
    tree["nodes"][0]["name"], tree["meshes"][0]["name"] = "left", "wheel"
    tree["materials"] = [{"name": "unused"}, {"name": "rubber", "doubleSided": True}]
    mesh = read(glb(tree, buffer), "glb")
    assert named(mesh, "object") == ["left", "wheel"]
    assert named(mesh, "mesh") == ["wheel", "wheel"]
    assert named(mesh, "material") == ["rubber", "rubber"]
    assert "the look of materials" in mesh.lost
    back = again(mesh, "glb")
    assert [named(back, p.kind) for p in mesh.parts] == [named(mesh, p.kind) for p in mesh.parts]


def test_what_has_no_place_is_named():
    tree, buffer = gltf_tree()
    for name in ("animations", "skins", "cameras", "textures"):
        tree[name] = [{}]
    tree["extensions"] = {"KHR_lights_punctual": {}}
    tree["scenes"].append({})
    tree["nodes"] = [{"mesh": 0}]
    tree["scenes"][0]["nodes"] = [0]
    tree["meshes"][0]["primitives"][0]["targets"] = [{}]
    tree["meshes"][0]["primitives"] += [{"attributes": {"POSITION": 0}, "mode": m} for m in (0, 1)]
    expected = "animations skins cameras textures|other scenes|lights|morph targets|points|lines"
    found = read(glb(tree, buffer), "glb").lost
    assert " ".join(found) == expected.replace("|", " ")


@pytest.mark.parametrize("where", ["asset", "scenes", "nodes", "meshes", "primitive", "file"])
def test_custom_properties_are_named(where):
    tree, buffer = gltf_tree()
    before = read(glb(tree, buffer), "glb").lost
    primitive = tree["meshes"][0]["primitives"][0]
    place = {"asset": tree["asset"], "primitive": primitive, "file": tree}
    (place[where] if where in place else tree[where][0])["extras"] = {"weight": 3}
    assert read(glb(tree, buffer), "glb").lost == ("custom properties (extras)", *before)


@pytest.mark.parametrize("matrix", [None, [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 7, 8, 9, 1]])
def test_transforms(matrix):
    tree, buffer = gltf_tree()
    turn = {"rotation": [0, 0, 0.5**0.5, 0.5**0.5], "scale": [2, 2, 2], "translation": [7, 8, 9]}
    tree["nodes"] = [{"mesh": 0} | ({"matrix": matrix} if matrix else turn)]
    tree["scenes"][0]["nodes"] = [0]
    mesh = read(glb(tree, buffer), "glb")
    np.testing.assert_allclose(mesh.vertices, [[7, 8, 9], [7, 10, 9], [5, 8, 9]], atol=1e-15)


def test_normals_and_tangents_are_turned_and_turned_back():
    normals, tangents = [[0.6, 0, 0.8]] * 3, [[0.8, 0, -0.6, 1]] * 3
    nodes = [{"mesh": 0, "scale": [-2, 1, 1]}]
    attributes = {"POSITION": 0, "NORMAL": 1, "TANGENT": 2}
    data = file_of(
        [(TRIANGLE, "f4"), (normals, "f4"), (tangents, "f4")],
        [{"attributes": attributes}],
        nodes=nodes,
    )
    mesh = read(data, "glb")
    normal, tangent = rows(mesh, "normal", "vertex")[0], rows(mesh, "tangent", "vertex")[0]
    np.testing.assert_allclose(normal, np.array([-0.3, 0, 0.8]) / np.hypot(0.3, 0.8), rtol=1e-6)
    assert np.dot(normal, tangent[:3]) == pytest.approx(0, abs=1e-6)
    assert tangent[3] == -1
    back = again(mesh, "glb")
    np.testing.assert_allclose(rows(back, "normal", "vertex"), rows(mesh, "normal", "vertex"))
    np.testing.assert_array_equal(back.faces, mesh.faces)
    flat = read(data.replace(b'"scale": [-2, 1, 1]', b'"scale": [ 0, 0, 0]'), "glb")
    np.testing.assert_allclose(rows(flat, "normal", "vertex"), normals)
    np.testing.assert_array_equal(again(flat, "glb").vertices, flat.vertices)


# Primitives


def test_modes():
    square, order = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], ([0, 1, 2, 3], "u1")
    cases = {4: [[0, 1, 2]], 5: [[0, 1, 2], [2, 1, 3]], 6: [[0, 1, 2], [0, 2, 3]]}
    for mode, faces in cases.items():
        index = order if mode != 4 else ([0, 1, 2], "u1")
        primitive = {"attributes": {"POSITION": 0}, "indices": 1, "mode": mode}
        assert polygons(read(file_of([(square, "f4"), index], [primitive]), "glb")) == faces
    bare = read(file_of([(square, "f4")], [{"attributes": {"POSITION": 0}, "mode": 5}]), "glb")
    assert polygons(bare) == cases[5]


def test_attributes():
    uv, bytes_ = [[0, 0], [1, 0.5], [0, 1]], [[255, 0, 1, 9]] * 3
    accessors = [(TRIANGLE, "f4"), (uv, "f4"), ([[0, 65535]] * 3, "u2n"), (bytes_, "u1n")]
    accessors += [(bytes_, "u1"), ([[0.5, 0.25, 0.25, 0]] * 3, "f4"), ([-1, 2, 3], "i2")]
    names = ["POSITION", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0", "JOINTS_0", "WEIGHTS_0", "_HEAT"]
    primitive = {"attributes": {name: i for i, name in enumerate(names)}}
    mesh = read(file_of(accessors, [primitive]), "glb")
    found = {(a.name, a.role, a.values.dtype.str[1:], a.normalized) for a in mesh.attributes}
    assert found == {
        ("uv", "uv", "f4", False),
        ("uv1", "uv", "u2", True),
        ("colour", "colour", "u1", True),
        ("JOINTS_0", "other", "u1", False),
        ("WEIGHTS_0", "other", "f4", False),
        ("HEAT", "other", "i2", False),
    }
    assert rows(mesh, "HEAT", "vertex") == [[-1], [2], [3]]
    back = again(mesh, "glb")
    for a in mesh.attributes:
        assert rows(back, a.name, "vertex") == rows(mesh, a.name, "vertex")


def test_primitives_share_vertices_where_the_file_does():
    shared = {"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1}
    own = {"attributes": {"POSITION": 3}, "material": 0}
    accessors = [(TRIANGLE, "f4"), ([0, 1, 2], "u4"), ([[0, 1]] * 3, "f4"), (TRIANGLE + 1, "f4")]
    data = file_of(accessors, [shared, shared, own], materials=[{}])
    mesh = read(data, "glb")
    assert polygons(mesh) == [[0, 1, 2], [0, 1, 2], [3, 4, 5]]
    assert rows(mesh, "uv", "vertex") == [[0, 1]] * 3 + [None] * 3
    assert named(mesh, "material") == [None, None, "material_0"]
    back = again(mesh, "glb")
    assert polygons(back) == polygons(mesh)
    assert rows(back, "uv", "vertex") == rows(mesh, "uv", "vertex")


def test_interleaved_sparse_and_quantized_accessors():
    tree, buffer = gltf_tree()
    stride = np.zeros((3, 4), dtype="<f4")
    stride[:, :3], stride[:, 3] = TRIANGLE, [7, 8, 9]
    sparse = {
        "count": 1,
        "indices": {"bufferView": 1, "componentType": 5123, "byteOffset": 4},
        "values": {"bufferView": 0, "byteOffset": 4},
    }
    tree["bufferViews"] = [
        {"buffer": 0, "byteLength": 48, "byteStride": 16},
        {"buffer": 0, "byteOffset": 48, "byteLength": 8},
    ]
    heat = {"bufferView": 0, "byteOffset": 12, "componentType": 5126, "count": 3, "type": "SCALAR"}
    tree["accessors"] += [heat]
    tree["accessors"][0]["sparse"] = sparse
    tree["meshes"][0]["primitives"][0]["attributes"]["_HEAT"] = 2
    tree["nodes"] = [{"mesh": 0}]
    tree["scenes"][0]["nodes"] = [0]
    mesh = read(glb(tree, stride.tobytes() + buffer[36:]), "glb")
    assert rows(mesh, "HEAT", "vertex") == [[7], [8], [9]]
    np.testing.assert_array_equal(mesh.vertices, [[0, 0, 0], [1, 0, 0], [0, 0, 7]])
    quantized = [([[0, 0, 0], [127, 0, 0], [0, -128, 64]], "i1n")]
    mesh = read(file_of(quantized, [{"attributes": {"POSITION": 0}}]), "glb")
    np.testing.assert_array_equal(mesh.vertices, [[0, 0, 0], [1, 0, 0], [0, -1, 64 / 127]])


def test_buffers_in_the_json():
    tree, buffer = gltf_tree()
    uri = "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()
    tree["buffers"] = [{"byteLength": 44, "uri": uri}]
    assert len(read(glb(tree), "glb").faces) == 2


# Writing


def test_seams_repeat_vertices():
    square = from_triangles(np.array(POINTS, dtype=float), np.array([[0, 1, 2], [2, 1, 3]]))
    table, index = np.array([[0.0, 0], [1, 0], [0, 1], [0.5, 1]]), np.array([0, 1, 2, 2, 3, 0])
    uv = Attribute("uv", "corner", table, "uv", index)
    back = with_origin(again(replace(square, attributes=(uv,)), "glb"), top_left=False)
    assert len(back.vertices) == 5
    np.testing.assert_array_equal(back.vertices[back.faces], square.vertices[square.faces])
    found = np.array(rows(back, "uv", "vertex"))[back.faces].reshape(-1, 2)
    np.testing.assert_array_equal(found, table[index])


def test_what_glb_has_no_place_for():
    mesh = from_triangles(np.array(POINTS, dtype=float), np.array([[0, 1, 2]]))
    attributes = (
        Attribute("wide", "vertex", np.zeros((4, 5))),
        Attribute("large", "vertex", np.full((4, 1), 1 << 25)),
        Attribute("small", "vertex", np.full((4, 1), 1 << 24)),
        Attribute("colour", "face", np.zeros((1, 3)), "colour"),
        Attribute("uv", "vertex", np.zeros((4, 2)), "uv"),
        Attribute("uv", "corner", np.zeros((3, 2)), "uv"),
    )
    groups = Parts("group", ("g",), np.array([0]))
    made = written(replace(mesh, attributes=attributes, parts=(groups,)), "glb")
    assert made.lost == (
        "wide of vertices",
        "large of vertices",
        "colours of faces",
        "texture coordinates",
        "groups",
    )
    assert {a.name for a in read(made.data, "glb").attributes} == {"small", "uv"}


def test_corners_without_what_the_others_of_their_face_have_are_named():
    square = from_triangles(np.array(POINTS, dtype=float), np.array([[0, 1, 2], [2, 1, 3]]))
    index = np.array([0, 0, -1, 0, 0, 0])
    uv = Attribute("uv", "corner", np.zeros((1, 2)), "uv", index)
    made = written(replace(square, attributes=(uv,)), "glb")
    assert made.lost == ("attributes that not all corners of a face have",)
    mesh = read(made.data, "glb")
    assert sorted(map(bool, rows(mesh, "uv", "vertex"))) == [False] * 3 + [True] * 3


def test_trimesh_reads_what_we_write():
    """An independent reader; also of the names, normals and the transform of a node."""
    import trimesh

    vertices = np.add(POINTS, [1e6, 0, 0])
    normal = Attribute("normal", "vertex", np.tile([0, 0, 1.0], (4, 1)), "normal")
    parts = Parts("object", ("left", "right"), np.array([0, 1]))
    mesh = from_triangles(vertices, np.array([[0, 1, 2], [2, 1, 3]]))
    mesh = replace(mesh, attributes=(normal,), parts=(parts,))
    scene = trimesh.load(io.BytesIO(mesh_bytes(mesh, "glb")), file_type="glb", process=False)
    assert sorted(scene.geometry) == ["left", "right"]
    found = sorted(part.vertices.tolist() for part in scene.dump())
    np.testing.assert_allclose(found, [vertices[[0, 1, 2]], vertices[[1, 2, 3]]], atol=1e-6)
    np.testing.assert_array_equal(scene.geometry["left"].vertex_normals, [[0, 0, 1]] * 3)


def test_we_read_what_trimesh_writes():
    import trimesh

    scene = trimesh.Scene()
    for i in range(5):
        part = trimesh.Trimesh(TRIANGLE * 0 + i, [[0, 1, 2]], process=False)
        place = trimesh.transformations.translation_matrix([0, i, 0])
        scene.add_geometry(part, node_name=f"node {i}", geom_name=f"part {i}", transform=place)
    mesh = read(scene.export(file_type="glb"), "glb")
    np.testing.assert_array_equal(mesh.vertices[:, 0], np.repeat(np.arange(5), 3))
    np.testing.assert_array_equal(mesh.vertices[:, 1], 2 * np.repeat(np.arange(5), 3))
    assert named(mesh, "object") == [f"node {i}" for i in range(5)]
    assert named(mesh, "mesh") == [f"part {i}" for i in range(5)]


# Malformed


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.update(extensionsRequired=["EXT_mesh_gpu_instancing"]), "needs the glTF"),
        (lambda t: t["accessors"][0].pop("bufferView"), "accessor 0 has no data"),
        (
            lambda t: t["bufferViews"][0].update(extensions={"EXT_meshopt_compression": {}}),
            "its byteLength is null, not a count",
        ),
        (lambda t: t["accessors"][0].update(count=4), "buffer view 0 would end at byte 48"),
        (lambda t: t["accessors"][0].update(count=-1), "its count is -1, not a count"),
        (lambda t: t["accessors"][0].update(count=2**70), "not a count"),
        (lambda t: t["accessors"][0].update(count="3"), 'its count is "3", not a count'),
        (lambda t: t["accessors"][0].update(type="VEC5"), 'accessor 0 has the unknown type "VEC5"'),
        (lambda t: t["accessors"][0].update(type="VEC2"), "do not have three coordinates"),
        (lambda t: t["accessors"][0].update(componentType=5124), "no component type 5124"),
        (lambda t: t["accessors"][1].update(componentType=5122), "are not unsigned whole numbers"),
        (lambda t: t["accessors"][1].update(count=300), "would end at byte"),
        (lambda t: t["accessors"][1].update(count=2), "a primitive of triangles has 2 indices"),
        (lambda t: t["bufferViews"][0].update(byteLength=10**9), "would end at byte"),
        (lambda t: t["bufferViews"][0].update(buffer=1), "refers to buffer 1, of 1"),
        (lambda t: t["bufferViews"][0].update(byteStride=8), "elements of buffer view 0 overlap"),
        (lambda t: t["meshes"][0]["primitives"][0].update(mode=7), "has mode 7"),
        (lambda t: t["meshes"][0]["primitives"][0].update(mode=0), "a point cloud .*points"),
        (
            lambda t: t["meshes"][0]["primitives"][0].update(indices=9),
            "refers to accessors 9, of 2",
        ),
        (
            lambda t: t["meshes"][0]["primitives"][0].update(material=0),
            "refers to materials 0, of 0",
        ),
        (lambda t: t["meshes"][0]["primitives"][0].update(attributes={}), "has no POSITION"),
        (lambda t: t["meshes"][0]["primitives"][0].pop("attributes"), "has no attributes"),
        (
            lambda t: t["meshes"][0].update(primitives={}),
            r"meshes\[0\].primitives is {}, not an array",
        ),
        (lambda t: t["scenes"][0].update(nodes=[]), "no vertices and no faces"),
        (lambda t: t["scenes"][0].update(nodes=[7]), "refers to nodes 7, of 3"),
        (lambda t: t["nodes"][2].update(children=[1]), "node 1 is twice"),
        (lambda t: t["nodes"][2].update(children=[2]), "node 2 is twice"),
        (lambda t: t["nodes"][0].update(translation=[1, 2]), "translation is not 3 numbers"),
        (lambda t: t["nodes"][0].update(scale=[1e200, 1e200, 1e999]), "scale is not 3 numbers"),
        (
            lambda t: t["nodes"][0].update(translation=[1e308] * 3, scale=[1e308] * 3),
            "vertex 1 is not finite",
        ),
        (lambda t: t["nodes"][0].update(mesh=1), "refers to meshes 1, of 1"),
        (lambda t: t.pop("meshes"), "refers to meshes 0, of 0"),
        (lambda t: t["buffers"][0].update(uri="/etc/hostname"), "is in another file"),
        (lambda t: t["buffers"][0].update(uri="data:;base64,A"), "buffer 0 is not readable"),
    ],
)
def test_malformed(change, message):
    tree, buffer = gltf_tree()
    change(tree)
    refused(glb(tree, buffer), "glb", message)


def test_an_index_beyond_the_vertices():
    tree, buffer = gltf_tree()
    refused(glb(tree, buffer.replace(b"\1\0\2\0", b"\1\0\3\0")), "glb", "vertex 3, of 3")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "does not begin with 'glTF'"),
        (b"OFF\n", "does not begin with 'glTF'"),
        (b"glTF" + bytes(40), "glTF version 0, not 2"),
        (glb(*gltf_tree())[:-1], "is it cut short"),
        (glb(b"["), "its JSON is not readable"),
        (glb(b"[" * 100_000), "its JSON has a number that is too long, or too many brackets"),
        (glb(b"[]"), "its JSON is not an object"),
        (struct.pack("<4sII", b"glTF", 2, 12), "it has no JSON"),
        (glb({"meshes": 3}), "meshes is 3, not an array"),
        (glb({"nodes": [3]}), r"nodes\[0\] is 3, not an object"),
    ],
)
def test_what_is_no_glb(data, message):
    refused(data, "glb", message)


def test_small_files_that_ask_for_much_memory(monkeypatch):
    monkeypatch.setattr("deltamesh_formats.meshfiles.glb.reader._MOST", 1000)
    tree, buffer = gltf_tree()
    tree["nodes"] = [{"mesh": 0}] * 1000
    tree["scenes"][0]["nodes"] = list(range(1000))
    refused(glb(tree, buffer), "glb", "has more than 1000 numbers: it repeats meshes")
    tree, buffer = gltf_tree()
    tree["meshes"][0]["primitives"] *= 1000
    refused(glb(tree, buffer), "glb", "has more than 1000 numbers: it repeats meshes")
    tree, buffer = gltf_tree()
    tree["meshes"][0]["primitives"][0]["attributes"] |= {f"_{i}": 0 for i in range(1000)}
    refused(glb(tree, buffer), "glb", "has more than 1000 numbers: it repeats meshes")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t["meshes"][0].update(primitives=5), "meshes[0].primitives is 5, not an array"),
        (
            lambda t: t["nodes"][1].update(children=[[2]]),
            "nodes[1].children[0] is [2], not a",
        ),
        (lambda t: t["bufferViews"][0].update(extensions=0.5), "bufferViews[0].extensions is 0.5"),
        (lambda t: t["meshes"].insert(0, 7), "meshes[0] is 7, not an object"),
        (lambda t: t.update(buffers=[3]), "buffers[0] is 3, not an object"),
        (
            lambda t: t["accessors"][1].update(type=["VEC3"]),
            'accessors[1].type is ["VEC3"], not',
        ),
        (lambda t: t["accessors"][0].update(sparse=1), "accessors[0].sparse is 1, not an object"),
        (
            lambda t: t["accessors"][0].update(sparse={"count": 1, "indices": [], "values": {}}),
            "accessors[0].sparse.indices is [], not an object",
        ),
        (
            lambda t: t["accessors"][0].update(sparse={"count": 1}),
            "a sparse accessor has no indices in a buffer view",
        ),
        (
            lambda t: t["accessors"][0].update(sparse={"count": 1, "indices": {"bufferView": 1}}),
            "a sparse accessor has no values in a buffer view",
        ),
        (lambda t: t.update(extensionsRequired={}), "extensionsRequired is {}, not an array"),
        (lambda t: t.update(skins=True), "skins is true, not an array"),
        (lambda t: t.update(scene="a"), 'scene is "a", not a number'),
        (lambda t: t.update(materials=["x" * 99]), 'materials[0] is "xxxx'),
    ],
)
def test_another_type_is_named_by_its_field(change, message):
    tree, buffer = gltf_tree()
    change(tree)
    refused(glb(tree, buffer), "glb", re.escape(message))


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("attributes", 4, "meshes[0].primitives[0].attributes is 4, not an object"),
        ("attributes", {"POSITION": [0]}, "primitives[0].attributes.POSITION is [0], not a number"),
        (
            "attributes",
            {"POSITION": True},
            "primitives[0].attributes.POSITION is true, not a",
        ),
        ("mode", [4], "meshes[0].primitives[0].mode is [4], not a number"),
        ("indices", {"a": 1}, 'meshes[0].primitives[0].indices is {"a": 1}, not a number'),
        ("material", "red", 'meshes[0].primitives[0].material is "red", not a number'),
    ],
)
def test_another_type_in_a_primitive(field, value, message):
    tree, buffer = gltf_tree(**{field: value})
    refused(glb(tree, buffer), "glb", re.escape(message))


def paths(value, path=()):
    """All places in a JSON tree."""
    inner = {dict: lambda: value.items(), list: lambda: enumerate(value)}.get(type(value))
    for key, below in inner() if inner else ():
        yield (*path, key)
        yield from paths(below, (*path, key))


def assert_read_or_refused(data):
    """Read, or refused by a message of the reader's own."""
    with suppress(MeshError):
        read(data, "glb")
        return
    refused(data, "glb", "^<stream>: (?!not readable as)")


@pytest.mark.parametrize(
    "wrong", [5, -1, 0.5, "a", None, True, [], [[1]], {}, {"a": 1}, 10**30, 10**400]
)
def test_no_type_anywhere_is_met_unawares(wrong):
    """Another value at any place of the JSON, or none, is no failure of the reader's."""
    whole, buffer = gltf_tree(material=0)
    whole |= {"materials": [{"name": "m"}], "extensionsUsed": ["a"]}
    whole["accessors"][0]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": 1, "componentType": 5123},
        "values": {"bufferView": 0},
    }
    assert len(read(glb(whole, buffer), "glb").triangles) == 2
    for path in list(paths(whole)):
        tree = json.loads(json.dumps(whole))
        place = tree
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = wrong
        assert_read_or_refused(glb(tree, buffer))
        del place[path[-1]]
        assert_read_or_refused(glb(tree, buffer))


def test_many_attributes_of_few_vertices_are_bounded(monkeypatch):
    """Each has a number for each vertex of the scene: memory would grow with the square."""
    monkeypatch.setattr("deltamesh_formats.meshfiles.glb.reader._MOST", 100_000)
    tree, buffer = gltf_tree()
    one = tree["meshes"][0]["primitives"][0]
    attributes = [one["attributes"] | {f"_{i}": 0} for i in range(200)]
    tree["meshes"][0]["primitives"] = [one | {"attributes": each} for each in attributes]
    refused(glb(tree, buffer), "glb", "has many attributes of few vertices")
