"""Binary OFF in both of its forms, which only its length tells apart."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.off.binary import read_binary

V = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.5]], dtype=np.float32)
FACES = ([0, 1, 2], [0, 2, 3, 1])


def body(order: str, colours: list[list[float]] | None, extra: np.ndarray | None = None) -> bytes:
    rows = V if extra is None else np.hstack([V, extra])
    data = struct.pack(f"{order}3i", 4, 2, 0) + rows.astype(f"{order}f4").tobytes()
    for i, face in enumerate(FACES):
        data += struct.pack(f"{order}{len(face) + 1}i", len(face), *face)
        if colours is not None:
            data += struct.pack(f"{order}i{len(colours[i])}f", len(colours[i]), *colours[i])
    return data


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("colours", [None, [[], []], [[1.0, 0.5, 0.25], [0.0, 0.0, 1.0]]])
def test_both_forms_are_read(order: str, colours: list[list[float]] | None) -> None:
    mesh = read_binary(body(order, colours), [])
    np.testing.assert_array_equal(mesh.vertices, V)
    assert mesh.corners.tolist() == [*FACES[0], *FACES[1]]
    assert mesh.offsets.tolist() == [0, 3, 7]
    if colours and colours[0]:
        (attribute,) = mesh.attributes
        assert attribute.values[attribute.rows()].tolist() == colours
    else:
        assert mesh.attributes == ()


def test_faces_without_a_colour_have_none() -> None:
    mesh = read_binary(body(">", [[], [1.0, 0.5, 0.25]]), [])
    (attribute,) = mesh.attributes
    assert attribute.rows().tolist() == [-1, 0]


def test_colours_that_differ_in_number_are_a_loss() -> None:
    mesh = read_binary(body(">", [[1.0, 0.0], [1.0, 0.5, 0.25]]), [])
    assert mesh.attributes == ()
    assert mesh.lost == ("colours of faces, whose components differ in number",)


def test_further_columns_of_vertices_are_attributes() -> None:
    normals = np.eye(4, 3, dtype=np.float32)
    mesh = read_binary(body(">", [[], []], normals), [("normal", 3)])
    (attribute,) = mesh.attributes
    assert (attribute.role, attribute.domain) == ("normal", "vertex")
    np.testing.assert_array_equal(attribute.values, normals)


def test_every_other_length_is_refused() -> None:
    whole = body(">", [[], []])
    for data in (*(whole[:size] for size in range(len(whole))), whole + b"\0"):
        with pytest.raises(MeshError, match="its length does not fit its counts"):
            read_binary(data, [])
