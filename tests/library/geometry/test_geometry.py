from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest
import strategies
from graphs import laplacian_of
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._geometry import cartesian, highpass
from deltamesh._geometry.integers import NO_POINTS, NONE, Integers
from deltamesh._geometry.normals import vertex_normals
from deltamesh._geometry.quantize import (
    MOST_STEPS,
    delta_step,
    from_grid,
    grid_step,
    quantize_delta,
    to_grid,
)
from deltamesh._graph.adjacency import adjacency
from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._graph.parallelograms import NO_QUADS, parallelograms
from deltamesh._kernels.coding import coder as coder_kernels
from deltamesh._kernels.coding import delta as delta_kernels
from deltamesh._kernels.coding import parallelogram, points, residual, signed_integers
from deltamesh._shape.connectivity import encode_connectivity
from deltamesh._shape.surface import surface_of
from deltamesh._shape.topology import build_topology
from deltamesh._streams import entropy
from deltamesh_formats.container.container import Parameters, Section
from deltamesh_formats.errors import FormatError, MeshError

MESHES = meshes.every()
NO_FACES = np.empty((0, 3), dtype=np.int64)


def neighbours_of(F, n):
    indptr, indices = adjacency(F, n)
    return [indices[indptr[i] : indptr[i + 1]].tolist() for i in range(n)]


def integers_of(size, seed):
    """Triples of which some are near the bounds, most are small, and many zero."""
    rng = np.random.default_rng(seed)
    scale = 2.0 ** rng.uniform(-1, 30.9, (size, 1))
    values = np.rint(rng.normal(size=(size, 3)) * scale * rng.integers(0, 2, (size, 3)))
    return np.clip(values, 1 - 2**31, 2**31 - 1).astype(np.int64)


# ---- Coding of deltas --------------------------------------------------------------------------


def deltas_round_trip(F, values):
    graph = adjacency(F, len(values))
    coder = entropy.encoder(len(values), residual.SLOTS, residual.MIXERS)
    kept = values.copy()
    delta_kernels.code_deltas(coder, *graph, kept)
    np.testing.assert_array_equal(kept, values)
    data = entropy.finish(coder)
    decoder = entropy.decoder(data, residual.SLOTS, residual.MIXERS)
    decoded = np.zeros_like(values)
    delta_kernels.code_deltas(decoder, *graph, decoded)
    entropy.check_end(decoder, 0)
    np.testing.assert_array_equal(decoded, values)
    return data


EXTREMES = [0, 1, -1, 2**30 - 1, -(2**30) + 1, 2**30, -(2**30), 2**31 - 1, 1 - 2**31]


@strategies.SOME
@given(
    st.sampled_from(sorted(MESHES)),
    st.lists(st.tuples(*[st.sampled_from(EXTREMES) | st.integers(1 - 2**31, 2**31 - 1)] * 3)),
)
def test_deltas_round_trip(name: str, values: list[tuple[int, int, int]]) -> None:
    V, F = MESHES[name]
    filled = np.zeros((len(V), 3), dtype=np.int64)
    filled[: len(values)] = np.array(values, dtype=np.int64).reshape(-1, 3)[: len(V)]
    deltas_round_trip(F, filled)


@strategies.SOME
@given(strategies.surfaces(), strategies.SMALL)
def test_deltas_of_any_surface_round_trip(mesh: meshes.Arrays, seed: int) -> None:
    deltas_round_trip(mesh[1], integers_of(len(mesh[0]), seed))


def twin_of(data, inputs):
    """A slow coder; of `data` it reads, of None it writes."""
    tables = coder_kernels.STRETCH, coder_kernels.SQUASH, coder_kernels.RATE
    slots, weights = signed_integers.SLOTS, entropy.INITIAL_WEIGHT_SUM
    return oracle.RangeCoder(tables, slots, inputs, weights, data)


@strategies.FEW
@given(st.sampled_from(sorted(MESHES)), strategies.SMALL)
def test_deltas_equal_their_oracle(name: str, seed: int) -> None:
    V, F = MESHES[name]
    V, F = V[:80], F[(F < 80).all(axis=1)]
    values, around = integers_of(len(V), seed), neighbours_of(F, len(V))
    twin = twin_of(None, residual.MIXERS)
    assert oracle.code_deltas(twin, around, values.tolist()) == values.tolist()
    assert deltas_round_trip(F, values) == twin.finish()


@strategies.SOME
@given(st.binary(max_size=150), st.sampled_from([0x00, 0x55, 0xFF]), st.integers(0, 600))
def test_any_bytes_are_the_deltas_of_the_oracle(data: bytes, filler: int, more: int) -> None:
    """What no encoder has written; large numbers beside each other, whose products wrap."""
    data += bytes([filler]) * more
    decoder, out = entropy.decoder(data, residual.SLOTS, residual.MIXERS), np.zeros((42, 3), int)
    delta_kernels.code_deltas(decoder, *adjacency(SPHERE, 42), out)
    zeros = [[0, 0, 0]] * 42
    twin = twin_of(data, residual.MIXERS)
    assert oracle.code_deltas(twin, neighbours_of(SPHERE, 42), zeros) == out.tolist()
    assert int(decoder.state[coder_kernels.CODE]) == twin.code
    assert np.abs(out).max() < 2**31


@pytest.mark.parametrize("n", [0, 1, 2])
@pytest.mark.parametrize("value", [0, 1, -1, 2**31 - 1, 1 - 2**31])
def test_deltas_without_faces(n: int, value: int) -> None:
    deltas_round_trip(NO_FACES, np.full((n, 3), value, dtype=np.int64))


def test_zeros_cost_next_to_nothing_and_noise_its_entropy() -> None:
    V, F = meshes.torus(50, 40)
    assert len(deltas_round_trip(F, np.zeros((len(V), 3), dtype=np.int64))) < 30
    noise = np.random.default_rng(41).integers(-7, 8, (len(V), 3))
    assert 8 * len(deltas_round_trip(F, noise)) < 1.1 * 3 * len(V) * np.log2(15)


@pytest.mark.parametrize("x", [*range(40), 63, 64, 95, 96, 1000, 2**16, 3 << 20, 2**40, 2**62])
def test_level_equals_its_oracle(x: int) -> None:
    assert signed_integers.level(x) == oracle.level(x)
    assert signed_integers.level(-x) == 0


# ---- Coding of positions -----------------------------------------------------------------------


def positions_round_trip(F, values):
    surface = surface_of(F, len(values), 0)
    payload = cartesian.encode(surface, GRID, Integers(values, NONE, NO_POINTS, NO_POINTS))["CART"]
    sections = {"CART": Section("CART", 0, payload)}
    decoded = cartesian.decode(surface, GRID, sections)
    np.testing.assert_array_equal(decoded.values, values)
    return payload


GRID = Parameters("cartesian", False, None, 11, 1.0, (0.0, 0.0, 0.0), 0.0, 0, 0, 0)


@strategies.SOME
@given(strategies.surfaces(), strategies.SMALL, st.sampled_from([1, 5, 11, 20, 30]))
def test_positions_round_trip(mesh: meshes.Arrays, seed: int, bits: int) -> None:
    V, F = mesh
    noise = np.random.default_rng(seed).integers(0, 2**bits, (len(V), 3))
    positions_round_trip(F, noise)
    positions_round_trip(F, np.rint((V - V.min()) / np.ptp(V) * (2**bits - 1)).astype(np.int64))


@strategies.SOME
@given(st.sampled_from(sorted(MESHES)), st.lists(st.booleans(), min_size=1, max_size=300))
def test_positions_at_the_corners_of_the_grid(name: str, corners: list[bool]) -> None:
    """The predictions that lie farthest outside."""
    V, F = MESHES[name]
    positions_round_trip(F, np.resize(np.array(corners) * (MOST_STEPS - 1), (len(V), 3)))


@pytest.mark.parametrize("n", [0, 1, 2, 7])
def test_positions_without_faces(n: int) -> None:
    positions_round_trip(NO_FACES, integers_of(n, 3) & (MOST_STEPS - 1))


def test_parallelograms_equal_their_oracle() -> None:
    for V, F in MESHES.values():
        if F is MESHES["three_pages"][1]:
            continue
        first, corners, _ = parallelograms(F, len(V))
        expected = oracle.parallelograms(F)
        for i in range(len(V)):
            rows = corners[first[i] : first[i + 1]].tolist()
            assert sorted(map(tuple, rows)) == sorted(expected.get(i, []))


def some_quads(rng, n):
    """Quads over any vertices: the half of those that would be there may be none at all."""
    return rng.integers(0, n, (n // 2 if rng.random() < 0.5 else 0, 4))


def corners_of(F, n, quads=NO_QUADS):
    """The parallelograms of each vertex as lists, in their order."""
    first, corners, _ = parallelograms(F, n, quads)
    rows = [corners[first[i] : first[i + 1]].tolist() for i in range(n)]
    return {i: row for i, row in enumerate(rows) if row}


def positions_of(data, F, n, quads=NO_QUADS):
    """What the decoder makes of any bytes, and its state."""
    values, graph = np.zeros((n, 3), dtype=np.int64), adjacency(F, n)
    decoder = entropy.decoder(data, parallelogram.SLOTS, parallelogram.MIXERS)
    parallelogram.code_positions(decoder, *graph, *parallelograms(F, n, quads), values)
    return values, decoder


def assert_positions_of_the_oracle(data, F, n, quads=NO_QUADS):
    values, decoder = positions_of(data, F, n, quads)
    twin = twin_of(data, parallelogram.MIXERS)
    within = dict(enumerate(parallelograms(F, n, quads)[2].tolist()))
    found = oracle.code_positions(
        twin, neighbours_of(F, n), corners_of(F, n, quads), lambda *_: 0, within
    )
    assert values.tolist() == found[0]
    assert int(decoder.state[coder_kernels.CODE]) == twin.code
    assert int(decoder.state[coder_kernels.POSITION]) == twin.position
    return found


@strategies.SOME
@given(strategies.surfaces(), strategies.SMALL, st.sampled_from([2, 300, MOST_STEPS - 1]))
def test_prediction_equals_its_oracle(mesh: meshes.Arrays, seed: int, most: int) -> None:
    V, F = mesh
    n, graph = len(V), adjacency(F, len(V))
    rng = np.random.default_rng(seed)
    quads = some_quads(rng, n)
    first, corners, within = parallelograms(F, n, quads)
    values = rng.integers(0, most, (n, 3))
    around, rows = neighbours_of(F, n), corners_of(F, n, quads)
    known = np.zeros(residual.KNOWN, dtype=np.int64)
    predictions = np.zeros((3, parallelogram.PREDICTIONS), dtype=np.int64)
    candidates = np.zeros((3, parallelogram.CANDIDATES), dtype=np.int64)
    for i in range(n):
        known[:] = 0
        known[residual.NEIGHBOURS] = sum(j < i for j in around[i])
        out = predictions, candidates, known
        kind = parallelogram._predict(*graph, first, corners, within, values, i, *out)
        inner = int(within[i])
        wanted, axes = oracle.predict(values.tolist(), i, around[i], rows.get(i, []), inner)
        assert 0 <= kind == wanted < parallelogram.CLASSES
        assert predictions.tolist() == [row[0] for row in axes]
        assert candidates.tolist() == [row[1] for row in axes]
        assert known[residual.HINT : residual.HINT + 3].tolist() == [row[2] for row in axes]


@strategies.FEW
@given(strategies.surfaces(), strategies.SMALL, st.sampled_from([1, 3, 11, 30]))
def test_positions_equal_their_oracle(mesh: meshes.Arrays, seed: int, bits: int) -> None:
    V, F = mesh
    n = len(V)
    grid = np.rint((V - V.min()) / np.ptp(V) * (2**bits - 1)).astype(np.int64)
    grid[: seed % n] = np.random.default_rng(seed).integers(0, 2**bits, (seed % n, 3))
    twin = twin_of(None, parallelogram.MIXERS)
    oracle.code_positions(
        twin, neighbours_of(F, n), corners_of(F, n), lambda i, x, p: int(grid[i, x]) - p
    )
    assert positions_round_trip(F, grid) == twin.finish()


def test_the_order_of_the_parallelograms() -> None:
    """By their faces: of gates alike, the first counts."""
    V, F = meshes.torus(9, 7)
    for i, rows in corners_of(F, len(V)).items():
        faces = [sorted((a, b, i)) for a, b, _ in rows]
        places = [next(k for k, f in enumerate(F.tolist()) if sorted(f) == face) for face in faces]
        assert places == sorted(places)


@strategies.SOME
@given(
    st.sampled_from(["sphere", "torus"]),
    st.binary(max_size=200),
    st.sampled_from([0x00, 0x55, 0xFF]),
    st.integers(0, 1500),
    strategies.SMALL,
)
def test_any_bytes_are_the_positions_of_the_oracle(
    name: str, data: bytes, filler: int, more: int, seed: int
) -> None:
    """The oracle has integers without a width: nothing leaves the 64 bits of the kernel."""
    F, n = {"sphere": (SPHERE, 45), "torus": (meshes.torus(6, 5)[1], 30)}[name]
    quads = some_quads(np.random.default_rng(seed), n)
    assert_positions_of_the_oracle(data + bytes([filler]) * more, F, n, quads)


EXTREME = 2**31 - 1


def in_coding_order(F, n):
    return encode_connectivity(build_topology(F, pair_halfedges(F), n))[1].manifold.faces


@pytest.mark.parametrize(
    "pattern",
    ["away", *(pytest.param(one, marks=pytest.mark.slow) for one in ("there and back", "random"))],
)
def test_positions_far_outside(pattern: str) -> None:
    """A crafted file: largest residuals, so that extrapolation leads to the bounds and along."""
    V, F = meshes.torus(3, 75)
    n, rng = len(V), np.random.default_rng(40)
    F = in_coding_order(F, n)
    choices = {
        "away": lambda i, axis, p: EXTREME if p >= 0 else -EXTREME,
        "there and back": lambda i, axis, p: -EXTREME if (i // 40) % 2 else EXTREME,
        "random": lambda i, axis, p: int(rng.choice([EXTREME, -EXTREME, 0])),
    }
    twin = twin_of(None, parallelogram.MIXERS)
    written = oracle.code_positions(twin, neighbours_of(F, n), corners_of(F, n), choices[pattern])
    values, residuals, largest = assert_positions_of_the_oracle(twin.finish(), F, n)
    assert (values, residuals) == written[:2]
    assert np.abs(np.array(values)).max() <= parallelogram.BOUND
    assert 2**40 < largest < 2**59  # ten times it, too, is below 2^63
    if pattern == "away":
        assert np.abs(np.array(values)).max() == parallelogram.BOUND


def test_a_plane_is_predicted_exactly() -> None:
    """An affine grid of vertices is all parallelograms: next to nothing is left to send."""
    i, j = np.meshgrid(np.arange(40), np.arange(30), indexing="ij")
    _, F = meshes.grid(40, 30)
    plane = np.stack([5000 + 7 * i - 3 * j, 100 * j, 9000 - 11 * i + j], axis=2).reshape(-1, 3)
    assert len(positions_round_trip(F, plane)) < 60


# ---- Diffusion ---------------------------------------------------------------------------------

FULL, PLAIN = (1.0, 1.0), (0.0, 0.0)


@strategies.SOME
@given(strategies.surfaces(), st.sampled_from([1e-9, 0.01, 0.37, 1.0, 1e6]), st.floats(1e-3, 1e3))
def test_diffusion_equals_its_oracle(mesh: meshes.Arrays, step: float, steps: float) -> None:
    V, F = mesh
    delta, none = V * (step * steps), np.zeros_like(V)
    kept = delta.copy()
    values = quantize_delta(delta, adjacency(F, len(V)), step, FULL)
    np.testing.assert_array_equal(delta, kept)
    around = neighbours_of(F, len(V))
    expected = oracle.diffuse(around, kept, none, step, 0.0, FULL, along=False)
    np.testing.assert_array_equal(values, expected)


@strategies.SOME
@given(
    strategies.surfaces(),
    st.floats(1e-3, 1e3),
    st.sampled_from([0.0, 0.15, 0.5]),
    st.tuples(*[st.sampled_from([0.0, 0.5, 0.7, 1.0])] * 2),
    st.booleans(),
)
def test_diffusion_along_normals_equals_its_oracle(
    mesh: meshes.Arrays, steps: float, zone: float, carry: tuple[float, float], along: bool
) -> None:
    V, F = mesh
    delta, N, around = steps * V, vertex_normals(V, F, 0.1), neighbours_of(F, len(V))
    values = quantize_delta(
        delta, adjacency(F, len(V)), 0.37, carry, normals=N, zone=zone, along=along
    )
    assert values.shape == (len(V), 1 if along else 3)
    expected = oracle.diffuse(around, delta, N, 0.37, zone, carry, along)
    np.testing.assert_array_equal(values, expected)


@given(strategies.surfaces(), st.floats(0.01, 10))
def test_without_shares_the_component_along_a_normal_is_rounded(
    mesh: meshes.Arrays, step: float
) -> None:
    V, F = mesh
    delta, N = laplacian_of(F, len(V)) @ V, vertex_normals(V, F, 0.1)
    graph = adjacency(F, len(V))
    values = quantize_delta(delta, graph, step, PLAIN, normals=N, zone=0.2, along=True)
    parts = (delta * N).sum(axis=1, keepdims=True) / step
    inside = np.abs(parts) < 0.7 - 1e-9
    assert (values[inside] == 0).all()
    assert (np.abs(values - parts)[np.abs(parts) > 0.7 + 1e-9] <= 0.5 + 1e-9).all()


def test_shares_go_along_and_across_the_normal() -> None:
    """Of three vertices, the first has an error on and across its normal, z."""
    graph = adjacency(np.array([[0, 1, 2]]), 3)
    delta = np.array([[0.4, 0.0, 0.4], [0.0] * 3, [0.0] * 3])
    N = np.array([[0.0, 0.0, 1.0]] * 3)
    handed = {}
    for carry in ((1.0, 0.0), (0.0, 1.0)):
        left = delta.copy()
        out = np.zeros((3, 3), dtype=np.int64)
        delta_kernels.diffuse(*graph, left, N, 1.0, 0.0, *carry, out)
        handed[carry] = left[1].tolist()
    assert handed == {(1.0, 0.0): [0.2, 0.0, 0.0], (0.0, 1.0): [0.0, 0.0, 0.2]}


@pytest.mark.parametrize("name", MESHES)
def test_diffusion_conserves_the_error(name: str) -> None:
    """What is lost of the sum is what the vertices without neighbours to come could not hand on."""
    V, F = MESHES[name]
    delta = np.random.default_rng(4).normal(size=V.shape)
    values = quantize_delta(delta, adjacency(F, len(V)), 0.3, FULL)
    last = [all(j < i for j in around) for i, around in enumerate(neighbours_of(F, len(V)))]
    lost = np.abs((delta - 0.3 * values).sum(axis=0))
    assert (lost <= 0.15 * sum(last) + 1e-9).all()


def test_diffusion_drops_the_error_of_a_last_vertex() -> None:
    """Three vertices: the first hands on halves, the second all, the last keeps what remains."""
    graph = adjacency(np.array([[0, 1, 2]]), 3)
    delta = np.array([[0.4, 0.0, -0.4], [0.1, 0.4, 0.0], [0.4, 0.2, 0.9]])
    values = quantize_delta(delta, graph, 1.0, FULL)
    # x: 0.4 -> 0, hands 0.2 to both; 0.3 -> 0, hands 0.3; 0.9 -> 1.
    # y: 0 -> 0; 0.4 -> 0, hands 0.4; 0.6 -> 1.
    # z: -0.4 -> 0, hands -0.2 to both; -0.2 -> 0, hands -0.2; 0.5 -> 0, half to even.
    assert values.tolist() == [[0, 0, 0], [0, 0, 0], [1, 1, 0]]


def test_isolated_vertices_are_rounded_alone() -> None:
    delta = np.array([[0.6, -0.6, 1.4]] * 5)
    values = quantize_delta(delta, adjacency(NO_FACES, 5), 1.0, FULL)
    assert values.tolist() == [[1, -1, 1]] * 5


@given(strategies.surfaces(), st.floats(1e-3, 10))
def test_rounding_without_diffusion(mesh: meshes.Arrays, step: float) -> None:
    V, F = mesh
    delta = laplacian_of(F, len(V)) @ V
    values = quantize_delta(delta, adjacency(F, len(V)), step, PLAIN)
    assert values.dtype == np.int64
    assert (np.abs(values * step - delta) <= step / 2 * (1 + 1e-9)).all()


def test_diffusion_takes_the_low_frequencies_out_of_the_error() -> None:
    """What it is for: in coding order, the sum of the errors over any half nearly vanishes."""
    V, F = meshes.icosphere(3)
    _, coded = encode_connectivity(build_topology(F, pair_halfedges(F), len(V)))
    V, graph = V[coded.order], adjacency(coded.manifold.faces, len(V))
    rng = np.random.default_rng(9)
    delta = rng.normal(size=V.shape)
    halves = V @ rng.normal(size=(3, 50)) > 0
    plain, diffused = (
        np.sqrt(np.mean((halves.T @ (delta - 0.5 * quantize_delta(delta, graph, 0.5, d))) ** 2))
        for d in (PLAIN, FULL)
    )
    assert diffused < 0.4 * plain


# ---- Steps and grids ---------------------------------------------------------------------------

coordinates = st.floats(-1e6, 1e6, allow_subnormal=False)


@given(st.lists(st.tuples(*[coordinates] * 3), min_size=1, max_size=20), st.floats(0.01, 1e3))
def test_grid_error_is_at_most_half_a_step(rows: list[tuple[float, ...]], step: float) -> None:
    vertices = np.array(rows)
    origin = vertices.min(axis=0)
    grid = to_grid(vertices, origin, step)
    assert grid.dtype == np.int64
    assert (grid >= 0).all()
    error = np.abs(from_grid(grid, origin, step) - vertices)
    assert (error <= step / 2 + 1e-9).all()


@given(st.lists(st.tuples(*[coordinates] * 3), min_size=2, max_size=20), st.integers(1, 30))
def test_grid_of_bits_has_so_many(rows: list[tuple[float, ...]], bits: int) -> None:
    vertices = np.array(rows)
    step = grid_step(vertices, bits)
    grid = to_grid(vertices, vertices.min(axis=0), step)
    extent = np.ptp(vertices, axis=0).max()
    assert grid.max() == (2**bits - 1 if extent else 0)


@given(st.lists(st.tuples(*[coordinates] * 3), min_size=2, max_size=20), st.integers(1, 30))
def test_step_of_the_papers(rows: list[tuple[float, ...]], bits: int) -> None:
    delta = np.array(rows)
    step = delta_step(delta, bits)
    extent = float(np.ptp(delta, axis=0).max())
    assert step == (extent / 2**bits or 1.0)


@pytest.mark.parametrize("carry", [FULL, PLAIN])
def test_a_step_that_is_too_small_is_refused(carry: tuple[float, float]) -> None:
    delta = np.array([[0.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    graph = adjacency(NO_FACES, 2)
    fits = quantize_delta(delta, graph, 1.001 / MOST_STEPS, carry)
    assert fits.min() > -MOST_STEPS
    for step in (1 / MOST_STEPS, 1e-300):
        with pytest.raises(MeshError, match="too small"):
            quantize_delta(delta, graph, step, carry)
        with pytest.raises(MeshError, match="too small"):
            to_grid(delta, delta.min(axis=0), step)


# ---- Points and gaps ---------------------------------------------------------------------------


@given(
    st.lists(st.integers(0, 5000), max_size=40, unique=True),
    st.lists(st.tuples(*[st.integers(0, 2**30 - 1)] * 3), max_size=20),
    st.lists(st.tuples(*[st.integers(0, 2**30 - 1)] * 3), max_size=20),
)
def test_points_round_trip(
    gaps: list[int], anchors: list[tuple[int, int, int]], isolated: list[tuple[int, int, int]]
) -> None:
    indices = np.array(sorted(gaps), dtype=np.int64)
    first = np.array(anchors, dtype=np.int64).reshape(-1, 3)
    second = np.array(sorted(isolated), dtype=np.int64).reshape(-1, 3)
    bits = np.array([30, 30, 30])
    coder = entropy.encoder(100, points.SLOTS, points.MIXERS)
    assert points.code_gaps(coder, indices.copy(), 5001)
    points.code_points(coder, first.copy(), bits)
    assert points.code_sorted_points(coder, second.copy(), bits)
    decoder = entropy.decoder(entropy.finish(coder), points.SLOTS, points.MIXERS)
    out = np.zeros_like(indices), np.zeros_like(first), np.zeros_like(second)
    assert points.code_gaps(decoder, out[0], 5001)
    points.code_points(decoder, out[1], bits)
    assert points.code_sorted_points(decoder, out[2], bits)
    entropy.check_end(decoder, 0)
    for decoded, given_values in zip(out, (indices, first, second), strict=True):
        np.testing.assert_array_equal(decoded, given_values)


def test_indices_outside_are_refused() -> None:
    coder = entropy.encoder(10, points.SLOTS, points.MIXERS)
    assert points.code_gaps(coder, np.array([3, 9]), 10)
    data = entropy.finish(coder)
    decoder = entropy.decoder(data, points.SLOTS, points.MIXERS)
    assert not points.code_gaps(decoder, np.zeros(2, dtype=np.int64), 9)


# ---- Payloads that no encoder has written ------------------------------------------------------

SPHERE = meshes.icosphere(1)[1]
SURFACE = surface_of(SPHERE, 42, 3)


def highpass_parameters(**changes):
    fields = {
        "method": "highpass",
        "diffusion": True,
        "anchor_method": "greedy",
        "bits": None,
        "step": 0.01,
        "origin": (0.0, 0.0, 0.0),
        "anchor_step": 0.001,
        "seed": 0,
        "anchor_count": 5,
        "isolated": 3,
    }
    return Parameters(**(fields | changes))


def section_of(name, payload):
    return Section(name, 50, payload)


def read_or_refused(reader, parameters, **payloads):
    """What a reader makes of payloads, None where it refuses them."""
    sections = {name: section_of(name, payload) for name, payload in payloads.items()}
    offset = None
    try:
        return reader(SURFACE, parameters, sections)
    except FormatError as error:
        offset = error.offset
    assert 50 <= offset <= 60 + max(map(len, payloads.values()))
    return None


@given(st.binary(max_size=200), st.sampled_from(["greedy", "farthest", "random"]))
def test_random_anchors(payload: bytes, method: str) -> None:
    parameters = highpass_parameters(anchor_method=method, bits=0, step=0.0)
    integers = read_or_refused(highpass.decode, parameters, ANCH=payload, DELT=b"")
    if integers is not None:
        assert integers.anchors.shape == (5,)
        assert ((integers.anchors >= 0) & (integers.anchors < 42)).all()
        assert ((integers.positions >= 0) & (integers.positions < 2**30)).all()
        assert integers.isolated.shape == (3, 3)
        assert ((integers.isolated >= 0) & (integers.isolated < 2**30)).all()
        assert (np.diff(integers.isolated[:, 0]) >= 0).all()


@given(st.binary(max_size=300))
def test_random_deltas(payload: bytes) -> None:
    anchors = _written_anchors()
    integers = read_or_refused(highpass.decode, highpass_parameters(), ANCH=anchors, DELT=payload)
    if integers is not None:
        assert integers.values.shape == (42, 3)
        assert np.abs(integers.values).max() < 2**31


@given(st.binary(max_size=300))
def test_random_corrections(payload: bytes) -> None:
    payloads = {"ANCH": _written_anchors(), "DELT": b"", "FIXS": payload}
    integers = read_or_refused(highpass.decode, highpass_parameters(), **payloads)
    if integers is not None:
        assert integers.corrections.shape == (42, 3)
        assert np.abs(integers.corrections).max() < 2**31


def _written_anchors():
    grid = np.arange(15).reshape(5, 3)
    integers = Integers(NO_POINTS, np.arange(5) * 8, grid, grid[:3])
    return highpass.encode(SURFACE, highpass_parameters(bits=0, step=0.0), integers)["ANCH"]


@given(st.binary(max_size=300))
def test_random_positions(payload: bytes) -> None:
    """Extrapolation upon extrapolation stays within the integers."""
    integers = read_or_refused(cartesian.decode, GRID, CART=payload)
    if integers is not None:
        assert integers.values.shape == (45, 3)
        assert np.abs(integers.values).max() <= parallelogram.BOUND


def test_a_grid_of_too_many_bits_is_refused() -> None:
    parameters = highpass_parameters(bits=0, step=0.0)
    for at in range(3):
        bits = bytes(31 if i == at else 5 for i in range(3))
        payloads = {"ANCH": section_of("ANCH", bits), "DELT": section_of("DELT", b"")}
        with pytest.raises(FormatError, match="bits") as caught:
            highpass.decode(SURFACE, parameters, payloads)
        assert caught.value.offset == 50 + 5 + at


@pytest.mark.parametrize("size", [0, 1, 2])
def test_anchors_without_their_grid_are_refused(size: int) -> None:
    parameters = highpass_parameters(bits=0, step=0.0)
    assert read_or_refused(highpass.decode, parameters, ANCH=bytes(size), DELT=b"") is None


def test_deltas_of_zero_bits_are_refused() -> None:
    parameters = highpass_parameters(bits=0, step=0.0)
    assert (
        read_or_refused(highpass.decode, parameters, ANCH=_written_anchors(), DELT=b"") is not None
    )
    assert read_or_refused(highpass.decode, parameters, ANCH=_written_anchors(), DELT=b"\1") is None


def test_corrections_round_trip() -> None:
    values, fixes = integers_of(42, 1), integers_of(42, 2)
    fixes[np.random.default_rng(3).random(42) < 0.8] = 0
    grid = np.arange(15).reshape(5, 3)
    integers = Integers(values, np.arange(5) * 8, grid, grid[:3], corrections=fixes)
    payloads = highpass.encode(SURFACE, highpass_parameters(), integers)
    assert list(payloads) == ["ANCH", "DELT", "FIXS"]
    read = read_or_refused(highpass.decode, highpass_parameters(), **payloads)
    assert read is not None
    np.testing.assert_array_equal(read.corrections, fixes)
    np.testing.assert_array_equal(read.values, values)


def test_corrections_of_zero_bits_are_refused() -> None:
    parameters = highpass_parameters(bits=0, step=0.0)
    payloads = {"ANCH": _written_anchors(), "DELT": b"", "FIXS": b""}
    assert read_or_refused(highpass.decode, parameters, **payloads) is None
