"""Polygons cut into triangles: their areas, and that neither corner nor number decides."""

from __future__ import annotations

import collections
import os

import numpy as np
import outlines
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from deltamesh import decode, encode
from deltamesh_formats.meshfiles.files import read_mesh, write_mesh
from deltamesh_formats.polymesh import ears
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.polymesh.triangles import Triangles

PROFILE = os.environ.get("HYPOTHESIS_PROFILE", "default")
OUTLINES = {"default": 300, "ci": 1000, "expensive": 10_000}[PROFILE]
LARGE = {
    "star": lambda rng: outlines.star(10 ** rng.uniform(-3, 0, size=1000)),
    "comb": lambda rng: outlines.comb(250, 90.0),
    "spiral": lambda rng: outlines.spiral(1000, 6.0),
    "untangled": lambda rng: outlines.untangled(rng.normal(size=(100, 2))),
    "holes": lambda rng: outlines.with_holes(rng, 10),
    "pacman": lambda rng: outlines.pacman(1000),
    "middles": lambda rng: outlines.with_middles(outlines.star(rng.uniform(0.05, 1, size=500))),
}
FLAT = {
    "U": (outlines.U, 7.0),
    "H": (outlines.H, 7.0),
    "comb of 24 corners": (outlines.comb(6, 9.0), 65.0),
    "star": (outlines.star(np.tile([1.0, 0.3], 5)), 1.5 * np.sin(np.pi / 5)),
    "pacman": (outlines.pacman(20), 9 * np.sin(2 * np.pi * 5 / 6 / 18)),
    "keyhole": (outlines.KEYHOLE, 12.0),
    "two holes at one corner": (outlines.TWO_HOLES, 76.5),
    "arrow": (((0, 0), (2, -1), (0.5, 0), (2, 1)), 0.5),
}
# Corners in line, at one place, there and back, and outlines that cross themselves.
DEGENERATE = {
    "one place": [(1, 1)] * 7,
    "in line": [(0, 0), (1, 0), (2, 0), (3, 0), (1.5, 0)],
    "there and back": [(0, 0), (1, 0), (2, 0), (1, 0)],
    "each twice": [(0, 0), (0, 0), (1, 0), (1, 0), (1, 1), (1, 1), (0, 1), (0, 1)],
    "spike": [(0, 0), (1, 0), (3, 0), (1, 0), (1, 1), (0, 1)],
    "spike inwards": [(0, 0), (3, 0), (3, 3), (2, 2), (1, 1), (2, 2), (3, 3), (0, 3)],
    "bow tie": [(0, 0), (1, 1), (1, 0), (0, 1)],
    "two bow ties": [(0, 0), (1, 1), (2, 0), (3, 1), (3, 0), (2, 1), (1, 0), (0, 1)],
    "pentagram": [(np.cos(a), np.sin(a)) for a in 4 * np.pi * np.arange(5) / 5],
    "eight": [(0, 0), (1, 0), (1, 1), (0, 1), (0, 0), (-1, 0), (-1, 1), (0, 1)],
    "touches an edge": [(0, 0), (4, 0), (4, 4), (2, 0), (0, 4)],
}


def one_polygon(points) -> PolyMesh:
    """A mesh of one polygon, flat where the points are."""
    at = np.asarray(points, dtype=float)
    if at.shape[1] == 2:
        at = np.concatenate([at, np.zeros((len(at), 1))], axis=1)
    return PolyMesh(at, np.arange(len(at)), np.array([0, len(at)]))


def areas(mesh: PolyMesh, normal) -> np.ndarray:
    a, b, c = mesh.vertices[mesh.triangles].transpose(1, 0, 2)
    return np.cross(b - a, c - a) @ normal / 2


def at_positions(mesh: PolyMesh) -> list[bytes]:
    """The triangles by where their corners are, wherever they begin."""
    faces = mesh.vertices[mesh.triangles]
    turns = [[np.roll(face, -i, axis=0).tobytes() for i in range(3)] for face in faces]
    return sorted(map(min, turns))


def assert_cut(mesh: PolyMesh, cut: Triangles) -> None:
    """Each edge of a polygon has a triangle on its left, each diagonal one on both sides."""
    sizes = mesh.sizes
    np.testing.assert_array_equal(cut.polygon, np.repeat(np.arange(len(sizes)), sizes - 2))
    np.testing.assert_array_equal(mesh.corners[cut.corners], cut.faces)
    corners = cut.corners.tolist()
    edges = collections.Counter((t[i - 1], t[i]) for t in corners for i in range(3))
    assert max(edges.values()) == 1
    alone = {(a, b) for a, b in edges if (b, a) not in edges}
    bounds = zip(mesh.offsets[:-1].tolist(), mesh.offsets[1:].tolist(), strict=True)
    assert alone == {(i, i + 1 if i + 1 < e else b) for b, e in bounds for i in range(b, e)}


def renumbered(rng: np.random.Generator, mesh: PolyMesh, turn: int) -> PolyMesh:
    """The mesh of one polygon from another corner on, its vertices shuffled."""
    order = rng.permutation(len(mesh.vertices))
    corners = np.argsort(order)[np.roll(mesh.corners, -turn)]
    return PolyMesh(mesh.vertices[order], corners, mesh.offsets)


# Areas


def assert_fills(points: np.ndarray, mesh: PolyMesh, normal: np.ndarray) -> None:
    found, exact = areas(mesh, normal), outlines.area(points)
    rounding = 1e-12 * np.abs(points).max() ** 2
    assert np.abs(found).sum() == pytest.approx(exact, rel=1e-9, abs=rounding * len(points))
    assert found.min() > -rounding
    assert_cut(mesh, mesh.triangulation())


@settings(max_examples=OUTLINES)
@given(st.integers(0, 2**32), st.integers(8, 60), st.booleans())
def test_triangles_of_simple_polygons_fill_them(seed, corners, tilted):
    rng = np.random.default_rng(seed)
    points = outlines.random_outline(rng, corners)
    mesh, normal = one_polygon(points), np.array([0.0, 0.0, 1.0])
    if tilted:
        vertices, normal = outlines.in_space(rng, points)
        mesh = one_polygon(vertices)
    assert_fills(points, mesh, normal)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("name", ["comb", "holes", "spiral", "star"])
def test_corners_that_repeat_the_one_before_fold_nothing(name, seed):
    rng = np.random.default_rng(seed)
    points = {
        "comb": outlines.comb(3 + seed % 5, 9.0),
        "holes": outlines.with_holes(rng, 2),
        "spiral": outlines.spiral(60, 3.0),
        "star": outlines.star(rng.uniform(0.05, 1, size=30)),
    }[name]
    points = np.repeat(points, rng.choice([1, 1, 2, 4], size=len(points)), axis=0)
    assert_fills(points, one_polygon(points), np.array([0.0, 0.0, 1.0]))


@pytest.mark.parametrize("name", LARGE)
def test_triangles_of_large_polygons_fill_them(name):
    rng = np.random.default_rng(7)
    points = LARGE[name](rng)
    vertices, normal = outlines.in_space(rng, points)
    assert_fills(points, one_polygon(vertices), normal)


@pytest.mark.parametrize("name", FLAT)
def test_areas_of_well_known_polygons(name):
    points, exact = FLAT[name]
    assert outlines.area(points) == pytest.approx(exact)
    for turn in range(len(points)):
        turned = np.roll(np.array(points, dtype=float), turn, axis=0)
        for way, order in ((1.0, turned), (-1.0, turned[::-1])):
            found = areas(one_polygon(order), [0.0, 0.0, way])
            assert found.min() > 0
            assert found.sum() == pytest.approx(exact)


def test_no_slivers_where_others_can_be():
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    for name, points in {
        "quad": [(0, 0), (1, 0), (2, 0), (2, 2)],
        "square": outlines.with_middles(np.array(square, dtype=float)),
        "board": outlines.with_middles(outlines.with_middles(np.array(square, dtype=float))),
    }.items():
        vertices, normal = outlines.in_space(np.random.default_rng(3), np.array(points))
        assert areas(one_polygon(vertices), normal).min() > 0.01, name


def test_files_of_triangles_have_the_area_of_the_polygons(tmp_path):
    bottom, top = (one_polygon([(x, y, z) for x, y in outlines.U]).vertices for z in (0, 1))
    rows = [list(range(8))[::-1], list(range(8, 16))]
    rows += [[i, (i + 1) % 8, (i + 1) % 8 + 8, i + 8] for i in range(8)]
    offsets = np.concatenate(([0], np.cumsum([len(row) for row in rows])))
    mesh = PolyMesh(np.concatenate([bottom, top]), np.concatenate(rows), offsets)
    for name in ("mesh.stl", "mesh.glb"):
        write_mesh(tmp_path / name, mesh)
        a, b, c = (read := read_mesh(tmp_path / name)).vertices[read.triangles].transpose(1, 0, 2)
        normals = np.cross(b - a, c - a) / 2
        assert np.linalg.norm(normals, axis=1).sum() == pytest.approx(2 * 7 + 16)
        assert np.einsum("ij,ij", a, normals) / 3 == pytest.approx(7)


# Neither the first corner nor the numbers decide


@given(st.integers(0, 2**32), st.integers(8, 40))
def test_simple_polygons_are_cut_alike_from_any_corner_on(seed, corners):
    rng = np.random.default_rng(seed)
    points = outlines.random_outline(rng, corners)
    mesh = one_polygon(outlines.in_space(rng, points)[0])
    expected = at_positions(mesh)
    for turn in range(len(points)):
        assert at_positions(renumbered(rng, mesh, turn)) == expected


@settings(max_examples=OUTLINES)
@given(st.integers(0, 2**32), st.integers(4, 9), st.integers(1, 4), st.booleans())
def test_any_polygons_are_cut_alike_from_any_corner_on(seed, corners, span, noisy):
    """On a lattice, where positions repeat, corners are in line, and lengths are equal."""
    rng = np.random.default_rng(seed)
    points = rng.integers(-span, span + 1, size=(corners, rng.integers(2, 4))).astype(float)
    mesh = one_polygon(points + noisy * 1e-3 * rng.normal(size=points.shape))
    assert_cut(mesh, mesh.triangulation())
    expected = at_positions(mesh)
    for turn in range(corners):
        assert at_positions(renumbered(rng, mesh, turn)) == expected


@pytest.mark.parametrize("name", DEGENERATE)
def test_polygons_that_are_not_simple_are_cut_all_the_same(name):
    mesh, rng = one_polygon(DEGENERATE[name]), np.random.default_rng(5)
    assert_cut(mesh, mesh.triangulation())
    expected = at_positions(mesh)
    for turn in range(len(mesh.corners)):
        turned = renumbered(rng, mesh, turn)
        assert_cut(turned, turned.triangulation())
        assert at_positions(turned) == expected
    signed = areas(mesh, [0.0, 0.0, 1.0]).sum()
    assert signed == pytest.approx(outlines.area(DEGENERATE[name]), abs=1e-12)


@pytest.mark.parametrize("name", ["spike", "spike inwards", "each twice"])
def test_polygons_that_repeat_corners_do_not_fold(name):
    assert areas(one_polygon(DEGENERATE[name]), [0.0, 0.0, 1.0]).min() >= 0


def test_a_mesh_is_cut_like_its_polygons_alone():
    rng = np.random.default_rng(11)
    polygons = [outlines.random_outline(rng, int(rng.integers(8, 30))) for _ in range(60)]
    polygons += [rng.normal(size=(k, 2)) for k in rng.integers(3, 9, size=60)]
    polygons += [np.array(points, dtype=float) for points in DEGENERATE.values()]
    polygons += [outlines.star(np.ones(k)) for k in range(3, 20)]
    order = rng.permutation(len(polygons))
    found = [outlines.in_space(rng, polygons[i])[0] for i in order]
    offsets = np.concatenate(([0], np.cumsum([len(points) for points in found])))
    mesh = PolyMesh(np.concatenate(found), np.arange(offsets[-1]), offsets)
    assert_cut(mesh, mesh.triangulation())
    alone = [
        one_polygon(points).triangles + first for points, first in zip(found, offsets, strict=False)
    ]
    np.testing.assert_array_equal(mesh.triangles, np.concatenate(alone))


def board(height) -> PolyMesh:
    x, y = np.divmod(np.arange(13 * 13), 13)
    first = np.arange(13 * 12).reshape(12, 13)[:, :12].ravel()
    quads = np.stack([first, first + 13, first + 14, first + 1], axis=1)
    vertices = np.stack([x, y, height(x, y)], axis=1).astype(float)
    return PolyMesh(vertices, quads.ravel(), np.arange(0, 4 * len(quads) + 1, 4))


@pytest.mark.parametrize("noise", [0, 1e-5])
def test_regular_quads_are_cut_in_parallel(noise):
    rng = np.random.default_rng(2)
    mesh = board(lambda x, y: 0 * x)
    mesh.vertices[:] += noise * rng.normal(size=mesh.vertices.shape)
    faces = mesh.triangles.reshape(-1, 2, 3)
    shared = [tuple(sorted(set(a) & set(b))) for a, b in faces.tolist()]
    assert {b - a for a, b in shared} == {14}


def test_quads_are_cut_along_the_shorter_diagonal():
    long = [(0, 0, 0), (2, 0, 0.5), (2.5, 2, 0), (0, 2, 0.5)]
    for turn in range(4):
        mesh = one_polygon(np.roll(long, turn, axis=0))
        kept = [set(map(tuple, mesh.vertices[face].tolist())) for face in mesh.triangles]
        assert kept[0] & kept[1] == {long[1], long[3]}


@pytest.mark.parametrize("keep_order", [False, True])
def test_files_are_cut_alike(keep_order):
    """Lossless positions, polygons from other corners on, vertices of other numbers."""
    rng = np.random.default_rng(4)
    quads = board(lambda x, y: rng.normal(size=x.shape))
    for mesh in (quads, one_polygon(outlines.comb(6, 9.0)), one_polygon(outlines.U)):
        data = encode(mesh, method="lossless", keep_order=keep_order)
        assert at_positions(decode(data)) == at_positions(mesh)


@settings(max_examples=OUTLINES // 15)
@given(st.integers(0, 2**32), st.integers(8, 24))
def test_files_of_any_outline_are_cut_alike(seed, corners):
    rng = np.random.default_rng(seed)
    mesh = one_polygon(outlines.in_space(rng, outlines.random_outline(rng, corners))[0])
    assert at_positions(decode(encode(mesh, method="lossless"))) == at_positions(mesh)


# Any numbers


@pytest.mark.parametrize("name", ["arrow", "U", "keyhole", "star"])
@pytest.mark.parametrize("exponent", [-1060, -600, 480, 1015])
def test_size_does_not_matter(name, exponent):
    """From subnormal numbers up to nearly the largest."""
    points = np.round(np.array(FLAT[name][0]) * 64) / 64
    mesh = one_polygon(points)
    scaled = one_polygon(np.ldexp(points, exponent))
    np.testing.assert_array_equal(scaled.triangles, mesh.triangles)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1.7e308])
@pytest.mark.parametrize("corners", [4, 8])
def test_any_numbers_make_triangles(value, corners):
    points = np.array(outlines.U[-corners:], dtype=float)
    for at in range(corners):
        mesh = one_polygon(points)
        mesh.vertices[at, 1] = value
        mesh.vertices[at - 1, 1] = -value
        assert_cut(mesh, mesh.triangulation())


def test_far_from_the_origin():
    points = np.array(outlines.U) + np.array([4.5e6, -3e6])
    assert areas(one_polygon(points), [0.0, 0.0, 1.0]).min() > 0


def test_ears_are_looked_at_in_parts(monkeypatch):
    """Any number of pairs at a time makes the same triangles."""
    rng = np.random.default_rng(8)
    mesh = one_polygon(outlines.with_holes(rng, 4))
    expected = mesh.triangles
    for pairs in (1, 7, 100):
        monkeypatch.setattr(ears, "_PAIRS", pairs)
        np.testing.assert_array_equal(mesh.triangles, expected)


def test_polygons_too_large_for_ears_are_fans(monkeypatch):
    monkeypatch.setattr("deltamesh_formats.polymesh.triangles._LARGEST", 7)
    mesh = one_polygon(outlines.U)
    assert len(np.unique(mesh.triangles[:, 0])) == 1
    assert_cut(mesh, mesh.triangulation())
    monkeypatch.setattr("deltamesh_formats.polymesh.triangles._LARGEST", 8)
    assert areas(mesh, [0.0, 0.0, 1.0]).min() > 0
