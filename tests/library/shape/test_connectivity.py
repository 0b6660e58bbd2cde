"""Section of the connectivity: any manifold comes back, and no other payload is read."""

from __future__ import annotations

import time
import tracemalloc

import meshes
import numpy as np
import oracle
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._shape.connectivity import decode_connectivity, encode_connectivity
from deltamesh._shape.topology import build_topology
from deltamesh._streams import entropy
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.errors import FormatError

MANIFOLDS = {name: mesh for name, mesh in meshes.every().items() if name != "three_pages"}


def topology_of(F, n):
    return build_topology(F, pair_halfedges(F), n)


def assert_round_trip(F, n):
    """Encode and decode; return the payload and the connectivity."""
    payload, coded = encode_connectivity(topology_of(F, n))
    decoded = decode_connectivity(memoryview(payload), len(coded.order), len(F))
    np.testing.assert_array_equal(decoded, coded.manifold.faces)
    np.testing.assert_array_equal(coded.manifold.opposite, pair_halfedges(decoded))
    assert decoded.dtype == np.int64
    assert sorted(coded.order) == sorted(set(F.ravel()))
    assert strategies.canonical(coded.order[decoded]) == strategies.canonical(F)
    return payload, coded


@pytest.mark.parametrize("name", MANIFOLDS)
def test_round_trip(name: str) -> None:
    V, F = MANIFOLDS[name]
    assert_round_trip(F, len(V))


@given(strategies.surfaces())
def test_any_surface_round_trips(mesh: meshes.Arrays) -> None:
    assert_round_trip(mesh[1], len(mesh[0]))


@given(st.sampled_from(sorted(MANIFOLDS)), st.integers(0, 2**32))
def test_any_order_round_trips(name: str, seed: int) -> None:
    mesh, _ = meshes.shuffled(*MANIFOLDS[name], seed)
    assert_round_trip(mesh.faces, len(mesh.vertices))


@pytest.mark.parametrize(
    "F",
    [
        pytest.param([[0, 1, 2]], id="triangle"),
        pytest.param([[0, 1, 2], [0, 2, 1]], id="pillow"),
        pytest.param([[0, 1, 2], [2, 1, 3]], id="two triangles"),
        pytest.param([[0, 1, 2], [3, 4, 5], [6, 7, 8]], id="three components"),
        pytest.param([[i, (i + 1) % 200, 200] for i in range(200)], id="fan of valence 200"),
        pytest.param([[i, i + 1, 200] for i in range(199)], id="open fan"),
        pytest.param(
            [[i, (i + 1) % 99, 99] for i in range(99)]
            + [[(i + 1) % 99, i, 100] for i in range(99)],
            id="two hubs",
        ),
    ],
)
def test_extreme_valences_and_tiny_meshes(F: list[list[int]]) -> None:
    faces = np.array(F)
    assert_round_trip(faces, faces.max() + 1)


def test_a_long_strip_and_a_comb_of_holes() -> None:
    V, F = meshes.grid(2, 500)
    assert_round_trip(F, len(V))
    V, F = meshes.grid(41, 41)
    centre = V[F].mean(axis=1) * 40
    hole = ((centre[:, :2] % 4 >= 1) & (centre[:, :2] % 4 < 3)).all(axis=1)
    _, coded = assert_round_trip(F[~hole], len(V))
    assert len(coded.order) == len(V) - 100


def test_many_components() -> None:
    V, F = meshes.union(*[meshes.tetrahedron(), meshes.grid(2, 2), meshes.icosphere(0)] * 60)
    assert_round_trip(F, len(V))


@pytest.mark.parametrize("name", MANIFOLDS)
def test_order_follows_the_oracle(name: str) -> None:
    assert_grows_as_the_oracle(*MANIFOLDS[name])


@strategies.SOME
@given(strategies.surfaces())
def test_order_follows_the_oracle_on_any_surface(mesh: meshes.Arrays) -> None:
    assert_grows_as_the_oracle(*mesh)


def assert_grows_as_the_oracle(V, F):
    topology = topology_of(F, len(V))
    faces, order = oracle.RegionGrower(topology.faces).grow()
    # Without the vertices that close boundary loops, and their faces.
    real = [v for v in order if v < len(V)]
    label = {order.index(v): i for i, v in enumerate(real)}
    expected = [[label[v] for v in f] for f in faces if label.keys() >= set(f)]
    _, coded = encode_connectivity(topology)
    assert coded.manifold.faces.tolist() == expected
    assert coded.order.tolist() == real


def test_same_bytes_on_two_runs() -> None:
    V, F = meshes.double_torus()
    assert encode_connectivity(topology_of(F, len(V)))[0] == assert_round_trip(F, len(V))[0]


# ---- Payloads that no encoder has written; there is no checksum in the way ---------------------


def decoded_or_refused(payload, vertex_count, face_count):
    """Whether a payload is refused; what is not must be faces."""
    refusal = None
    try:
        faces = decode_connectivity(memoryview(payload), vertex_count, face_count)
    except FormatError as error:
        refusal = error
    if refusal is not None:
        assert 0 <= refusal.offset <= len(payload)
        return True
    assert faces.shape == (face_count, 3)
    assert faces.dtype == np.int64
    assert ((faces >= 0) & (faces < vertex_count)).all()
    return False


@pytest.mark.parametrize("name", MANIFOLDS)
def test_truncated_payload(name: str) -> None:
    V, F = MANIFOLDS[name]
    payload, coded = assert_round_trip(F, len(V))
    n, m = len(coded.order), len(F)
    refused = [decoded_or_refused(payload[:size], n, m) for size in range(len(payload))]
    assert all(refused[:3])
    assert all(refused) or sum(refused) > len(refused) // 2


@pytest.mark.parametrize("name", MANIFOLDS)
def test_flipped_bits_in_the_payload(name: str) -> None:
    V, F = MANIFOLDS[name]
    payload, coded = assert_round_trip(F, len(V))
    for at in range(min(8 * len(payload), 400)):
        damaged = bytearray(payload)
        damaged[at // 8] ^= 1 << at % 8
        decoded_or_refused(bytes(damaged), len(coded.order), len(F))


@pytest.mark.parametrize("name", ["tetrahedron", "double_torus", "grid", "two_components"])
def test_wrong_counts_are_refused(name: str) -> None:
    V, F = MANIFOLDS[name]
    payload, coded = assert_round_trip(F, len(V))
    n, m = len(coded.order), len(F)
    for vertex_count, face_count in ((n - 1, m), (n + 1, m), (n, m - 2), (n, m + 2)):
        assert decoded_or_refused(payload, vertex_count, face_count)


def test_more_bytes_are_refused() -> None:
    V, F = meshes.icosphere(1)
    payload, coded = assert_round_trip(F, len(V))
    for rest in (b"\0", b"\1", bytes(6), payload):
        assert decoded_or_refused(payload + rest, len(coded.order), len(F))


@given(
    st.binary(max_size=80),
    st.tuples(*[st.integers(0, 6)] * 3),
    st.integers(0, 200),
    st.integers(0, 400),
)
def test_random_payloads(
    stream: bytes, counts: tuple[int, int, int], vertex_count: int, face_count: int
) -> None:
    payload = b"".join(map(write_varint, counts)) + stream
    decoded_or_refused(payload, vertex_count, face_count)


@given(st.binary(max_size=40))
def test_random_bytes(payload: bytes) -> None:
    decoded_or_refused(payload, 100, 196)


@pytest.mark.parametrize("at", [0, 1, 2])
@pytest.mark.parametrize("count", [101, 10**4, 2**31, 2**62])
def test_counts_of_the_payload_are_bounded(at: int, count: int) -> None:
    """Memory and time go by the number of faces, whatever the payload announces."""
    counts = [0, 0, 0]
    counts[at] = count
    if at == 0:
        counts[1] = count  # as many boundary edges as loops
    payload = b"".join(map(write_varint, counts)) + bytes(range(1, 40))
    start = time.perf_counter()
    tracemalloc.start()
    try:
        assert decoded_or_refused(payload, 50, 100)
        assert tracemalloc.get_traced_memory()[1] < 5 << 20
    finally:
        tracemalloc.stop()
    assert time.perf_counter() - start < 5


def test_a_stream_of_zeros_ends() -> None:
    """It costs a fraction of a bit per face: the header's counts are the bound of the work."""
    payload = b"\0\0\0"
    start = time.perf_counter()
    decoded_or_refused(payload, 50_000, 99_996)
    assert time.perf_counter() - start < 5


def test_regular_meshes_cost_next_to_nothing() -> None:
    """A sanity check of the model, far from its real numbers: 6 is the common valence."""
    V, F = meshes.torus(60, 50)
    payload, _ = assert_round_trip(F, len(V))
    assert 8 * len(payload) < 0.2 * len(V)


def test_valence_entropy_is_the_yardstick() -> None:
    """Flipped edges at random: about the zero-order entropy of the valences, not more."""
    _, F = meshes.torus(40, 40)
    F = flipped(F, 1500)
    valence = np.bincount(F.ravel())
    share = np.bincount(valence) / len(valence)
    entropy_bits = -(share[share > 0] * np.log2(share[share > 0])).sum() * len(valence)
    payload, _ = assert_round_trip(F, len(valence))
    assert 8 * len(payload) < 1.1 * entropy_bits


def flipped(F, count):
    """The mesh with random edges flipped; quick, for larger meshes."""
    rng = np.random.default_rng(20)
    faces = {i: tuple(map(int, f)) for i, f in enumerate(F)}
    left = {(f[i - 2], f[i - 1]): (f[i], k) for k, f in faces.items() for i in range(3)}
    for _ in range(count):
        f = faces[int(rng.integers(len(faces)))]
        a, b = f[0], f[1]
        (c, k), (d, j) = left[a, b], left[b, a]
        if c == d or (c, d) in left or (d, c) in left:
            continue
        del left[a, b], left[b, a]
        faces[k], faces[j] = (a, d, c), (d, b, c)
        for key in (k, j):
            g = faces[key]
            left.update({(g[i - 2], g[i - 1]): (g[i], key) for i in range(3)})
    return np.array(list(faces.values()))


def test_the_encoder_has_reserved_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """Handles and holes everywhere: no stream outgrows the buffer that was reserved for it."""
    sizes = []
    original = entropy.finish

    def finish(coder):
        data = original(coder)
        sizes.append((len(data), coder.data.size))
        return data

    monkeypatch.setattr(entropy, "finish", finish)
    for mesh in MANIFOLDS.values():
        assert_round_trip(mesh[1], len(mesh[0]))
    assert all(used < reserved for used, reserved in sizes)
