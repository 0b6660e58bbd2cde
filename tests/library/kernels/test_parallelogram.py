"""Grid points, as the kernel and its twin predict and code them."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest
import strategies
from coders import corners_of, neighbours_of, twin_of
from hypothesis import given
from hypothesis import strategies as st
from payloads import SPHERE

from deltamesh._geometry.quantize import MOST_STEPS
from deltamesh._graph.adjacency import adjacency
from deltamesh._graph.elements import alone
from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._graph.parallelograms import NO_QUADS, parallelograms
from deltamesh._kernels.coding import parallelogram
from deltamesh._shape.connectivity import encode_connectivity
from deltamesh._shape.topology import build_topology
from deltamesh._streams import entropy


def some_quads(rng, n):
    """Quads over any vertices: the half of those that would be there may be none at all."""
    return rng.integers(0, n, (n // 2 if rng.random() < 0.5 else 0, 4))


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
    assert decoder.registers.code == twin.code
    assert decoder.registers.position == twin.position
    return found


def test_a_vertex_with_parallelograms_has_neighbours_or_their_mean_is_zero() -> None:
    """Edges within polygons make parallelograms, but no neighbours."""
    V, F = meshes.torus(12, 9)
    n, none = len(V), alone(len(V))
    data = np.random.default_rng(5).integers(0, 256, 4000, dtype=np.uint8).tobytes()
    values = np.zeros((n, 3), dtype=np.int64)
    decoder = entropy.decoder(data, parallelogram.SLOTS, parallelogram.MIXERS)
    rows = parallelograms(F, n)
    parallelogram.code_positions(decoder, none.indptr, none.indices, *rows, values)
    twin = twin_of(data, parallelogram.MIXERS)
    found = oracle.code_positions(twin, [[]] * n, corners_of(F, n), lambda *_: 0, {})
    assert values.tolist() == found[0]


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
    for i in range(n):
        found = parallelogram.predict(*graph, first, corners, within, values, i)
        inner = int(within[i])
        wanted, axes = oracle.predict(values.tolist(), i, around[i], rows.get(i, []), inner)
        assert 0 <= found.kind == wanted < parallelogram.CLASSES
        assert found.predictions.tolist() == [row[0] for row in axes]
        assert found.positions.tolist() == [row[1] for row in axes]
        assert found.hints.tolist() == [row[2] for row in axes]


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
