"""Attributes of corners at vertices, vertices split at seams, and concatenation of meshes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import polymeshes
import pytest
from hypothesis import given
from hypothesis import strategies as st

import deltamesh
from deltamesh_formats.polymesh.concatenation import concatenate
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.polymesh.seams import at_vertices, split_at_seams
from deltamesh_formats.polymesh.validation import checked

KINDS = (
    polymeshes.Kind("corner", ("f4", "i8"), (1, 2), partly=True),
    polymeshes.Kind("corner", ("f8",), (2,), "uv"),
    polymeshes.Kind("vertex", ("f8", "u1"), (3,), partly=True),
    polymeshes.Kind("face", ("i2",), (1,), partly=True),
)
PARTS = {"object": polymeshes.names, "material": polymeshes.names}
any_mesh = polymeshes.polymeshes(KINDS, part_names=PARTS)


def corners_of(mesh: PolyMesh) -> list[list[bytes]]:
    """What is at each corner: its position, its attributes, those of its face."""
    face = np.repeat(np.arange(len(mesh.sizes)), mesh.sizes)
    place = {"vertex": mesh.corners, "corner": slice(None), "face": face}
    found = [mesh.vertices[mesh.corners]]
    found += [a.dense()[place[a.domain]] for a in mesh.attributes]
    return [[row.tobytes() for row in rows] for rows in found]


@given(any_mesh)
def test_a_split_changes_nothing_at_any_corner(mesh: PolyMesh) -> None:
    for attribute in mesh.attributes:
        if attribute.domain == "corner":
            made = split_at_seams(mesh, attribute)
            assert checked(made) is made
            n = len(mesh.vertices)
            assert corners_of(made) == corners_of(mesh)
            assert (made.vertices[:n] == mesh.vertices).all()
            same = made.corners < n
            assert (made.corners[same] == mesh.corners[same]).all()
            # No more vertices than there are pairs of vertex and value, and lonely vertices.
            rows = [row.tobytes() for row in attribute.dense()]
            pairs = set(zip(mesh.corners.tolist(), rows, strict=True))
            assert len(made.vertices) == len(pairs) + n - len(np.unique(mesh.corners))


@given(any_mesh)
def test_corners_that_agree_are_vertices_and_only_they(mesh: PolyMesh) -> None:
    for attribute in mesh.attributes:
        if attribute.domain == "corner":
            rows, seen = attribute.dense(), {}
            for vertex, row in zip(mesh.corners.tolist(), rows, strict=True):
                seen.setdefault(vertex, set()).add(row.tobytes())
            values = at_vertices(mesh, attribute)
            assert (values is None) == any(len(each) > 1 for each in seen.values())
            if values is not None:
                assert values[mesh.corners].tobytes() == rows.tobytes()
                assert len(values) == len(mesh.vertices)


@given(st.lists(any_mesh, min_size=1, max_size=3))
def test_meshes_joined_are_all_there_in_turn(some: list[PolyMesh]) -> None:
    whole = concatenate(some)
    assert checked(whole) is whole
    place = {"vertex": 0, "corner": 0, "face": 0}
    for mesh in some:
        n, c, m = len(mesh.vertices), len(mesh.corners), len(mesh.sizes)
        v, k, f = place["vertex"], place["corner"], place["face"]
        assert (whole.vertices[v : v + n] == mesh.vertices).all()
        assert (whole.corners[k : k + c] == mesh.corners + v).all()
        assert (whole.sizes[f : f + m] == mesh.sizes).all()
        for a in mesh.attributes:
            (b,) = (
                b
                for b in whole.attributes
                if (b.domain, b.name, b.values.dtype, b.width)
                == (a.domain, a.name, a.values.dtype, a.width)
            )
            start = place[a.domain]
            rows = b.dense()[start : start + len(a.rows())]
            assert rows.tobytes() == a.dense().tobytes()
        for p in mesh.parts:
            q = whole.parts_of(p.kind)
            assert q is not None
            names = [None if i < 0 else q.names[i] for i in q.of_face[f : f + m]]
            assert names == [None if i < 0 else p.names[i] for i in p.of_face]
        place = {"vertex": v + n, "corner": k + c, "face": f + m}


def test_one_mesh_joined_is_that_mesh() -> None:
    mesh = deltamesh.from_arrays(np.eye(3), [[0, 1, 2]], vertex={"T": [1, 2, 3]})
    assert polymeshes.described(concatenate([mesh])) == polymeshes.described(mesh)


def test_transforms_of_those_that_have_none_are_the_identity() -> None:
    mesh = deltamesh.from_arrays(np.eye(3), [[0, 1, 2]])
    moved = deltamesh.Parts("object", ("a",), np.zeros(1, np.int64), np.full((1, 4, 4), 2.0))
    still = replace(moved, transforms=None)
    whole = concatenate([replace(mesh, parts=(still,)), replace(mesh, parts=(moved,))])
    assert whole.parts[0].transforms is not None
    np.testing.assert_array_equal(whole.parts[0].transforms, [np.eye(4), np.full((4, 4), 2.0)])


@pytest.mark.parametrize("value", [np.nan, -0.0])
def test_numbers_are_compared_bit_by_bit(value: float) -> None:
    mesh = deltamesh.from_arrays(
        np.eye(4)[:, :3], [[0, 1, 2], [0, 2, 3]], corner={"c": np.full(6, value)}
    )
    values = at_vertices(mesh, mesh.attributes[0])
    assert values is not None
    assert np.signbit(values).all() == np.signbit(value)
