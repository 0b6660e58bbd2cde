"""Geometry of a file, where positions could be beyond what a decoder computes with."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from containers import CARTESIAN

from deltamesh._geometry.integers import NO_POINTS, Integers
from deltamesh._mesh import LARGEST
from deltamesh._sections.geometry import has_scale

ONES = np.ones((2, 3), dtype=np.int64)


@pytest.mark.parametrize("name", ["values", "positions", "isolated", "refinements", "corrections"])
def test_any_integer_times_the_step_has_to_be_small(name: str) -> None:
    integers = replace(Integers(NO_POINTS), **{name: -1000 * ONES})
    assert has_scale(replace(CARTESIAN, step=LARGEST / 100), integers)
    assert not has_scale(replace(CARTESIAN, step=LARGEST), integers)
    assert not has_scale(replace(CARTESIAN, step=1.0, anchor_step=LARGEST), integers)
    assert not has_scale(replace(CARTESIAN, coarse=1e3, step=LARGEST / 100), integers)


def test_the_origin_counts() -> None:
    integers = Integers(ONES)
    assert has_scale(replace(CARTESIAN, origin=(0.0, -LARGEST, 0.0)), integers)
    assert not has_scale(replace(CARTESIAN, origin=(0.0, -101 * LARGEST, 0.0)), integers)
