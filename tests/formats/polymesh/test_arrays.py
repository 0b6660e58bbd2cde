"""Meshes of plain arrays, their attributes by name, and what is said of arrays that do not fit."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import polymeshes
import pytest
from hypothesis import given

import deltamesh
from deltamesh_formats.polymesh.arrays import role_of
from deltamesh_formats.polymesh.mesh import Attribute, Parts, from_triangles
from deltamesh_formats.polymesh.names import distinct_names
from deltamesh_formats.polymesh.validation import checked

V, F = meshes.torus(9, 7)
n, m = len(V), len(F)


def test_triangles_with_attributes_of_every_domain() -> None:
    T, R = np.arange(n), np.arange(m, dtype=np.int16)
    U = np.arange(6.0 * m).reshape(m, 3, 2)
    before = [A.copy() for A in (V, F, T, R, U)]
    mesh = deltamesh.from_arrays(V, F, vertex={"T": T}, face={"R": R}, corner={"uv": U})
    np.testing.assert_array_equal(mesh.vertices, V)
    np.testing.assert_array_equal(mesh.faces, F)
    assert list(mesh.vertex_data) == ["T"]
    assert (mesh.vertex_data["T"] == T).all()
    assert (mesh.face_data["R"] == R).all()
    assert mesh.face_data["R"].dtype == np.int16
    assert (mesh.corner_data["uv"] == U.reshape(-1, 2)).all()
    for A, old in zip((V, F, T, R, U), before, strict=True):
        np.testing.assert_array_equal(A, old)


def test_quads_and_polygons_of_any_sizes() -> None:
    quads = deltamesh.from_arrays(V, [[0, 1, 2, 3], [3, 2, 1, 0]])
    assert quads.sizes.tolist() == [4, 4]
    mixed = deltamesh.from_arrays(V, [[0, 1, 2], (0, 1, 2, 3), np.array([4, 3, 2, 1, 0])])
    assert mixed.sizes.tolist() == [3, 4, 5]
    assert mixed.corners.tolist() == [0, 1, 2, 0, 1, 2, 3, 4, 3, 2, 1, 0]
    ragged = np.empty(2, dtype=object)
    ragged[:] = [[0, 1, 2], [0, 1, 2, 3]]
    assert deltamesh.from_arrays(V, ragged).sizes.tolist() == [3, 4]


@pytest.mark.parametrize(
    ("name", "values", "role"),
    [
        ("normal", np.zeros((4, 3)), "normal"),
        ("Normals", np.zeros((4, 3), np.float32), "normal"),
        ("normal", np.zeros((4, 2)), "other"),
        ("normal", np.zeros((4, 3), np.int8), "other"),
        ("uv", np.zeros((4, 2)), "uv"),
        ("uv1", np.zeros((4, 2)), "uv"),
        ("uv", np.zeros((4, 1)), "other"),
        ("color", np.zeros((4, 3), np.uint8), "colour"),
        ("colour", np.zeros((4, 4), np.uint16), "colour"),
        ("RGBA", np.zeros((4, 4)), "colour"),
        ("colour", np.zeros((4, 4), np.int64), "other"),
        ("abnormal", np.zeros((4, 3)), "other"),
    ],
)
def test_roles(name: str, values: np.ndarray, role: str) -> None:
    assert role_of(name, values) == role


def test_unsigned_colours_are_fractions_and_truth_becomes_numbers() -> None:
    mesh = deltamesh.from_arrays(
        V, F, vertex={"colour": np.zeros((n, 3), np.uint8), "seen": np.arange(n) % 2 == 0}
    )
    colour, seen = mesh.attributes
    assert colour.normalized
    assert not seen.normalized
    assert seen.values.dtype == np.uint8
    assert mesh.vertex_data["seen"].tolist() == [1 - i % 2 for i in range(n)]


def test_the_precision_and_the_byte_order() -> None:
    single = V.astype(np.float32)
    mesh = deltamesh.from_arrays(single, F, vertex={"T": np.arange(n, dtype=">i4")})
    assert mesh.precision == "float32"
    assert mesh.vertices.dtype == np.float64
    assert mesh.vertex_data["T"].dtype == np.dtype("=i4")
    assert deltamesh.from_arrays(V, F).precision == "float64"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((V[:, :2], F), r"vertices must have shape \(n, 3\), not \(63, 2\)"),
        ((V, F.astype(float)), "faces must be integers, not float64"),
        ((V, F[:, :2]), "face 0 has 2 corners, fewer than three"),
        ((V, [[0, 1, 2], [3, 4]]), "face 1 has 2 corners"),
        ((V, [[0, 1, 2], [[3, 4, 5]]]), "face 1 is not a row"),
        ((V, F + 1), "face .* outside 0..62"),
        ((V, []), "no faces"),
        ((V * np.nan, F), "vertex 0 is not finite"),
        ((V, [["a", "b", "c"]]), "faces must be integers"),
        (([[0, 0, 0], [1]], F), "vertices: not an array"),
    ],
)
def test_what_is_no_mesh(arguments: tuple, message: str) -> None:
    with pytest.raises(deltamesh.MeshError, match=message):
        deltamesh.from_arrays(*arguments)


@pytest.mark.parametrize(
    ("attributes", "message"),
    [
        ({"vertex": {"T": [1, 2]}}, r"vertex attribute 'T' has shape \(2,\), not \(63,\)"),
        ({"face": {"R": np.zeros((m, 2, 2))}}, "face attribute 'R' has shape"),
        ({"corner": {"uv": np.zeros((m, 2, 2))}}, "corner attribute 'uv' has shape"),
        ({"vertex": {"T": np.zeros((n, 0))}}, "vertex attribute 'T' has shape"),
        ({"vertex": {"T": 1.0}}, "vertex attribute 'T' has shape"),
        ({"vertex": {"T": ["a"] * n}}, "vertex attribute 'T' must be real numbers, not <U1"),
        ({"vertex": {"T": np.zeros(n) * 1j}}, "vertex attribute 'T' must be real numbers"),
        ({"vertex": {"T": np.zeros(n, np.longdouble)}}, "must be real numbers, not"),
    ],
)
def test_attributes_that_do_not_fit_are_named(attributes: dict, message: str) -> None:
    with pytest.raises(deltamesh.MeshError, match=message):
        deltamesh.from_arrays(V, F, **attributes)


def test_an_index_is_put_in_place() -> None:
    index = np.full(n, -1)
    index[:2] = 1, 0
    whole = Attribute("T", "vertex", np.array([[5.0], [6.0]]), index=index)
    again = replace(whole, values=whole.values.astype(np.int32))
    data = replace(from_triangles(V, F), attributes=(whole, again)).vertex_data
    assert data["T"][:2].tolist() == [6, 5]
    assert np.isnan(data["T"][2:]).all()
    assert data["T_2"].tolist() == [6, 5] + [0] * (n - 2)


def test_no_name_is_there_twice() -> None:
    assert distinct_names(["a", "b", "a", "a", "a_2"]) == ["a", "b", "a_3", "a_4", "a_2"]


EVERY = (
    polymeshes.Kind("vertex", ("f4", "u1"), (1, 3), partly=True),
    polymeshes.Kind("corner", ("f8",), (2,), name="uv"),
    polymeshes.Kind("face", ("i8",), (1,)),
)


@given(polymeshes.polymeshes(EVERY))
def test_the_shapes_of_any_mesh_of_a_reader_are_right(mesh: deltamesh.PolyMesh) -> None:
    assert checked(mesh) is mesh


BROKEN = {
    "vertices must be float64": {"vertices": V.astype(np.float32)},
    "corners must be int64": {"corners": F.ravel().astype(np.int32)},
    "offsets must be an array": {"offsets": [0, 3]},
    "offsets must be int64": {"offsets": np.array([0.0, 3.0])},
    "offsets must ascend": {"offsets": np.arange(m + 1) * 3 - 1},
    "the domain of attribute 'T' must be one of vertex, corner, face": {
        "attributes": (Attribute("T", "edge", np.zeros((n, 1))),)
    },
    "vertex attribute 'T' has 3 rows for 63 elements": {
        "attributes": (Attribute("T", "vertex", np.zeros((3, 1))),)
    },
    "vertex attribute 'T' has values of shape": {
        "attributes": (Attribute("T", "vertex", np.zeros(n)),)
    },
    "index of vertex attribute 'T' leads out of its 3 rows": {
        "attributes": (Attribute("T", "vertex", np.zeros((3, 1)), index=np.full(n, 3)),)
    },
    "parts of kind 'group' must be int64": {"parts": (Parts("group", ("a",), np.zeros(3, int)),)},
    "parts of kind 'group' lead out": {"parts": (Parts("group", ("a",), np.ones(m, int)),)},
    "transforms of parts of kind 'group'": {
        "parts": (Parts("group", ("a",), np.zeros(m, int), np.eye(4)),)
    },
}


@pytest.mark.parametrize("message", BROKEN)
def test_a_mesh_made_by_hand_is_checked(message: str) -> None:
    mesh = replace(from_triangles(V, F), **BROKEN[message])
    with pytest.raises(deltamesh.MeshError, match=message):
        deltamesh.encode(mesh, bits=8)


def test_a_mesh_with_bad_indices_is_no_surprise() -> None:
    mesh = from_triangles(V, F)
    for wrong in (-1, n):
        corners = mesh.corners.copy()
        corners[4] = wrong
        with pytest.raises(deltamesh.MeshError, match="face 1 has vertex indices"):
            deltamesh.encode(replace(mesh, corners=corners))
