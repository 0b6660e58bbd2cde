"""What two meshes have in common, against meshes that were shuffled and changed on purpose."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from polymeshes import Kind, polymeshes

from deltamesh._compare import likeness
from deltamesh._mesh import LARGEST
from deltamesh._order.reordering import permuted
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh

KINDS = (
    Kind("vertex", ("u1", "i8", "f4", "f8"), (1, 3)),
    Kind("corner", ("f8",), (2,), "uv", partly=True),
    Kind("face", ("i4", "f4"), (1,), partly=True),
)


def shuffled(mesh: PolyMesh, seed: int, *, turn: bool = True) -> PolyMesh:
    """The mesh with vertices, faces and, with `turn`, the corners of each in another order."""
    rng = np.random.default_rng(seed)
    vertices, faces = rng.permutation(len(mesh.vertices)), rng.permutation(len(mesh.sizes))
    spans = [np.arange(mesh.offsets[f], mesh.offsets[f + 1]) for f in faces]
    corners = [np.roll(span, rng.integers(len(span)) if turn else 0) for span in spans]
    offsets = np.concatenate(([0], np.cumsum(mesh.sizes[faces])))
    return permuted(mesh, vertices, faces, np.concatenate(corners), offsets)


def pairs_of(mesh: PolyMesh, other: PolyMesh) -> likeness.Pairs:
    found = likeness.corresponding(mesh, other)
    assert found is not None
    pairs = likeness.matched_corners(mesh, other, found)
    assert pairs is not None
    return pairs


def differences(mesh: PolyMesh, other: PolyMesh) -> tuple[likeness.Difference, ...]:
    return likeness.differences(mesh, other, pairs_of(mesh, other))


def cube() -> PolyMesh:
    """A box of six quads, of three different sides, so that it has no symmetry."""
    V = np.array([[x, 2.0 * y, 3.0 * z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    V[7] += 0.1
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    heat = Attribute("heat", "vertex", np.arange(8.0)[:, None])
    region = Attribute("region", "face", np.arange(6)[:, None])
    up = np.tile([0.0, 0, 1], (24, 1))
    normal = Attribute("normal", "corner", up, "normal")
    corners = np.array(quads).ravel()
    return PolyMesh(V, corners, np.arange(0, 25, 4), (heat, region, normal))


@given(polymeshes(KINDS), st.integers(0, 2**32))
def test_polygons_in_another_order_have_the_same_corners(mesh: PolyMesh, seed: int) -> None:
    other = shuffled(mesh, seed)
    # What the vertices of the other are called here: found by an attribute that names them.
    named = replace(
        mesh, attributes=(Attribute("id", "vertex", np.arange(len(mesh.vertices))[:, None]),)
    )
    ids = shuffled(named, seed).attributes[0].values[:, 0]
    pairs = likeness._corner_pairs(mesh.offsets, mesh.corners, other.offsets, ids[other.corners])
    assert pairs is not None
    np.testing.assert_array_equal(np.sort(pairs[0]), np.arange(len(mesh.corners)))
    np.testing.assert_array_equal(np.sort(pairs[1]), np.arange(len(mesh.corners)))
    np.testing.assert_array_equal(mesh.corners[pairs[0]], ids[other.corners][pairs[1]])


@given(polymeshes(KINDS))
def test_a_mesh_is_like_itself(mesh: PolyMesh) -> None:
    mesh = replace(mesh, vertices=np.clip(mesh.vertices, -LARGEST, LARGEST))
    told = differences(mesh, mesh)
    assert [one.largest for one in told] == [0.0] * len(mesh.attributes)


@pytest.mark.parametrize("seed", range(5))
def test_a_shuffled_mesh_is_like_itself(seed: int) -> None:
    mesh = cube()
    other = shuffled(mesh, seed)
    told = differences(mesh, other)
    assert [one.largest for one in told] == [0.0, 0.0, 0.0]


def test_differences_are_found_where_they_are() -> None:
    mesh = cube()
    heat, _, normal = mesh.attributes
    hotter = heat.values.copy()
    hotter[3] += 0.25
    tilted = normal.values.copy()
    tilted[5] = [0, np.sin(0.1), np.cos(0.1)]
    changed = (replace(heat, values=hotter), replace(normal, values=tilted))
    other = shuffled(replace(mesh, attributes=changed), 7)
    told = differences(mesh, other)
    assert told[0].largest == 0.25
    assert told[1].largest is None
    assert told[2].largest == pytest.approx(np.degrees(0.1))


def test_an_attribute_of_corners_is_compared_with_one_of_vertices() -> None:
    mesh = cube()
    heat = mesh.attributes[0]
    split = replace(heat, domain="corner", values=heat.values[mesh.corners])
    other = replace(mesh, attributes=(split,))
    told = differences(mesh, other)
    assert told[0].largest == 0.0


def test_elements_without_a_value_differ_from_those_that_have_one() -> None:
    mesh = cube()
    region = mesh.attributes[1]
    index = np.arange(6)
    index[2] = -1
    partly = replace(mesh, attributes=(replace(region, index=index),))
    assert differences(partly, mesh)[0].largest is None
    assert differences(partly, partly)[0].largest == 0.0


def test_attributes_of_one_name_are_paired_by_their_elements_and_types() -> None:
    mesh = cube()
    first, second = np.where(np.arange(8) < 4, np.arange(8), -1), np.arange(8) - 4
    second[:4] = -1
    table = np.arange(16).reshape(4, 4)

    def colour(kind: str, index: np.ndarray | None, values: np.ndarray = table) -> Attribute:
        return Attribute("colour", "vertex", values.astype(kind), "colour", index, True)

    # Two types at different elements, whatever their order; types at the same elements; both.
    for some in (
        (colour("u1", first), colour("u2", second)),
        (colour("u2", first), colour("u1", second)),
        (colour("u1", first), colour("u2", first, table + 256)),
        (colour("u1", first), colour("f4", first, table / 7), colour("u2", second)),
    ):
        own = replace(mesh, attributes=some)
        for other in (own, replace(own, attributes=some[::-1])):
            assert [one.largest for one in differences(own, other)] == [0.0] * len(some)
    one, two = (replace(mesh, attributes=(colour("u1", index),)) for index in (first, second))
    assert differences(one, two)[0].largest is None
    wide = replace(mesh, attributes=(colour("u2", first, table + 3), colour("u1", second)))
    assert differences(one, wide)[0].largest == 3.0


def test_other_polygons_are_no_likeness() -> None:
    mesh = cube()
    turned = replace(mesh, corners=np.r_[mesh.corners[3::-1], mesh.corners[4:]])
    assert likeness.corresponding(mesh, turned) is None


def test_polygons_correspond_to_their_triangles() -> None:
    mesh = cube()
    cut = PolyMesh(mesh.vertices, mesh.triangles.ravel(), np.arange(0, 37, 3))
    found = likeness.corresponding(mesh, cut)
    assert found is not None
    assert likeness.matched_corners(mesh, cut, found) is None


def test_repeated_positions_and_isolated_points_are_no_difference() -> None:
    mesh = cube()
    soup = PolyMesh(
        np.concatenate([mesh.vertices[mesh.corners], [[9.0, 9, 9]]]), np.arange(24), mesh.offsets
    )
    found = likeness.corresponding(replace(mesh, attributes=mesh.attributes[1:]), soup)
    assert found is not None
    assert found.b.of_vertices[24] == -1


def test_parts_are_the_same_whatever_their_order_and_not_if_a_face_is_in_another() -> None:
    group = Parts("group", ("a", "b", "b"), np.array([0, 0, 1, 2, -1, 1]))
    mesh = replace(cube(), parts=(group,))
    renumbered = Parts("group", ("b", "a", "b"), np.array([1, 1, 0, 2, -1, 0]))
    for same in (group, renumbered):
        other = shuffled(replace(mesh, parts=(same,)), 3)
        assert likeness.other_parts(mesh, other, pairs_of(mesh, other)) == ()
    moved = replace(group, of_face=np.array([0, 1, 1, 2, -1, 1]))
    joined = replace(group, of_face=np.array([0, 0, 1, 1, -1, 1]))
    named = replace(group, names=("a", "b", "c"))
    for unlike in ((moved,), (joined,), (named,), ()):
        other = shuffled(replace(mesh, parts=unlike), 3)
        assert likeness.other_parts(mesh, other, pairs_of(mesh, other)) == ("group",)
