"""Section of parts and metadata alone: any annotations come back, and damage is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from annotated import annotated_meshes
from elements_of import of_faces
from hypothesis import given

from deltamesh._graph.elements import Elements, alone
from deltamesh._parts import Annotations, annotations_of, decode_parts, encode_parts
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh, from_triangles

TWO = from_triangles(np.eye(4, 3), np.array([[0, 1, 2], [2, 1, 3]]))


def never() -> Elements:
    raise AssertionError("no neighbours are needed")


def assert_same(one: Annotations, other: Annotations) -> None:
    assert one.texts == other.texts
    assert len(one.arrays()) == len(other.arrays())
    for a, b in zip(one.arrays(), other.arrays(), strict=True):
        np.testing.assert_array_equal(a, b)


@given(annotated_meshes())
def test_any_annotations_come_back(mesh: PolyMesh) -> None:
    count = len(mesh.sizes)
    polygons = np.random.default_rng(count).permutation(count)
    annotations = annotations_of(mesh, polygons)
    assert (annotations is None) == (not mesh.parts and not mesh.metadata and not mesh.lost)
    if annotations is None:
        return
    for parts, given_parts in zip(annotations.parts, mesh.parts, strict=True):
        np.testing.assert_array_equal(parts.of_face, given_parts.of_face[polygons])
    elements = of_faces(mesh.triangles[polygons])
    payload = encode_parts(annotations, lambda: elements)
    assert_same(decode_parts(memoryview(payload), count, lambda: elements), annotations)
    for size in {0, 1, len(payload) // 2, len(payload) - 1}:
        with pytest.raises(FormatError) as caught:
            decode_parts(memoryview(payload[:size]), count, lambda: elements)
        assert 0 <= caught.value.offset <= size


def test_one_part_needs_no_neighbours() -> None:
    mesh = replace(TWO, parts=(Parts("material", ("red", "blue"), np.array([1, 1])),))
    annotations = annotations_of(mesh, np.arange(2))
    assert annotations is not None
    found = decode_parts(memoryview(encode_parts(annotations, never)), 2, never)
    assert_same(found, annotations)
    assert found.parts[0].of_face.tolist() == [1, 1]


def test_transforms_come_back_bit_for_bit() -> None:
    moves = np.array([np.eye(4), np.diag([1.0, 2, 3, 1]), np.eye(4)])
    moves[2, 0, 3] = -0.0  # another matrix than the identity
    mesh = replace(TWO, parts=(Parts("object", ("a", "b", "c"), np.array([0, 2]), moves),))
    annotations = annotations_of(mesh, np.arange(2))
    assert annotations is not None
    payload = encode_parts(annotations, lambda: alone(2))
    (parts,) = decode_parts(memoryview(payload), 2, lambda: alone(2)).parts
    assert parts.transforms is not None
    assert parts.transforms.tobytes() == moves.tobytes()


def test_a_mesh_without_annotations_has_none() -> None:
    assert annotations_of(TWO, np.arange(2)) is None


def test_annotations_are_given_to_the_mesh() -> None:
    mesh = replace(TWO, metadata={"comments": ("x",)}, lost=("lines",))
    annotations = annotations_of(mesh, np.arange(2))
    assert annotations is not None
    made = annotations.given_to(TWO)
    assert dict(made.metadata) == {"comments": ("x",)}
    assert made.lost == ("lines",)
