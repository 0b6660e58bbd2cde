"""Grids of frames: how often they halve, and parameters at a step."""

from __future__ import annotations

import meshes
import numpy as np
import pytest

from deltamesh._geometry.integers import NO_POINTS, Integers
from deltamesh._geometry.prediction import (
    Prediction,
    Reference,
    at_step,
    finer,
    halvings,
    predicted,
)
from deltamesh._geometry.systems import Systems
from deltamesh._kernels.mesh import laplacian
from deltamesh._shape.surface import surface_of
from deltamesh_formats.container.container import Parameters

FIRST = Parameters("refined", anchor_method="farthest", step=0.8, anchor_step=0.1, coarse=5.0)


@pytest.mark.parametrize(
    ("wanted", "times"),
    [(1.0, 0), (0.1, 0), (0.099, 1), (0.05, 1), (0.01, 4), (1e-30, 30), (0.0, 0)],
)
def test_a_step_is_halved_until_it_is_small_enough(wanted: float, times: int) -> None:
    assert halvings(0.1, wanted) == times
    assert 0.1 / 2**times <= wanted or times in (0, 30)


@pytest.mark.parametrize("times", [0, 1, 13, 30])
def test_a_grid_tells_how_often_it_was_halved(times: int) -> None:
    p = at_step(FIRST, 0.3, 8.0, times)
    assert (p.step, p.coarse, p.anchor_step) == (0.3, 8.0, 0.1 / 2**times)
    assert finer(FIRST, p) == times
    cartesian = Parameters("cartesian", step=0.3)
    assert finer(cartesian, Parameters("cartesian", step=0.3 / 2**times)) == times


def test_without_a_motion_nothing_turns() -> None:
    V, F = meshes.icosphere(1)
    surface = surface_of(F, len(V), 0)
    reference = Reference(FIRST, Integers(NO_POINTS), V)
    found = predicted(surface, FIRST, reference, None, Systems(surface))
    np.testing.assert_array_equal(found.deltas, laplacian.apply(*surface.graph, V))
    np.testing.assert_array_equal(found.positions, V)


def test_a_grid_is_halved_only_if_it_is_much_too_coarse() -> None:
    prediction = Prediction(
        FIRST, Reference(FIRST, Integers(NO_POINTS), NO_POINTS), None, *2 * [NO_POINTS]
    )
    assert [prediction.anchor_step(x) for x in (0.2, 0.09, 0.07)] == [0.1, 0.1, 0.05]
