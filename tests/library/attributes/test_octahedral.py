"""Unit normals: the octahedral grid, predictions from the surface, and their payload."""

from __future__ import annotations

import contextlib
import itertools

import meshes
import numpy as np
import oracle
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import KDTree
from strategies import complexes

from deltamesh._attributes.normals.coding import (
    NONE,
    Normals,
    choose_normals,
    decode_normals,
    encode_normals,
    vectors_of,
)
from deltamesh._attributes.normals.octahedral import (
    ABSOLUTE,
    FRAME,
    LARGEST_DOUBT,
    POLE,
    RELATIVE,
    ZERO,
    from_octahedral,
    half,
    is_unit,
    quantize_normals,
    restore_normals,
    to_octahedral,
)
from deltamesh._attributes.normals.surface import (
    ANGLE,
    AREA,
    EQUAL,
    WEIGHTS,
    Surroundings,
    surface_normals,
)
from deltamesh._graph.elements import of_vertices
from deltamesh_formats.container.payload_layout import MAX_NORMAL_BITS, MIN_NORMAL_BITS
from deltamesh_formats.errors import FormatError
from deltamesh_formats.meshfiles.files import read_mesh

BITS = st.integers(MIN_NORMAL_BITS, 16)
SEEDS = st.integers(0, 2**32 - 1)
AXES = np.concatenate((np.eye(3), -np.eye(3)))


def largest_error(bits: int) -> float:
    """Return the largest angle between a normal and the nearest grid point, in radians.

    On a face of the octahedron, at 1 / sqrt(3) from the centre, the grid is one of equilateral
    triangles with sides of sqrt(2) / h: no point is further than sqrt(2 / 3) / h from a corner,
    which from the centre is an angle of at most sqrt(2) / h. At the prediction it is half of that.
    """
    return float(np.sqrt(2)) / half(bits)


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def directions(seed, count=200):
    """Random ones; some near the axes, the planes between them, and the pole of the frame."""
    rng = np.random.default_rng(seed)
    v = rng.normal(size=(count, 3))
    v *= 10.0 ** rng.integers(-12, 1, (count, 3)) * rng.integers(0, 2, (count, 3))
    near = rng.choice([1, -1], (count, 1)) * POLE + rng.normal(size=(count, 3)) * 1e-3
    v = np.where(rng.random((count, 1)) < 0.1, near, v)
    return unit(v[v.any(axis=1)])


def angles(a, b):
    """Between unit vectors, exact for small ones."""
    return 2 * np.arcsin(np.minimum(np.linalg.norm(a - b, axis=1) / 2, 1))


def around_triangles(F, n):
    return Surroundings(F.ravel(), np.arange(len(F) + 1) * 3, F.ravel(), n)


def diagonal(V):
    return float(np.linalg.norm(np.ptp(V, axis=0)))


# ---- The grid ----------------------------------------------------------------------------------


def test_the_frame_is_a_rotation():
    np.testing.assert_allclose(FRAME @ FRAME.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(FRAME) == pytest.approx(1)


@pytest.mark.parametrize("bits", [2, 3, 5, 6])
def test_every_point_of_the_grid_is_its_own_nearest(bits):
    h = half(bits)
    points = np.array(list(itertools.product(range(-h, h + 1), repeat=2)))
    found = from_octahedral(points, bits)
    twins = [oracle.octahedron(a, b, bits) for a, b in points.tolist()]
    np.testing.assert_allclose(found, twins, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(from_octahedral(to_octahedral(found, bits), bits), found)
    # Only points on the border share a direction: with those mirrored along it.
    inner = np.abs(points).max(axis=1) < h
    same = KDTree(found).query_ball_point(found, 1e-9, p=np.inf, return_length=True)
    assert (same[inner] == 1).all()
    assert (same[~inner] <= 4).all()


@given(SEEDS, st.integers(MIN_NORMAL_BITS, MAX_NORMAL_BITS))
def test_no_direction_is_further_than_stated_from_its_point(seed, bits):
    v = directions(seed)
    error = angles(from_octahedral(to_octahedral(v, bits), bits), v)
    assert error.max() <= largest_error(bits) + 1e-15


@pytest.mark.parametrize("bits", [4, 8, 10, 12, 16, 20])
def test_the_largest_error_is_met_at_the_middle_of_a_face_and_half_of_it_at_the_prediction(bits):
    h = half(bits)
    third = np.arange(h // 3 - 3, h // 3 + 4)
    a, b = (x.ravel().astype(float) + 1 / 3 for x in np.meshgrid(third, third))
    v = unit(np.stack((a, b, h - a - b), axis=1))  # the middles of triangles of the grid
    error = angles(from_octahedral(to_octahedral(v, bits), bits), v).max()
    assert (0.9 if bits < 8 else 0.99) * largest_error(bits) < error <= largest_error(bits)
    at = np.random.default_rng(4).uniform(-2, 2, (500, 2)) / h
    v = unit(np.concatenate((at, 1 - np.abs(at).sum(axis=1, keepdims=True)), axis=1))
    error = angles(from_octahedral(to_octahedral(v, bits), bits), v).max()
    assert error < largest_error(bits) * (0.5 + 3 / h)


def test_the_largest_error_in_degrees():
    found = [round(float(np.degrees(largest_error(b))), 3) for b in (8, 10, 12)]
    assert found == [0.638, 0.159, 0.04]


@given(SEEDS, BITS)
def test_the_grid_is_as_symmetric_as_the_octahedron(seed, bits):
    v = directions(seed, 50)
    points = to_octahedral(v, bits)
    here = angles(from_octahedral(points, bits), v)
    for signs in itertools.product((1, -1), repeat=3):
        there = angles(from_octahedral(to_octahedral(v * signs, bits), bits), v * signs)
        np.testing.assert_allclose(there, here, rtol=0, atol=1e-8 * largest_error(bits))
    x_for_y = angles(from_octahedral(to_octahedral(v[:, [1, 0, 2]], bits), bits), v[:, [1, 0, 2]])
    np.testing.assert_allclose(x_for_y, here, rtol=0, atol=1e-8 * largest_error(bits))


@pytest.mark.parametrize("bits", [2, 8, 10, 30])
def test_axes_are_exact_by_themselves(bits):
    no_trust = np.full(6, np.inf)
    codes = quantize_normals(AXES, np.zeros((6, 3)), no_trust, bits)
    assert (codes[:, 0] == ABSOLUTE).all()
    np.testing.assert_array_equal(restore_normals(codes, np.zeros((6, 3)), bits), AXES)


# ---- Relative to a prediction ---------------------------------------------------------------


@given(SEEDS, st.integers(MIN_NORMAL_BITS, MAX_NORMAL_BITS))
def test_zero_is_the_prediction_itself(seed, bits):
    p = np.concatenate((directions(seed), AXES))
    zeros = np.zeros((len(p), 3), dtype=np.int64)
    found = restore_normals(
        zeros, p * np.random.default_rng(seed).uniform(1e-9, 1e9, (len(p), 1)), bits
    )
    away = np.linalg.norm(p + POLE, axis=1)
    assert (angles(found, p) <= 1e-15 * (1 + 2 / away)).all()
    trusted = away > 1e-6
    codes = quantize_normals(p[trusted], p[trusted], np.zeros(trusted.sum()), bits)
    if bits <= 16:
        np.testing.assert_array_equal(codes, 0)


@given(SEEDS, BITS)
def test_normals_come_back_within_the_bound_and_small_differences_are_small_codes(seed, bits):
    rng = np.random.default_rng(seed)
    p = directions(seed)
    n = unit(p + rng.normal(size=p.shape) * 10.0 ** rng.integers(-5, 2, (len(p), 1)))
    codes = quantize_normals(n, p, np.full(len(p), 1e-12), bits)
    found = restore_normals(codes, p, bits)
    twins = [oracle.unit_normal(*pair, bits) for pair in zip(codes.tolist(), p, strict=True)]
    np.testing.assert_allclose(found, twins, rtol=0, atol=1e-9)
    assert angles(found, n).max() <= largest_error(bits) + 1e-9
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1, rtol=0, atol=1e-15)
    relative = codes[:, 0] == RELATIVE
    near = np.linalg.norm(codes[relative, 1:], axis=1) / half(bits)
    off = angles(n, p)[relative] + largest_error(bits)
    assert (near <= 1.5 * off).all()


def test_near_the_singular_prediction_normals_stand_by_themselves():
    p = unit(-POLE + np.array([[0, 0, 0], [1e-9, 0, 0], [0, 1e-3, 0], [0.5, 0, 0]]))
    codes = quantize_normals(p, p, np.full(4, 1e-7), 10)
    assert codes[:, 0].tolist() == [ABSOLUTE, ABSOLUTE, RELATIVE, RELATIVE]
    assert angles(restore_normals(codes, p, 10), p).max() <= largest_error(10)


def test_zero_vectors_are_exact():
    n = np.array([[0.0, 0, 0], [-0.0, 0, 0], [0, 0, 1]])
    codes = quantize_normals(n, np.ones((3, 3)), np.zeros(3), 10)
    assert codes[:2].tolist() == [[ZERO, 0, 0]] * 2
    found = restore_normals(codes, np.ones((3, 3)), 10)
    np.testing.assert_array_equal(found[:2], 0.0)
    assert not np.signbit(found[:2]).any()


@given(
    st.lists(
        st.tuples(*[st.integers(-(2**63), 2**63 - 1)] * 3, *[st.floats()] * 3),
        min_size=1,
        max_size=20,
    ),
    st.integers(MIN_NORMAL_BITS, MAX_NORMAL_BITS),
)
def test_any_codes_and_predictions_make_unit_vectors_or_zeros(rows, bits):
    codes = np.array([row[:3] for row in rows], dtype=np.int64)
    codes[::2, 0] %= 3
    predicted = np.array([row[3:] for row in rows])
    predicted[1::4] = -POLE
    length = np.linalg.norm(restore_normals(codes, predicted, bits), axis=1)
    np.testing.assert_allclose(length, codes[:, 0] != ZERO, rtol=0, atol=1e-15)


# ---- Predictions ----------------------------------------------------------------------------


@given(complexes(), SEEDS, st.sampled_from(WEIGHTS))
def test_surface_normals_are_what_a_loop_makes(mesh, seed, weights):
    V, F = mesh
    rng = np.random.default_rng(seed)
    count = len(V) + 3
    elements = rng.integers(0, count, F.size)
    # Polygons of three to six corners, some of which repeat vertices.
    offsets = np.unique(np.concatenate(([0, F.size], rng.choice(F.size // 3, 5) * 3)))
    sums, doubt = surface_normals(V, Surroundings(F.ravel(), offsets, elements, count), weights, 0)
    rows = list(itertools.pairwise(offsets))
    twin = oracle.facing(
        V, [F.ravel()[a:b] for a, b in rows], [elements[a:b] for a, b in rows], count, weights
    )
    # Areas are in units of the extent, if there is one.
    twin /= (float(np.ptp(V, axis=0).max()) or 1.0) ** 2 if weights == AREA else 1.0
    sure = doubt < 1e-4
    np.testing.assert_allclose(sums[sure], twin[sure], rtol=0, atol=1e-6)
    assert np.isinf(doubt[np.bincount(elements, minlength=count) == 0]).all()


@given(SEEDS, st.sampled_from(WEIGHTS), st.integers(-14, -1), st.booleans())
def test_normals_stay_within_the_bound_where_positions_differ(seed, weights, exponent, far):
    """Any polygons, slivers too: a decoder with other positions restores nearly the same."""
    rng = np.random.default_rng(seed)
    V = rng.normal(size=(30, 3)) * 10.0 ** rng.integers(-6, 1, (30, 1)) + (1e6 if far else 0.0)
    F = rng.integers(0, 30, (40, 4))
    around = Surroundings(F.ravel(), np.arange(41) * 4, F.ravel(), 30)
    tolerance = 10.0**exponent * diagonal(V)
    sums, doubt = surface_normals(V, around, weights, tolerance)
    moves = unit(rng.normal(size=V.shape)) * tolerance * 0.99
    other, _ = surface_normals(V + moves, around, weights, 0.0)
    sure = np.isfinite(doubt)
    assert (angles(unit(sums[sure]), unit(other[sure])) <= doubt[sure] + 1e-12).all()
    n = directions(seed)[:30]
    k = len(n)
    for bits in (4, 8, 12):
        codes = quantize_normals(n, sums[:k], doubt[:k], bits)
        error = angles(restore_normals(codes, other[:k], bits), n)
        assert error.max() <= largest_error(bits) + 1.1 * LARGEST_DOUBT / half(bits)


def test_doubt_is_small_for_a_good_mesh_and_infinite_for_slivers():
    V, F = meshes.icosphere(3)
    _, doubt = surface_normals(V, around_triangles(F, len(V)), AREA, 1e-9)
    assert 1e-9 < doubt.max() < 1e-6
    V, F = meshes.collapsed()
    for weights in WEIGHTS:
        sums, doubt = surface_normals(V, around_triangles(F, 4), weights, 1e-9)
        np.testing.assert_array_equal(sums, 0)
        assert np.isinf(doubt).all()


@pytest.mark.parametrize("weights", WEIGHTS)
def test_the_triangles_of_a_flat_polygon_do_not_matter(weights):
    """A cube of squares: exact at its creases, and by all weights alike at its vertices."""
    V = np.array(list(itertools.product((0.0, 1), repeat=3)))
    quads = np.array(
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    )
    offsets, corners = np.arange(7) * 4, quads.ravel()
    vertices, _ = surface_normals(V, Surroundings(corners, offsets, corners, 8), weights, 0)
    np.testing.assert_allclose(unit(vertices), unit(V - 0.5), atol=1e-15)
    creases, _ = surface_normals(
        V, Surroundings(corners, offsets, np.repeat(np.arange(6), 4), 6), weights, 0
    )
    np.testing.assert_allclose(unit(creases), unit(V[quads].mean(axis=1) - 0.5), atol=1e-15)


@pytest.mark.parametrize("scale", [1e-150, 1e-9, 1.0, 1e9, 1e149])
def test_neither_scale_nor_place_matters(scale):
    V, F = meshes.torus(9, 7)
    here, doubt = surface_normals(V, around_triangles(F, len(V)), ANGLE, 1e-9)
    there, same = surface_normals(V * scale, around_triangles(F, len(V)), ANGLE, 1e-9 * scale)
    np.testing.assert_allclose(there, here, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(same, doubt, rtol=1e-6)


# ---- What are normals -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (np.eye(3), True),
        (np.eye(3, dtype=np.float32) * np.float32(1.0009), True),
        (np.zeros((2, 3)), True),
        (np.zeros((0, 3)), True),
        (np.eye(3) * 1.002, False),
        (np.full((2, 3), 1e-9), False),
        (np.array([[0, 0, 1], [np.nan, 0, 0]]), False),
        (np.array([[0, 0, np.inf]]), False),
        (np.array([[0, 0, 1e300]]), False),
        (np.eye(3, dtype=np.int64), False),
        (np.eye(2), False),
        (np.ones(3), False),
    ],
)
def test_unit_vectors_and_zeros_are_normals(values, expected):
    assert is_unit(values) is expected


# ---- The payload ----------------------------------------------------------------------------


@given(complexes(), SEEDS, st.integers(MIN_NORMAL_BITS, 12), st.sampled_from((*WEIGHTS, NONE)))
def test_codes_come_back(mesh, seed, bits, weights):
    V, F = mesh
    rng = np.random.default_rng(seed)
    h = half(bits)
    codes = rng.integers(-h, h, (len(V), 3), endpoint=True)
    codes[:, 0] = rng.choice([ABSOLUTE, ZERO] if weights == NONE else 3, len(V))
    codes[codes[:, 0] == ZERO, 1:] = 0
    payload = encode_normals(Normals(codes, bits, weights), of_vertices(F, len(V)))
    found = decode_normals(payload, of_vertices(F, len(V)))
    np.testing.assert_array_equal(found.codes, codes)
    assert (found.bits, found.weights) == (bits, weights)


@given(complexes(), SEEDS, BITS)
def test_any_normals_of_any_mesh_come_back_within_the_bound(mesh, seed, bits):
    V, F = mesh
    rng = np.random.default_rng(seed)
    around = around_triangles(F, len(V))
    sums, _ = surface_normals(V, around, AREA, 0)
    n = sums + rng.normal(size=V.shape) * 10.0 ** rng.integers(-6, 1)
    length = np.linalg.norm(n, axis=1)
    n /= np.where(length > 0, length, 1)[:, None] * rng.uniform(0.9995, 1.0005, (len(V), 1))
    n[rng.random(len(V)) < 0.1] = 0
    assert is_unit(n)
    arguments = (of_vertices(F, len(V)), bits, 1e-9 * diagonal(V))
    normals, payload = choose_normals(n, V, around, *arguments)
    found = vectors_of(decode_normals(payload, of_vertices(F, len(V))), V, around)
    np.testing.assert_array_equal(found, vectors_of(normals, V, around))
    zero = ~n.any(axis=1)
    np.testing.assert_array_equal(found[zero], 0)
    error = angles(found[~zero], unit(n[~zero]))
    assert error.max(initial=0) <= largest_error(bits) * 1.0001 + 1e-9


def normals_of(V, F, weights):
    return unit(surface_normals(V, around_triangles(F, len(V)), weights, 0)[0])


@pytest.mark.parametrize("weights", WEIGHTS)
def test_normals_of_the_surface_take_next_to_nothing(weights):
    V, F = meshes.grid(40, 50)
    V = V + np.random.default_rng(5).normal(size=V.shape) * 0.004
    n, around = normals_of(V, F, weights), around_triangles(F, len(V))
    normals, payload = choose_normals(n, V, around, of_vertices(F, len(V)), 12, 1e-9 * diagonal(V))
    assert normals.weights == weights
    assert not normals.codes.any()
    assert len(payload) < 20


def test_made_up_normals_that_are_alike_are_coded_by_themselves():
    V, F = meshes.grid(40, 50)
    V = V + np.random.default_rng(5).normal(size=V.shape) * 0.01
    n = np.where(V[:, :1] > 0.5, [[0.6, 0, 0.8]], [[0, 0, 1.0]])
    around = around_triangles(F, len(V))
    normals, payload = choose_normals(n, V, around, of_vertices(F, len(V)), 10, 0.0)
    assert normals.weights == NONE
    assert len(payload) < len(V) / 8


def test_no_elements():
    none = of_vertices(np.zeros((0, 3), np.int64), 0)
    payload = encode_normals(Normals(np.zeros((0, 3), np.int64), 10, AREA), none)
    assert len(decode_normals(payload, none).codes) == 0


SPHERE = meshes.icosphere(1)


def payload_with(codes, bits=6, weights=EQUAL):
    return encode_normals(Normals(codes, bits, weights), of_vertices(SPHERE[1], 42))


@pytest.mark.parametrize(
    ("payload", "offset"),
    [
        (b"", 0),
        (b"\x0a", 1),
        (b"\x01\x00", 0),
        (b"\x1f\x00", 0),
        (b"\x0a\x08", 1),
        (b"\x0a\x80", 1),
        (b"\x0a\x00\x00", 2),
    ],
)
def test_heads_that_are_refused(payload, offset):
    with pytest.raises(FormatError) as caught:
        decode_normals(payload, of_vertices(SPHERE[1], 42))
    assert caught.value.offset == offset


@pytest.mark.parametrize(
    ("row", "weights"),
    [
        ((3, 0, 0), EQUAL),
        ((-1, 0, 0), EQUAL),
        ((0, 32, 0), EQUAL),
        ((0, 0, -32), EQUAL),
        ((1, 32, 5), EQUAL),
        ((2, 1, 0), EQUAL),
        ((2, 0, -1), NONE),
        ((0, 0, 0), NONE),
        ((2**30, 2**31 - 1, -(2**31) + 1), EQUAL),
    ],
)
def test_codes_that_are_refused(row, weights):
    codes = np.tile(np.array([1, 31, -31]), (42, 1))
    decode_normals(payload_with(codes, weights=weights), of_vertices(SPHERE[1], 42))
    codes[17] = row
    with pytest.raises(FormatError, match="normal 17"):
        decode_normals(payload_with(codes, weights=weights), of_vertices(SPHERE[1], 42))


@given(st.binary(max_size=60), st.booleans())
def test_any_bytes_end_well(data, numbers):
    head = bytes((10, 4 * numbers))
    with contextlib.suppress(FormatError):
        found = decode_normals(head + data, of_vertices(SPHERE[1], 42))
        assert np.abs(found.codes[:, 1:]).max() <= half(10)


def test_damage_at_the_end_is_found():
    payload = payload_with(np.tile(np.array([1, 31, -31]), (42, 1)))
    for bad in (payload + b"\x01", payload[:-1]):
        with pytest.raises(FormatError):
            decode_normals(bad, of_vertices(SPHERE[1], 42))


# ---- Real meshes ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "weights", "bits_each"),
    [
        ("clean/cow_ngon.obj", EQUAL, 0.1),
        pytest.param("clean/tank.obj", ANGLE, 1, marks=pytest.mark.slow),
        ("clean/featuretype.ply", AREA, 0.1),
    ],
)
def test_real_normals_are_those_of_the_surface(name, weights, bits_each):
    """As their programs made them: the cow's from its polygons, each alike."""
    path = meshes.folder() / name
    if not path.exists():
        pytest.skip(f"no {path}: DELTAMESH_MESHES names the folder of larger meshes")
    mesh = read_mesh(path)
    attribute = mesh.attribute("normal", "vertex", "corner")
    assert is_unit(attribute.values)
    elements, values, count = mesh.corners, attribute.values, len(mesh.vertices)
    if attribute.domain == "corner":
        rows = mesh.corners * len(values) + attribute.rows()
        keys, elements = np.unique(rows, return_inverse=True)
        values, count = values[keys % len(values)], len(keys)
    around = Surroundings(mesh.corners, mesh.offsets, elements, count)
    faces = elements[mesh.triangulation().corners]
    tolerance = 1e-12 * diagonal(mesh.vertices)
    elements = of_vertices(faces, count)
    normals, payload = choose_normals(
        values.astype(np.float64), mesh.vertices, around, elements, 10, tolerance
    )
    assert normals.weights == weights
    assert (normals.codes == 0).all(axis=1).mean() > 0.8
    assert 8 * len(payload) < bits_each * count
