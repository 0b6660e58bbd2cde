"""What a format can hold comes back from it bit for bit, whatever the mesh."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import polymeshes
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from polymeshes import Kind, described

from deltamesh_formats.meshfiles.files import read_mesh, written
from deltamesh_formats.meshfiles.formats import FORMATS
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh
from deltamesh_formats.polymesh.texture_origin import marked_top_left

REAL, ANY_REAL = ("f8",), ("f4", "f8")
PLY_TYPES = ("i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8")
GLB_TYPES = ("i1", "u1", "i2", "u2", "f4")

OBJ = polymeshes.polymeshes(
    (
        Kind("vertex", REAL, (3, 4), "colour", partly=True),
        Kind("vertex", REAL, (1, 2, 3), "uv"),
        Kind("corner", REAL, (1, 2, 3), "uv", partly=True),
        Kind("vertex", REAL, (3,), "normal"),
        Kind("corner", REAL, (3,), "normal", partly=True),
    ),
    part_names={
        "object": polymeshes.names,
        "group": polymeshes.names,
        "material": polymeshes.names,
        "smoothing": st.integers(1, 99).map(str),
    },
    metadata={
        "comments": polymeshes.comments,
        "mtllib": st.lists(polymeshes.names, max_size=2).map(tuple),
    },
    tables={"corner": "vertex"},
)


def ply(precision: str) -> st.SearchStrategy[PolyMesh]:
    kinds = [
        Kind("vertex", ANY_REAL, (3,), "normal"),
        Kind("vertex", PLY_TYPES, (3, 4), "colour"),
        Kind("face", PLY_TYPES, (3, 4), "colour"),
        Kind("vertex", ANY_REAL, (2,), "uv"),
        Kind("corner", ANY_REAL, (2, 3), "uv"),
        *(Kind(domain, PLY_TYPES, (1, 2, 5)) for domain in ("vertex", "corner", "face")),
    ]
    said = {"comments": polymeshes.comments, "obj_info": polymeshes.comments}
    tables = {"corner": "face"}
    return polymeshes.polymeshes(tuple(kinds), precision=precision, metadata=said, tables=tables)


OFF = polymeshes.polymeshes(
    (
        Kind("vertex", REAL, (3,), "normal"),
        Kind("vertex", ("u1", "f8"), (3, 4), "colour"),
        Kind("vertex", REAL, (2,), "uv"),
        Kind("face", ("u1", "f8"), (3, 4), "colour", partly=True),
    ),
    metadata={"comments": polymeshes.comments},
)
GLB = polymeshes.polymeshes(
    (
        Kind("vertex", ("f4",), (3,), "normal", partly=True),
        Kind("vertex", ("u1", "u2", "f4"), (3, 4), "colour", partly=True),
        Kind("vertex", ("f4",), (2,), "uv", partly=True),
        Kind("vertex", GLB_TYPES, (1, 2, 3, 4), partly=True),
    ),
    precision="float32",
    largest=3,
    part_names={"object": polymeshes.names | st.just(""), "material": polymeshes.names},
    unique=False,
)


def again(mesh: PolyMesh, file_format: str) -> PolyMesh:
    made = written(mesh, file_format)
    assert made.lost == mesh.lost == ()
    assert made == written(mesh, file_format)
    return read_mesh(io.BytesIO(made.data), file_format)


@given(OBJ)
def test_obj(mesh):
    assert described(again(mesh, "obj")) == described(mesh)


@given(st.one_of(ply("float32"), ply("float64")))
def test_ply(mesh):
    expected = replace(mesh, attributes=tuple(with_corner_rows(a) for a in mesh.attributes))
    assert described(again(mesh, "ply")) == described(expected)


def with_corner_rows(attribute):
    """PLY writes a row for each corner: the table and the index become one."""
    if attribute.index is None:
        return attribute
    return replace(attribute, values=attribute.dense(), index=None)


@given(OFF)
def test_off(mesh):
    assert described(again(mesh, "off")) == described(mesh)


@given(GLB)
def test_glb(mesh):
    """Vertices and faces come in the order of their objects; with their attributes all are there.

    What has been read then comes back as it is. (A vertex of no face at the border of two blocks
    may come in the other.)
    """
    mesh = marked_top_left(mesh)
    made = written(mesh, "glb")
    mixed, strays = (
        "attributes that not all corners of a face have",
        "attributes of vertices of no face",
    )
    assert set(made.lost) <= {mixed, strays}
    assume(strays not in made.lost)
    found = read_mesh(io.BytesIO(made.data), "glb")
    assert sorted(faces_of(found)) == sorted(faces_of(mesh))
    assert {v.tobytes() for v in found.vertices} == {v.tobytes() for v in mesh.vertices}
    back = again(found, "glb")
    assert sorted(faces_of(back)) == sorted(faces_of(found))
    if len(np.unique(found.corners)) == len(found.vertices):
        assert described(back) == described(found)


def faces_of(mesh):
    """Each triangle as text: where it is, what its corners have, what it belongs to."""
    columns = []
    for a in mesh.attributes:
        rows = [*(row.tobytes() for row in np.ascontiguousarray(a.values)), None]
        key = (a.name, a.role, a.normalized, a.values.dtype.str, a.width)
        columns.append((key, [rows[i] for i in a.rows().tolist()]))
    triangles = mesh.triangulation()
    for face, polygon in zip(triangles.faces.tolist(), triangles.polygon.tolist(), strict=True):
        # A triangle has what all its corners have: glTF has attributes of whole primitives.
        common = [c for c in columns if all(c[1][v] is not None for v in face)]
        has = [(key, [rows[v] for v in face]) for key, rows in common]
        parts = {p.kind: p.names[p.of_face[polygon]] for p in mesh.parts if p.of_face[polygon] >= 0}
        parts.setdefault("object", "")
        yield repr((mesh.vertices[face].tobytes(), sorted(has), sorted(parts.items())))


TRIANGLES = polymeshes.polymeshes(
    (), precision="float32", largest=3, part_names={"object": polymeshes.names | st.just("")}
)


@given(TRIANGLES)
def test_stl(mesh):
    """Vertices at one position become one, those of no face go; then nothing changes any more."""
    found = read_mesh(io.BytesIO(written(mesh, "stl").data), "stl")
    single = found.vertices.astype(np.float32)
    objects = mesh.parts_of("object")
    order = np.arange(len(mesh.sizes))
    if objects is not None:
        order = np.argsort(objects.of_face, kind="stable")
        if objects.names != ("",):
            named = found.parts_of("object")
            assert named is not None
            expected = [objects.names[i] for i in objects.of_face[order]]
            assert [named.names[i] for i in named.of_face] == expected
    np.testing.assert_array_equal(single[found.triangles], mesh.vertices[mesh.triangles[order]])
    assert len(np.unique(found.vertices + 0.0, axis=0)) == len(found.vertices)
    assert described(again(found, "stl")) == described(found)


@given(st.integers(1, 2**16 - 1), st.integers(1, 3))
def test_bytes_of_binary_stl_facets(value, count):
    mesh = triangles(count)
    bytes_ = np.arange(value, value + count).astype(np.uint16)[:, None]
    attribute = polymeshes.Attribute("attribute_bytes", "face", bytes_)
    mesh = replace(mesh, attributes=(attribute,), metadata={"header": ("COLOR=",)})
    assert described(again(mesh, "stl")) == described(mesh)


def triangles(count: int) -> PolyMesh:
    corners = np.arange(3 * count)
    V = np.stack([corners % 3, corners // 3, np.ones_like(corners)], axis=1).astype(float)
    return PolyMesh(V, corners, 3 * np.arange(count + 1), precision="float32")


@pytest.mark.parametrize("file_format", ["obj", "off"])
@given(st.one_of(ply("float32")))
def test_text_of_float32_is_short_and_exact_in_float32(file_format, mesh):
    found = read_mesh(io.BytesIO(written(mesh, file_format).data), file_format)
    np.testing.assert_array_equal(found.vertices.astype(np.float32), mesh.vertices)


angles = st.floats(-3, 3)


@st.composite
def transforms(draw: st.DrawFn) -> np.ndarray:
    """Rotations with scales, mirrors among them, and translations."""
    a, b = draw(angles), draw(angles)
    around_z = [[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]
    around_x = [[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]]
    scale = st.floats(0.25, 4) | st.floats(-4, -0.25)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(around_z) @ around_x * [draw(scale) for _ in range(3)]
    matrix[:3, 3] = [draw(st.floats(-100, 100)) for _ in range(3)]
    return matrix


@given(st.lists(transforms(), min_size=1, max_size=3))
def test_transforms_of_a_scene(matrices):
    mesh = triangles(len(matrices))
    of_face, names = np.arange(len(matrices)), tuple(f"node {i}" for i in range(len(matrices)))
    V, W = mesh.vertices.copy(), np.empty_like(mesh.vertices)
    for i, matrix in enumerate(matrices):
        own = slice(3 * i, 3 * i + 3)
        W[own] = V[own] @ matrix[:3, :3].T + matrix[:3, 3]
    parts = Parts("object", names, of_face, np.array(matrices))
    data = written(replace(mesh, vertices=W, parts=(parts,)), "glb").data
    found = read_mesh(io.BytesIO(data), "glb")
    np.testing.assert_allclose(found.vertices, W, atol=1e-4)
    np.testing.assert_array_equal(found.triangles, mesh.triangles)
    placed = found.parts_of("object")
    if any((matrix != np.eye(4)).any() for matrix in matrices):
        np.testing.assert_array_equal(placed.transforms, parts.transforms)
    assert placed.names == names


@pytest.mark.parametrize("file_format", FORMATS)
def test_the_input_stays_as_it_is(file_format):
    mesh = triangles(3)
    before = described(mesh)
    written(mesh, file_format)
    assert described(mesh) == before
