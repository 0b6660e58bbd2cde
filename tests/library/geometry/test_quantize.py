"""Rounding of deltas, with diffusion of the error or without, and grids."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest
import strategies
from coders import neighbours_of
from graphs import laplacian_of
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._geometry.normals import vertex_normals
from deltamesh._geometry.quantize import (
    MOST_STEPS,
    Rounding,
    delta_step,
    from_grid,
    grid_step,
    quantize_delta,
    to_grid,
)
from deltamesh._graph.adjacency import adjacency
from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._shape.connectivity import encode_connectivity
from deltamesh._shape.topology import build_topology
from deltamesh_formats.errors import MeshError

MESHES = meshes.every()
NO_FACES = np.empty((0, 3), dtype=np.int64)
FULL, PLAIN = Rounding(tangential=1.0), Rounding()


@strategies.SOME
@given(strategies.surfaces(), st.sampled_from([1e-9, 0.01, 0.37, 1.0, 1e6]), st.floats(1e-3, 1e3))
def test_diffusion_equals_its_oracle(mesh: meshes.Arrays, step: float, steps: float) -> None:
    V, F = mesh
    delta, none = V * (step * steps), np.zeros_like(V)
    kept = delta.copy()
    values = quantize_delta(delta, adjacency(F, len(V)), step, FULL)
    np.testing.assert_array_equal(delta, kept)
    around = neighbours_of(F, len(V))
    expected = oracle.diffuse(around, kept, none, [step] * len(V), FULL, along=False)
    np.testing.assert_array_equal(values, expected)


@strategies.SOME
@given(
    strategies.surfaces(),
    st.floats(1e-3, 1e3),
    st.builds(
        Rounding,
        zone=st.sampled_from([0.0, 0.15, 0.5]),
        pull=st.sampled_from([0.0, 0.3]),
        weight=st.sampled_from([0.5, 1.0, 3.0]),
        tangential=st.sampled_from([0.0, 0.7, 1.0]),
        normal=st.sampled_from([0.0, 0.5, 1.0]),
    ),
    st.booleans(),
    st.lists(st.floats(0.01, 0.5), min_size=1, max_size=9),
)
def test_diffusion_along_normals_equals_its_oracle(
    mesh: meshes.Arrays,
    steps: float,
    rounding: Rounding,
    along: bool,
    sizes: list[float],
) -> None:
    V, F = mesh
    each = np.resize(sizes, len(V))
    delta, N, around = steps * V, vertex_normals(V, F, 0.1), neighbours_of(F, len(V))
    values = quantize_delta(
        delta, adjacency(F, len(V)), each[:, None], rounding, normals=N, along=along
    )
    assert values.shape == (len(V), 1 if along else 3)
    expected = oracle.diffuse(around, delta, N, each.tolist(), rounding, along)
    np.testing.assert_array_equal(values, expected)


@given(strategies.surfaces(), st.floats(0.01, 10))
def test_without_shares_the_component_along_a_normal_is_rounded(
    mesh: meshes.Arrays, step: float
) -> None:
    V, F = mesh
    delta, N = laplacian_of(F, len(V)) @ V, vertex_normals(V, F, 0.1)
    graph = adjacency(F, len(V))
    values = quantize_delta(delta, graph, step, Rounding(zone=0.2), normals=N, along=True)
    parts = (delta * N).sum(axis=1, keepdims=True) / step
    inside = np.abs(parts) < 0.7 - 1e-9
    assert (values[inside] == 0).all()
    assert (np.abs(values - parts)[np.abs(parts) > 0.7 + 1e-9] <= 0.5 + 1e-9).all()


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


@pytest.mark.parametrize("rounding", [FULL, PLAIN])
def test_a_step_that_is_too_small_is_refused(rounding: Rounding) -> None:
    delta = np.array([[0.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    graph = adjacency(NO_FACES, 2)
    fits = quantize_delta(delta, graph, 1.001 / MOST_STEPS, rounding)
    assert fits.min() > -MOST_STEPS
    for step in (1 / MOST_STEPS, 1e-300):
        with pytest.raises(MeshError, match="too small"):
            quantize_delta(delta, graph, step, rounding)
        with pytest.raises(MeshError, match="too small"):
            to_grid(delta, delta.min(axis=0), step)
