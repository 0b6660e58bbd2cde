"""Deltas, as the kernel and its twin code them."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest
import strategies
from coders import integers_of, neighbours_of, twin_of
from hypothesis import given
from hypothesis import strategies as st
from payloads import SPHERE

from deltamesh._graph.adjacency import adjacency
from deltamesh._kernels.coding import delta as delta_kernels
from deltamesh._kernels.coding import residual
from deltamesh._streams import entropy

MESHES = meshes.every()
NO_FACES = np.empty((0, 3), dtype=np.int64)


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
    assert decoder.registers.code == twin.code
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


def test_shares_go_along_and_across_the_normal() -> None:
    """Of three vertices, the first has an error on and across its normal, z."""
    graph = adjacency(np.array([[0, 1, 2]]), 3)
    delta = np.array([[0.4, 0.0, 0.4], [0.0] * 3, [0.0] * 3])
    N = np.array([[0.0, 0.0, 1.0]] * 3)
    handed = {}
    for carry in ((1.0, 0.0), (0.0, 1.0)):
        left = delta.copy()
        out = np.zeros((3, 3), dtype=np.int64)
        delta_kernels.diffuse(*graph, left, N, np.ones(3), 0.0, 0.0, 1.0, *carry, out)
        handed[carry] = left[1].tolist()
    assert handed == {(1.0, 0.0): [0.2, 0.0, 0.0], (0.0, 1.0): [0.0, 0.0, 0.2]}
