"""Order of vertices and faces: kept exactly, and cheaply where it follows the mesh."""

from __future__ import annotations

import math
import time

import forging
import meshes
import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from deltamesh import decode, encode, info
from deltamesh._options import Options
from deltamesh._order.coding import decode_order, encode_order
from deltamesh._order.reordering import Order, order_of, reordered
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh._shape.polygons import plain
from deltamesh._shape.provenance import Provenance
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import from_triangles

MANIFOLDS = {name: mesh for name, mesh in meshes.every().items() if name != "three_pages"}


def identity(n, m):
    return Order(np.arange(n), np.arange(m), np.zeros(m, dtype=np.int64))


def scrambled(n, m, seed):
    rng = np.random.default_rng(seed)
    return Order(rng.permutation(n), rng.permutation(m), rng.integers(0, 3, m))


def assert_round_trip(faces, order):
    """Encode and decode; return the payload."""
    payload = encode_order(faces, plain(len(faces)), order)
    decoded = decode_order(memoryview(payload), faces, plain(len(faces)), len(order.vertices))
    for name in ("vertices", "polygons", "rotations"):
        np.testing.assert_array_equal(getattr(decoded, name), getattr(order, name))
        assert getattr(decoded, name).dtype == np.int64
    return payload


def naive(n, m):
    """The bytes of any order, all as likely: log2(n! m! 3^m) bits."""
    return (math.lgamma(n + 1) + math.lgamma(m + 1) + m * math.log(3)) / math.log(256)


@pytest.mark.parametrize("name", MANIFOLDS)
@pytest.mark.parametrize("method", ["highpass", "cartesian"])
def test_a_mesh_comes_back_in_its_order(name: str, method: str) -> None:
    V, F = MANIFOLDS[name]
    mesh, _ = meshes.shuffled(V, F, 5)
    encoded = encode_mesh(meshes.as_polymesh(mesh), Options(method=method, keep_order=True))
    decoded = decode(encoded.data)
    np.testing.assert_array_equal(decoded.faces, mesh.faces)
    np.testing.assert_array_equal(encoded.mesh.faces, mesh.faces)
    np.testing.assert_array_equal(encoded.order, np.arange(len(V)))
    assert np.abs(decoded.vertices - mesh.vertices).max() < 0.05
    np.testing.assert_allclose(decoded.vertices, encoded.mesh.vertices, rtol=0, atol=1e-8)


@given(strategies.surfaces(), st.sampled_from(["highpass", "cartesian"]), st.booleans())
@strategies.FEW
def test_any_mesh_comes_back_in_its_order(
    mesh: meshes.Arrays, method: str, drop_isolated: bool
) -> None:
    V, F = mesh
    options = Options(method=method, keep_order=True, drop_isolated=drop_isolated)
    encoded = encode_mesh(from_triangles(V, F), options)
    decoded = decode(encoded.data)
    used = np.unique(F) if drop_isolated else np.arange(len(V))
    np.testing.assert_array_equal(encoded.order, used)
    np.testing.assert_array_equal(used[decoded.faces], F)
    np.testing.assert_allclose(decoded.vertices, encoded.mesh.vertices, rtol=0, atol=1e-7)


def test_the_positions_are_those_of_the_file_without_an_order() -> None:
    mesh, _ = meshes.shuffled(*meshes.with_isolated(), 3)
    whole = meshes.as_polymesh(mesh)
    kept, free = (
        encode_mesh(whole, Options(method="cartesian", keep_order=one)) for one in (True, False)
    )
    np.testing.assert_array_equal(
        decode(kept.data).vertices[free.order], decode(free.data).vertices
    )


def test_vertices_at_one_position_keep_their_places() -> None:
    V, F = meshes.icosphere(1)
    corners = F[np.random.default_rng(1).permutation(len(F))].ravel()
    soup = from_triangles(V[corners], np.arange(len(corners)).reshape(-1, 3))
    encoded = encode_mesh(soup, Options(method="cartesian", keep_order=True))
    np.testing.assert_array_equal(encoded.order, np.arange(len(corners)))
    np.testing.assert_array_equal(decode(encoded.data).faces, soup.faces)


def test_bytes_without_the_option_are_what_they_were() -> None:
    V, F = meshes.torus(9, 7)
    assert encode(V, F) == encode(V, F, keep_order=False)
    assert "ORDR" not in info(encode(V, F)).sections
    assert "ORDR" in info(encode(V, F, keep_order=True)).sections


# ---- The coder, of any triangles ---------------------------------------------------------------


@st.composite
def complexes(draw: st.DrawFn) -> tuple[np.ndarray, int]:
    """Any triangles at all: degenerate, double, on one edge; and vertices without any."""
    n = draw(st.integers(1, 30))
    corner = st.integers(0, n - 1)
    faces = draw(st.lists(st.tuples(corner, corner, corner), min_size=1, max_size=60))
    return np.array(faces), n + draw(st.integers(0, 3))


@given(complexes(), st.integers(0, 2**32), st.booleans())
def test_any_order_of_any_triangles(mesh: tuple[np.ndarray, int], seed: int, near: bool) -> None:
    faces, n = mesh
    order = scrambled(n, len(faces), seed)
    if near:  # runs, so that steps are told in all ways
        for one in (order.vertices, order.polygons):
            at = seed % len(one)
            one[at:] = np.sort(one[at:])
    assert_round_trip(faces, order)


@given(complexes(), st.integers(0, 2**32))
def test_order_of_finds_what_reordered_does(mesh: tuple[np.ndarray, int], seed: int) -> None:
    faces, n = mesh
    V = np.arange(3.0 * n).reshape(-1, 3)
    polygons, order = plain(len(faces)), scrambled(n, len(faces), seed)
    other = reordered(from_triangles(V, faces), order)
    # Where vertices and corners of the mesh are in the other order.
    places, own = np.argsort(order.vertices), np.argsort(order.polygons)
    corners = (3 * own[:, None] + (np.arange(3) - order.rotations[own, None]) % 3).ravel()
    found = order_of(polygons, Provenance(places, corners, own), other.offsets)
    for name in ("vertices", "polygons", "rotations"):
        np.testing.assert_array_equal(getattr(found, name), getattr(order, name))
    assert np.array_equal(places[faces].ravel()[np.argsort(corners)], other.corners)


@pytest.mark.parametrize("name", MANIFOLDS)
def test_the_order_of_the_codec_costs_a_few_bytes(name: str) -> None:
    V, F = MANIFOLDS[name]
    assert len(assert_round_trip(F, identity(len(V), len(F)))) < 12


def test_an_order_of_scan_lines_costs_little() -> None:
    V, F = meshes.grid(60, 60)
    mesh, _ = meshes.shuffled(V, F, 11)
    lines = np.argsort(mesh.vertices[:, 0] * 1000 + mesh.vertices[:, 1])
    places = np.argsort(lines)
    for faces in (places[mesh.faces].min(axis=1), places[mesh.faces].max(axis=1)):
        order = Order(lines, np.argsort(faces, kind="stable"), np.zeros(len(F), dtype=np.int64))
        # The corners at which faces begin are random here: log2(3) bits each.
        random = len(F) * math.log2(3) / 8
        assert len(assert_round_trip(mesh.faces, order)) < random + 0.05 * naive(*map(len, (V, F)))


def test_an_order_of_several_places_alternately_costs_little() -> None:
    V, F = meshes.torus(60, 40)
    lanes = np.arange(len(F)).reshape(4, -1).T.ravel()
    order = Order(np.arange(len(V)), lanes, np.zeros(len(F), dtype=np.int64))
    assert len(assert_round_trip(F, order)) < 0.1 * naive(len(V), len(F))


def test_vertices_by_their_first_use_cost_nothing() -> None:
    V, F = meshes.torus(40, 30)
    order = scrambled(len(V), len(F), 4)
    by_use = F[order.polygons][
        np.arange(len(F))[:, None], (order.rotations[:, None] + np.arange(3)) % 3
    ]
    _, first = np.unique(by_use, return_index=True)
    order = Order(np.argsort(first), order.polygons, order.rotations)
    size = len(assert_round_trip(F, order))
    assert size < 1.05 * naive(0, len(F))


@pytest.mark.parametrize("seed", range(2))
def test_an_order_without_any_pattern_costs_hardly_more_than_it_must(seed: int) -> None:
    V, F = meshes.torus(60, 40)
    size = len(assert_round_trip(F, scrambled(len(V), len(F), seed)))
    assert naive(len(V), len(F)) < size < 1.03 * naive(len(V), len(F))


def test_a_hub_of_all_faces_takes_linear_time() -> None:
    faces = np.array([(0, i, i + 1) for i in range(1, 30001)])
    order = scrambled(30002, len(faces), 6)
    start = time.process_time()
    assert_round_trip(faces, order)
    assert time.process_time() - start < 20


def test_a_real_order() -> None:
    """That of a scan whose file goes along its lines."""
    mesh = meshes.real("clean/mountain.obj")
    whole = meshes.as_polymesh(mesh)
    encoded = encode_mesh(whole, Options(method="cartesian", keep_order=True))
    np.testing.assert_array_equal(decode(encoded.data).faces, mesh.faces)
    assert info(encoded.data).sections["ORDR"].size < 200


# ---- Damage ------------------------------------------------------------------------------------


def payloads():
    """Faces, count of vertices, order and payload, with steps of all ways."""
    V, F = meshes.union(meshes.torus(6, 5), meshes.grid(4, 4))
    for seed in (0, 1):
        order = scrambled(len(V), len(F), seed)
        if seed:
            order.polygons[30:] = np.sort(order.polygons[30:])
        yield F, len(V), encode_order(F, plain(len(F)), order)


PAYLOADS = list(payloads())


def decoded_or_refused(payload, faces, n):
    """A permutation, whatever the bytes, or a FormatError with an offset in them."""
    try:
        order = decode_order(memoryview(payload), faces, plain(len(faces)), n)
    except FormatError as error:
        offset = error.offset
    else:
        offset = 0
        assert_permutations(order, len(faces), n)
    assert offset is not None
    assert 0 <= offset <= len(payload)


def assert_permutations(order, m, n):
    np.testing.assert_array_equal(np.sort(order.vertices), np.arange(n))
    np.testing.assert_array_equal(np.sort(order.polygons), np.arange(m))
    assert set(order.rotations) <= {0, 1, 2}


@given(st.sampled_from(PAYLOADS), st.binary(max_size=200))
def test_random_bytes(case: tuple, payload: bytes) -> None:
    decoded_or_refused(payload, *case[:2])


@given(st.sampled_from(PAYLOADS), st.integers(0, 15), st.binary(max_size=120))
def test_random_streams(case: tuple, plan: int, stream: bytes) -> None:
    """A plan and a size that are right, so that the streams are read."""
    size = min(len(stream) // 3, 127)
    decoded_or_refused(bytes([plan, size]) + stream, *case[:2])


@given(st.sampled_from(PAYLOADS), st.integers(0, 10**6), st.integers(0, 7))
def test_flipped_bits(case: tuple, at: int, bit: int) -> None:
    faces, n, payload = case
    changed = bytearray(payload)
    changed[at % len(changed)] ^= 1 << bit
    decoded_or_refused(bytes(changed), faces, n)


@pytest.mark.parametrize("case", PAYLOADS, ids=["scrambled", "runs"])
def test_every_truncation(case: tuple) -> None:
    """What is left may be an order, then one that ends in that of the codec: the digest tells."""
    faces, n, payload = case
    whole = decode_order(memoryview(payload), faces, plain(len(faces)), n)
    for size in range(len(payload)):
        try:
            order = decode_order(memoryview(payload[:size]), faces, plain(len(faces)), n)
        except FormatError:
            continue
        pairs = zip(order.arrays, whole.arrays, strict=True)
        assert not all(np.array_equal(one, other) for one, other in pairs)


def test_another_order_is_noticed() -> None:
    """The digest of a file covers its order."""
    V, F = meshes.icosphere(1)
    data = encode(V, F, method="cartesian", keep_order=True)
    faces = decode(encode(V, F, method="cartesian")).faces
    payload = encode_order(faces, plain(len(F)), scrambled(len(V), len(F), 7))
    with pytest.raises(FormatError, match="checksum of the decoded integers"):
        decode(forging.forged(data, ORDR=payload))
    decode(forging.consistent(forging.forged(data, ORDR=payload)))
