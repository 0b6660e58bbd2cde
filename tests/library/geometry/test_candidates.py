"""Candidates of a search."""

from __future__ import annotations

import numpy as np
import pytest

from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.candidates import CHEAP, candidates, may_pay
from deltamesh._geometry.trial import Trial
from deltamesh._options import Options, settings_of

ANGLE = Bounds(rms=1.0, normal_deviation=1.0)
REFINED, CARTESIAN = (settings_of(Options(), name) for name in ("refined", "cartesian"))


def listed(options, bounds=ANGLE):
    return [(one.method, one.coarse) for one in candidates(options, bounds)]


def test_the_method_that_takes_no_time_comes_first():
    found = listed(Options())
    assert found[0][0] == "cartesian"
    assert {method for method, _ in found[1:]} == {"refined"}


@pytest.mark.parametrize("effort", [1, 2, 3])
def test_more_effort_has_more_coarse_factors(effort):
    assert len(listed(Options(effort=effort))) == {1: 1, 2: 3, 3: 4}[effort] + 1


def test_options_leave_out_candidates():
    assert listed(Options(coarse=5.0))[1:] == [("refined", 5.0)]
    assert [method for method, _ in listed(Options(method="highpass"))] == ["highpass"]
    assert {method for method, _ in listed(Options(method="refined"))} == {"refined"}
    assert [method for method, _ in listed(Options(), Bounds(rms=1.0))] == ["cartesian"]


def trial(deltas, normals, n=1000, settings=REFINED):
    payloads = {"DELT": bytes(deltas), "NORM": bytes(normals)}
    return Trial(settings, None, None, lambda: payloads, np.zeros((n, 3)), None)


@pytest.mark.parametrize(
    ("coarse", "deltas", "normals", "n", "pays"),
    [
        (3.0, 1000, 1000, 1000, True),  # finer: few bytes of deltas
        (3.0, 2000, 1000, 1000, False),
        (7.0, 3000, 1000, 1000, True),  # coarser: many of them
        (7.0, 2000, 1000, 1000, False),
        (7.0, 400, 1000, 1000, True),  # ... or next to none
        (7.0, 200, 100, 1000, True),  # ... or few bytes at all
        (7.0, 300 * CHEAP, 100 * CHEAP, CHEAP + 1, False),  # ... but not where it takes a second
    ],
)
def test_another_coarse_factor_pays_by_the_bytes_of_the_best(coarse, deltas, normals, n, pays):
    settings = next(one for one in candidates(Options(), ANGLE) if one.coarse == coarse)
    assert may_pay(settings, REFINED, trial(deltas, normals, n), effort=2) == pays
    assert may_pay(settings, REFINED, trial(deltas, normals, n), effort=3)


def test_another_method_is_always_tried_and_no_factor_of_one_that_lost():
    grid = trial(1, 1, settings=CARTESIAN)
    assert may_pay(REFINED, CARTESIAN, grid, effort=2)
    assert may_pay(CARTESIAN, None, None, effort=2)
    assert not may_pay(REFINED, REFINED, grid, effort=2)
