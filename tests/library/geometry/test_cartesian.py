"""Grid points of the Cartesian method, to a payload and back."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest
import strategies
from coders import corners_of, integers_of, neighbours_of, twin_of
from hypothesis import given
from hypothesis import strategies as st
from payloads import read_or_refused

from deltamesh._geometry import cartesian
from deltamesh._geometry.integers import NO_POINTS, NONE, Integers
from deltamesh._geometry.quantize import MOST_STEPS
from deltamesh._kernels.coding import parallelogram
from deltamesh._shape.surface import surface_of
from deltamesh_formats.container.container import Parameters, Section

MESHES = meshes.every()
NO_FACES = np.empty((0, 3), dtype=np.int64)
GRID = Parameters("cartesian", False, None, 11, 1.0, (0.0, 0.0, 0.0), 0.0, 0, 0, 0)


def positions_round_trip(F, values):
    surface = surface_of(F, len(values), 0)
    payload = cartesian.encode(surface, GRID, Integers(values, NONE, NO_POINTS, NO_POINTS))["CART"]
    sections = {"CART": Section("CART", 0, payload)}
    decoded = cartesian.decode(surface, GRID, sections)
    np.testing.assert_array_equal(decoded.values, values)
    return payload


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


def test_a_plane_is_predicted_exactly() -> None:
    """An affine grid of vertices is all parallelograms: next to nothing is left to send."""
    i, j = np.meshgrid(np.arange(40), np.arange(30), indexing="ij")
    _, F = meshes.grid(40, 30)
    plane = np.stack([5000 + 7 * i - 3 * j, 100 * j, 9000 - 11 * i + j], axis=2).reshape(-1, 3)
    assert len(positions_round_trip(F, plane)) < 60


@given(st.binary(max_size=300))
def test_random_positions(payload: bytes) -> None:
    """Extrapolation upon extrapolation stays within the integers."""
    integers = read_or_refused(cartesian.decode, GRID, CART=payload)
    if integers is not None:
        assert integers.values.shape == (45, 3)
        assert np.abs(integers.values).max() <= parallelogram.BOUND
