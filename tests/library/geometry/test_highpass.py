"""High-pass method: what is quantized, with which steps, and what comes back."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import oracle
import pytest

from deltamesh._geometry import highpass
from deltamesh._geometry.anchoring import ANCHOR_GRID_BITS, ANCHOR_REFINEMENT, anchored
from deltamesh._geometry.deltas import coarse_steps, deltas, step_of
from deltamesh._geometry.integers import Integers
from deltamesh._geometry.quantize import from_grid
from deltamesh._geometry.systems import Systems
from deltamesh._options import Settings
from deltamesh._shape.surface import surface_of
from deltamesh_formats.errors import MeshError, OptionError

V, F = meshes.torus(12, 9)
SURFACE = surface_of(F, len(V), 2)
ISOLATED = np.array([[0.0, 0.0, 9.0], [1.0, 2.0, 3.0]])
L = oracle.laplacian(F, len(V))
SYSTEMS = Systems(SURFACE)
NOTHING = Integers(np.zeros((len(V), 3), dtype=np.int64))


def quantized(**settings):
    return highpass.quantize(SURFACE, V, ISOLATED, Settings("highpass", **settings), SYSTEMS)


@pytest.mark.parametrize("diffusion", [False, True])
def test_positions_are_those_of_the_dense_problem(diffusion: bool) -> None:
    parameters, integers, W = quantized(step=0.02, anchors=6, diffusion=diffusion)
    error = np.abs(integers.values * 0.02 - L @ V).max()
    assert error <= 0.01 * (1 + 1e-9) if not diffusion else 0.01 < error < 0.1
    origin = np.array(parameters.origin)
    anchors = from_grid(integers.positions, origin, parameters.anchor_step)
    expected = oracle.least_squares(L, integers.anchors, integers.values * 0.02, anchors)
    np.testing.assert_allclose(W[: len(V)], expected, atol=1e-9)
    np.testing.assert_allclose(W[len(V) :], ISOLATED, atol=parameters.anchor_step)
    again = highpass.reconstruct(SURFACE, parameters, integers, SYSTEMS)
    np.testing.assert_allclose(again, W, rtol=0, atol=1e-9)


def test_the_step_is_that_of_the_settings() -> None:
    delta = L @ V
    assert step_of(V, delta, Settings("highpass", step=0.3)) == 0.3
    assert step_of(V, delta, Settings("highpass", bits=0)) == 0.0
    assert step_of(V, delta, Settings("highpass", bits=5)) == np.ptp(delta, axis=0).max() / 32


def test_deltas_are_numbers_of_coarse_steps() -> None:
    parameters, integers, _ = quantized(step=0.02, anchors=6)
    parameters = replace(parameters, coarse=5.0)
    integers = replace(integers, exponents=np.arange(len(V)) % 9)
    each = 5 * 0.02 * 2.0 ** (-(np.arange(len(V)) % 9) / 4)
    np.testing.assert_allclose(coarse_steps(parameters, integers)[:, 0], each, rtol=1e-12)
    np.testing.assert_allclose(deltas(parameters, integers), integers.values * each[:, None])


@pytest.mark.parametrize("anchor_method", ["farthest", "greedy", "random"])
def test_anchors_are_on_a_grid_finer_than_the_step(anchor_method: str) -> None:
    for step in (1.0, 1e-3):
        settings = Settings("highpass", step=step, anchors=7, anchor_method=anchor_method, seed=3)
        parameters, integers = anchored(SURFACE, V, ISOLATED, NOTHING, step, settings, SYSTEMS)
        extent = np.ptp(np.concatenate([V, ISOLATED]), axis=0).max()
        grid = min(step / ANCHOR_REFINEMENT, extent / 2**ANCHOR_GRID_BITS)
        assert parameters.anchor_step == grid
        assert parameters.seed == (3 if anchor_method == "random" else 0)
        assert parameters.anchor_count == len(set(integers.anchors.tolist())) == 7
        placed = from_grid(integers.positions, np.array(parameters.origin), grid)
        assert np.abs(placed - V[integers.anchors]).max() <= grid / 2 * (1 + 1e-9)
    if anchor_method == "greedy":
        assert (np.diff(integers.anchors) > 0).all()


def test_a_number_of_anchors_that_means_nothing_is_refused() -> None:
    settings = Settings("highpass", step=0.1, anchors=1.5)
    with pytest.raises(OptionError, match="fraction"):
        anchored(SURFACE, V, ISOLATED, NOTHING, 0.1, settings, SYSTEMS)


def test_vertices_that_are_too_far_away_are_corrected() -> None:
    parameters, integers, _ = quantized(step=0.02, anchors=6)
    near, is_far = V + 0.05, np.arange(len(V)) % 7 == 0
    near[is_far] += [0.3, 0.0, -0.4]
    settings = Settings("highpass", step=0.02, largest=0.2)
    _, found, moved = highpass.corrected(near, V, parameters, integers, settings)
    np.testing.assert_array_equal(found.corrections[~is_far], 0)
    np.testing.assert_array_equal(found.corrections[is_far], np.rint((V - near)[is_far] / 0.02))
    np.testing.assert_allclose(moved[: len(V)], near + 0.02 * found.corrections, atol=1e-12)
    kept = highpass.corrected(near, V, parameters, integers, replace(settings, largest=1.0))[1]
    assert not len(kept.corrections)


def test_corrections_of_too_many_steps_are_refused() -> None:
    parameters, integers, W = quantized(step=0.02, anchors=6)
    settings = Settings("highpass", step=0.02, largest=1.0)
    with pytest.raises(MeshError, match="too small"):
        highpass.corrected(W[: len(V)] + 1e9, V, parameters, integers, settings)
