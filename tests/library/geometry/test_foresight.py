"""Foresight: what a search on a sample tells of one on the whole."""

from __future__ import annotations

import math

import meshes
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh import encode, info
from deltamesh._geometry import last_trials, search
from deltamesh._geometry import sample as samples
from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.candidates import CHEAP, COARSE
from deltamesh._geometry.foresight import BORDERS, NEAR, RIVALS, foresight
from deltamesh._geometry.step_search import CLOSE, aim_of, first_step
from deltamesh._geometry.trial import Trial
from deltamesh._measures.measure import Measured
from deltamesh._measures.metrics import VertexErrors
from deltamesh._methods import METHODS
from deltamesh._options import Options
from deltamesh._sections.trials import Trials
from deltamesh_formats.container.container import Parameters
from deltamesh_formats.errors import LimitError, MeshError, SolveError

N, EDGE = 1000, 2.0
BOUNDS = Bounds(rms=1.0, normal_deviation=1.0)


def model(error, size, asked=None):
    """Return trials whose normals err, and that take bytes, by laws of the settings."""

    def attempt(settings):
        if asked is not None:
            asked.append(settings)
        errors = VertexErrors(rms=0, max=0, normal_deviation=error(settings), dihedral=0)
        parameters = Parameters(settings.method, True, None, None, settings.step, (0, 0, 0), 0)
        payloads = {"DELT": bytes(int(size(settings))), "NORM": bytes(500)}
        return Trial(
            settings, parameters, None, lambda: payloads, np.zeros((N, 3)), Measured(errors)
        )

    return attempt


def by_method(refined, cartesian):
    return lambda settings: refined if settings.method == "refined" else cartesian


@given(st.floats(0.5, 2), st.floats(0.5, 2), st.floats(0.3, 3))
def test_the_first_step_is_where_the_search_is_content(relief, slope, share):
    """A sample of more relief or less of it errs as much more or less, whatever the method."""

    def error(settings):
        return slope * settings.step / METHODS[settings.method].first_step / EDGE

    def of_sample(settings):
        borders = BORDERS if settings.method == "refined" else 1.0
        return relief * error(settings) / borders

    sizes = by_method(900, 5000)
    bounds = Bounds(rms=1.0, normal_deviation=share)
    sample, whole = model(of_sample, sizes), model(error, sizes)
    [(settings, step)] = foresight(Options(), bounds, N, EDGE, sample, whole)
    assert settings.method == "refined"
    assert settings.step is None
    expected = aim_of(CLOSE[2]) * share / slope * METHODS["refined"].first_step * EDGE
    assert step == pytest.approx(expected)


def linear(settings):
    return settings.step / float(first_step(settings, BOUNDS, np.array([EDGE]))[0])


def tried(refined, cartesian, method="auto"):
    attempt, options = model(linear, by_method(refined, cartesian)), Options(method, coarse=4.0)
    return [one.method for one, _ in foresight(options, BOUNDS, N, EDGE, attempt, attempt)]


def test_a_method_is_tried_unless_it_clearly_lost():
    total = 1000 + 500
    near = math.floor(RIVALS * total) - 500
    assert tried(1000, near) == ["refined", "cartesian"]
    assert tried(1000, near + 2) == ["refined"]
    assert tried(near, 1000) == ["cartesian", "refined"]
    assert tried(near + 2, 1000) == ["cartesian"]
    assert tried(5000, 1000, "refined") == ["refined"]


@pytest.mark.parametrize(("n", "near"), [(N, 1), (CHEAP, 1), (CHEAP + 1, 0)])
@pytest.mark.parametrize("best", COARSE[3])
def test_coarse_factors_are_tried_that_are_near_the_best(best, n, near):
    """Of a large mesh, the best on the sample alone."""
    bytes_of = {best: 1000, COARSE[3][COARSE[3].index(best) - 1]: 1000 + (NEAR - 1) * 1500 - 1}

    def size(settings):
        return 5000 if settings.method == "cartesian" else bytes_of.get(settings.coarse, 1100)

    attempt = model(linear, size)
    found = foresight(Options(effort=3), BOUNDS, n, EDGE, attempt, attempt)
    assert [one.coarse for one, _ in found] == list(bytes_of)[: 1 + near]


def test_the_whole_is_tried_once_and_on_a_grid():
    asked = []
    attempt, whole = model(linear, by_method(900, 5000)), model(linear, by_method(900, 5000), asked)
    for options in (Options(), Options(method="refined"), Options(method="highpass")):
        asked.clear()
        foresight(options, BOUNDS, N, EDGE, attempt, whole)
        assert [settings.method for settings in asked] == ["cartesian"]


def raising(error):
    def attempt(settings):
        raise error("not here")

    return attempt


@pytest.mark.parametrize(
    "error",
    [
        lambda _: 0.0,
        lambda _: 99.0,
        raising(MeshError),
        raising(SolveError),
        raising(LimitError),
    ],
)
def test_a_sample_that_tells_nothing_is_not_asked(error):
    sample, whole = model(error, by_method(900, 900)), model(linear, by_method(900, 900))
    assert foresight(Options(), BOUNDS, N, EDGE, sample, whole) == []


def test_large_meshes_take_few_trials_and_are_no_larger(monkeypatch):
    V, F = meshes.icosphere(5)
    rng = np.random.default_rng(7)
    V = V * (1 + 0.05 * np.sin(5 * V) @ np.ones((3, 1))) + rng.normal(0, 3e-4, V.shape)
    calls = []
    plain = Trials.attempt
    monkeypatch.setattr(Trials, "attempt", lambda *args: calls.append(args[1]) or plain(*args))

    def found():
        calls.clear()
        data = encode(V, F, normal_error=1.0, rms_error_rel=0.05)
        return info(data), [one.method for one in calls].count("refined")

    guessed, before = found()
    monkeypatch.setattr(samples, "LEAST", 2000)
    monkeypatch.setattr(samples, "BALL", 800)
    for module in (search, last_trials):
        monkeypatch.setattr(module, "SMALL", 0)
    foreseen, after = found()
    assert after <= 2
    assert after < before
    assert foreseen.size <= 1.02 * guessed.size
    assert foreseen.meta.normal <= 1.0
