"""Last trials: other steps of the smallest trial that a search has found."""

from __future__ import annotations

import math

import meshes
import numpy as np
import pytest

from deltamesh import encode, info
from deltamesh._geometry import last_trials
from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.candidates import SMALL
from deltamesh._geometry.last_trials import (
    LARGER,
    NEAR,
    NEAREST,
    SMALLER,
    TINY,
    TRIES,
    luckier,
    nearer,
)
from deltamesh._geometry.trial import SECTION, Trial
from deltamesh._measures.measure import Measured
from deltamesh._measures.metrics import VertexErrors
from deltamesh._options import Options, settings_of
from deltamesh_formats.errors import MeshError

BOUNDS = Bounds(normal_deviation=1.0)


def searched(error, size, n=TINY + 1, step=1.0, effort=2, function=nearer):
    """Return the last trial of laws of the step, and the steps that were asked for."""
    asked = []

    def attempt(settings):
        asked.append(settings.step)
        angle = error(settings.step)
        errors = VertexErrors(rms=0.0, max=0.0, normal_deviation=angle, dihedral=0.0)
        payloads = {"DELT": bytes(size(settings.step))}
        write = payloads.copy
        return Trial(settings, None, None, write, np.zeros((n, 3)), Measured(errors))

    best = attempt(settings_of(Options(method="refined", step=step), "refined"))
    asked.clear()
    return function(best, BOUNDS, effort, attempt), asked


def falling(step):
    return round(10_000 / step)


def test_a_step_is_larger_where_errors_are_below_their_bounds():
    found, asked = searched(lambda step: 0.93 * step, falling)
    assert asked == [pytest.approx(NEAREST / 0.93)]
    assert found.step == asked[0]


def test_errors_near_their_bounds_ask_for_nothing():
    assert searched(lambda step: step * NEAREST / NEAR * 1.001, falling)[1] == []


def test_a_step_that_is_too_large_is_halved_in_octaves():
    found, asked = searched(lambda step: 0.9 if step == 1 else step, falling)
    assert len(asked) == TRIES
    assert asked[1] == pytest.approx(math.sqrt(asked[0]))
    assert found.step == 1.0


def test_larger_files_are_left():
    assert searched(lambda step: 0.9 * step, lambda _: 10_000)[0].step == 1.0


def test_large_meshes_and_little_effort_have_no_last_trials():
    for n, effort in [(SMALL + 1, 2), (SMALL + 1, 3), (SMALL, 1), (TINY, 1)]:
        for function in (nearer, luckier):
            assert searched(lambda step: 0.5 * step, falling, n, 1.0, effort, function)[1] == []
    assert searched(lambda step: 0.9 * step, falling, SMALL)[1]


def test_few_vertices_take_the_smallest_of_a_ladder_of_steps():
    """Its errors exceed the bounds in between."""
    best_step = 2 ** (11 / 16)

    def error(step):
        return 2.0 if 1.1 < step < 1.4 or step > 1.9 else 0.9

    def size(step):
        return 40 if math.isclose(step, best_step) else 50

    found, asked = searched(error, size, TINY, function=luckier)
    assert len(asked) == len(LARGER)
    assert found.step == pytest.approx(best_step)


def test_files_of_few_bits_take_the_smallest_of_finer_steps():
    luck = 2 ** (-2 / 16)
    found, asked = searched(
        lambda step: 0.99,
        lambda step: 40 if math.isclose(step, luck) else 50,
        SMALL,
        function=luckier,
    )
    assert len(asked) == len(SMALLER)
    assert found.step == pytest.approx(luck)


def test_a_step_that_is_no_step_of_a_mesh_ends_the_trials():
    def error(step):
        if step > 1:
            raise MeshError("too small")
        return 0.5

    for n, function in [(TINY, luckier), (SMALL, nearer)]:
        assert searched(error, falling, n, function=function)[0].step == 1.0


def test_sections_count_beside_their_payloads():
    found, _ = searched(lambda step: step, falling)
    assert found.size == 10_000 + SECTION


def test_files_become_smaller_within_the_same_bounds(monkeypatch):
    V, F = meshes.icosphere(3)
    V = V * (1 + 0.1 * np.sin(4 * V) @ np.ones((3, 1)))

    def total():
        files = {angle: encode(V, F, normal_error=angle) for angle in (0.5, 1.0, 2.0, 4.0)}
        assert all(info(data).meta.normal <= angle for angle, data in files.items())
        return sum(map(len, files.values()))

    smaller = total()
    monkeypatch.setattr(last_trials, "SMALL", 0)
    assert smaller < total()
