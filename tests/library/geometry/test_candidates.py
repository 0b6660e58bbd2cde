"""Candidates of a search."""

from __future__ import annotations

import numpy as np
import pytest

from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.candidates import CHEAP, SMALL, candidates, may_pay
from deltamesh._geometry.trial import Trial
from deltamesh._measures.measure import Measured
from deltamesh._measures.metrics import VertexErrors
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


def trial(deltas, normals, n=CHEAP, settings=REFINED, rms=0.5):
    payloads = {"DELT": bytes(deltas), "NORM": bytes(normals)}
    errors = VertexErrors(rms=rms, max=rms, normal_deviation=0.9, dihedral=0.0)
    return Trial(settings, None, None, lambda: payloads, np.zeros((n, 3)), Measured(errors))


def pays(coarse, best, bounds=ANGLE, effort=2):
    settings = next(one for one in candidates(Options(), ANGLE) if one.coarse == coarse)
    return may_pay(settings, REFINED, best, bounds, effort)


@pytest.mark.parametrize(
    ("coarse", "deltas", "normals", "n", "expected"),
    [
        (3.0, 30_000, 30_000, CHEAP, True),  # finer: few bytes of deltas
        (3.0, 50_000, 30_000, CHEAP, False),
        (3.0, 50_000, 30_000, SMALL, True),
        (3.0, 70_000, 30_000, SMALL, False),
        (7.0, 90_000, 30_000, CHEAP, True),  # coarser: many of them
        (7.0, 60_000, 29_000, CHEAP, False),
        (7.0, 60_000, 29_000, SMALL, True),
        (7.0, 50_000, 29_000, SMALL, False),
        (7.0, 14_000, 30_000, CHEAP, True),  # ... or next to none
        (7.0, 20_000, 30_000, CHEAP, False),
        (7.0, 20_000, 30_000, SMALL, True),
        (7.0, 12_000, 6_000, CHEAP, True),  # ... or few bytes at all
        (7.0, 90_000, 30_000, CHEAP + 1, False),  # ... but not where it takes a second
    ],
)
def test_another_coarse_factor_pays_by_the_bytes_of_the_best(coarse, deltas, normals, n, expected):
    assert pays(coarse, trial(deltas, normals, n)) == expected
    assert pays(coarse, trial(deltas, normals, n), effort=3)


def test_a_sample_has_the_limits_of_large_meshes():
    best = trial(50_000, 30_000, SMALL)
    assert (pays(3.0, best), pays(3.0, best, bounds=None)) == (True, False)


def test_distances_of_small_meshes_ask_for_finer_deltas_alone():
    for n, is_small in [(SMALL, True), (SMALL + 1, False)]:
        near, far = (trial(30 * n, 10 * n, n, rms=rms) for rms in (0.9, 0.95))
        assert (pays(3.0, near), pays(7.0, near)) == (False, True)
        assert (pays(3.0, far), pays(7.0, far)) == (is_small, not is_small)


def test_another_method_is_always_tried_and_no_factor_of_one_that_lost():
    grid = trial(1, 1, settings=CARTESIAN)
    assert may_pay(REFINED, CARTESIAN, grid, ANGLE, effort=2)
    assert may_pay(CARTESIAN, None, None, ANGLE, effort=2)
    assert not may_pay(REFINED, REFINED, grid, ANGLE, effort=2)
