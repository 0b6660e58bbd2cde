"""Integers of frames: relative to those of a reference and back, on grids of any fineness."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from deltamesh._geometry.frames import absolute, relative
from deltamesh._geometry.integers import Integers
from deltamesh._geometry.prediction import Reference, at_step
from deltamesh_formats.container.container import Parameters
from deltamesh_formats.errors import MeshError

REFINED = Parameters("refined", anchor_method="farthest", step=0.8, anchor_step=0.1, coarse=5.0)
CARTESIAN = Parameters("cartesian", step=0.5)
GENERATOR = np.random.default_rng(3)


def some(n):
    return GENERATOR.integers(-1000, 1000, (n, 3))


@pytest.mark.parametrize(("before", "after"), [(0, 0), (0, 3), (3, 0), (2, 1)])
def test_positions_are_seen_from_those_of_the_reference(before: int, after: int) -> None:
    own = Integers(some(9), np.arange(4), some(4), some(2))
    other = Integers(some(9), np.arange(4), some(4), some(2))
    reference = Reference(at_step(REFINED, 0.8, 5.0, before), other, some(11) * 1.0)
    p = at_step(REFINED, 0.7, 8.0, after)
    seen = relative(p, own, reference)
    shifted = np.floor(other.positions * 2.0 ** (after - before))
    np.testing.assert_array_equal(seen.positions, own.positions - shifted)
    np.testing.assert_array_equal(seen.values, own.values)
    back = absolute(p, seen, reference)
    np.testing.assert_array_equal(back.positions, own.positions)
    np.testing.assert_array_equal(back.isolated, own.isolated)


@pytest.mark.parametrize("halved", [0, 2])
def test_grid_points_of_a_cartesian_frame(halved: int) -> None:
    own, other = Integers(some(9)), Integers(some(9))
    p = replace(CARTESIAN, step=0.5 / 2**halved)
    reference = Reference(CARTESIAN, other, some(9) * 1.0)
    seen = relative(p, own, reference)
    np.testing.assert_array_equal(seen.values, own.values - other.values * 2**halved)
    np.testing.assert_array_equal(absolute(p, seen, reference).values, own.values)


def test_what_is_too_far_is_refused() -> None:
    far = Integers(some(9), np.arange(4), some(4) + 2**31, some(2))
    near = Integers(some(9), np.arange(4), some(4), some(2))
    with pytest.raises(MeshError, match="vertices move too far"):
        relative(REFINED, far, Reference(REFINED, near, some(11) * 1.0))
