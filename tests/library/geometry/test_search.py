"""The search for the fewest bytes: what it asks for, and what it makes of the answers."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import meshes
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh import TargetError, encode, info
from deltamesh._geometry import last_trials, step_search
from deltamesh._geometry import search as search_module
from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.part_search import Components
from deltamesh._geometry.search import smallest
from deltamesh._geometry.step_search import MOST_TRIES
from deltamesh._geometry.trial import Trial
from deltamesh._measures.measure import Measured
from deltamesh._measures.metrics import VertexErrors, diagonal
from deltamesh._methods import METHODS
from deltamesh._options import DEFAULT_COARSE, Options, Settings
from deltamesh_formats.container.container import Parameters
from deltamesh_formats.errors import MeshError

N = 1000


@dataclass
class Model:
    """Answers a search by laws: errors grow with the step, sizes fall with it."""

    law: object
    asked: list

    def __call__(self, settings: Settings) -> Trial:
        self.asked.append(settings)
        bits, errors = self.law(settings)
        anchors = settings.anchors or 1
        parameters = Parameters(
            settings.method, True, None, None, settings.step, (0, 0, 0), 0, 0, anchors, 0
        )
        write = {"DATA": bytes(max(int(N * bits / 8), 0))}.copy
        return Trial(settings, parameters, None, write, np.zeros((N, 3)), errors)


def search(law, options, bounds, edge=1.0, **furthest):
    model = Model(law, [])
    one = np.zeros(1, dtype=np.int64)
    alone = Components(np.zeros(N, dtype=np.int64), np.array([edge]), np.ones(1), one, one)
    return smallest(options, bounds, alone, model, **furthest), model.asked


def errors(normal, rms=0.0, largest=0.0):
    return Measured(VertexErrors(rms=rms, max=largest, normal_deviation=normal, dihedral=normal))


@given(
    st.floats(0.6, 1.8),
    st.floats(1e-6, 1e6),
    st.floats(1e-3, 1e3),
    st.floats(0, 0.05),
    st.randoms(),
)
def test_a_power_law_with_noise_gets_a_good_step(power, scale, bound, noise, rng):
    def law(settings):
        error = scale * settings.step**power * (1 + noise * (2 * rng.random() - 1))
        return 30 - 4 * math.log2(settings.step), errors(error)

    right = (bound / scale) ** (1 / power)
    edge = right * rng.choice([1e-3, 0.1, 1, 10, 1e3])
    found, asked = search(law, Options(method="highpass"), Bounds(normal_deviation=bound), edge)
    assert found.measured.errors.normal_deviation <= bound
    assert found.settings.step > 0.3 * right
    assert len(asked) <= MOST_TRIES


@given(st.floats(-6, 6), st.floats(1, 40))
def test_auto_takes_the_smaller_of_two_methods(difference, base):
    def law(settings):
        extra = difference if settings.method == "cartesian" else 0.0
        return base + 30 + extra - 3 * math.log2(settings.step), errors(settings.step)

    found, _ = search(law, Options(), Bounds(normal_deviation=1.0))
    if abs(difference) > 1:  # an error is met to within a few percent
        assert found.settings.method == ("cartesian" if difference < 0 else "refined")


def test_distances_alone_are_kept_by_cartesian_coordinates():
    def law(settings):
        return 30.0, errors(0.0, largest=settings.step)

    found, asked = search(law, Options(), Bounds(max=1.0))
    assert {settings.method for settings in asked} == {"cartesian"}
    assert 0.9 < found.measured.errors.max <= 1


def test_drift_is_held_by_anchors():
    def law(settings):
        anchors = settings.anchors or 1
        return 30 - math.log2(settings.step), errors(settings.step, 9 * settings.step / anchors)

    found, _ = search(law, Options(method="refined", coarse=8), Bounds(1.0, normal_deviation=1.0))
    assert found.parameters.anchor_count == 16
    assert found.settings.step > 0.8


@pytest.mark.parametrize(("effort", "large", "trials"), [(2, N, 1), (2, N + 1, 2), (3, N, 2)])
def test_large_meshes_are_content_with_less(monkeypatch, effort, large, trials):
    monkeypatch.setattr(step_search, "LARGE", large)
    monkeypatch.setattr(last_trials, "SMALL", 0)
    first = METHODS["refined"].first_step

    def law(settings):
        return 30 - math.log2(settings.step), errors(0.88 * settings.step / first)

    options = Options(method="refined", coarse=DEFAULT_COARSE, effort=effort)
    _, asked = search(law, options, Bounds(normal_deviation=1.0))
    assert len(asked) == trials


@pytest.mark.parametrize(("bits", "is_tried"), [(1.0, True), (9.0, False)])
def test_coarser_deltas_are_tried_where_a_file_has_few_bits(bits, is_tried):
    def law(settings):
        return bits - 1e-3 * settings.coarse, errors(settings.step)

    _, asked = search(law, Options(method="refined"), Bounds(normal_deviation=1.0))
    assert (max(settings.coarse for settings in asked) > DEFAULT_COARSE) == is_tried


def test_a_guess_of_too_many_anchors_is_taken_back():
    """An anchor that costs a lot, and corrections that keep the distance all the same."""

    def law(settings):
        anchors = settings.anchors or 1
        far = min(9 * settings.step / anchors, settings.largest)
        return 30 - math.log2(settings.step) + anchors / 4, errors(settings.step, largest=far)

    bounds = Bounds(max=0.05, normal_deviation=1.0)
    options = Options(method="refined", coarse=8)
    found, asked = search(law, options, bounds)
    assert max(settings.anchors or 1 for settings in asked) >= 8
    assert found.parameters.anchor_count == 1


def weighed(cells, options, rms=0.0):
    """Return whether least squares are found where vectors of cells take so many bits a vertex."""

    def law(settings):
        bits = 10 - math.log2(settings.step) + cells * settings.interpolated
        return bits, errors(settings.step, rms * settings.step)

    model = Model(law, [])

    def attempt(settings):
        trial = model(settings)
        payloads = {"DELT": bytes(trial.size)}
        if settings.interpolated:
            payloads["CELL"] = bytes(round(N * cells / 8))
        parameters = replace(trial.parameters, interpolated=settings.interpolated)
        return replace(trial, parameters=parameters, encode=payloads.copy)

    one = np.zeros(1, dtype=np.int64)
    alone = Components(np.zeros(N, dtype=np.int64), np.ones(1), np.ones(1), one, one)
    bounds = Bounds(rms=1.0, normal_deviation=1.0)
    return not smallest(options, bounds, alone, attempt).parameters.interpolated


def test_vectors_of_cells_that_weigh_give_way_to_least_squares():
    options = Options(method="refined", coarse=4.5)
    assert weighed(1.0, options)
    assert not weighed(0.01, options)
    assert weighed(0.01, options, rms=2.0)  # where a distance bounds the step
    for other in (replace(options, solution="interpolated"), replace(options, effort=1)):
        assert not weighed(1.0, other)


def test_large_meshes_are_not_tried_in_least_squares(monkeypatch):
    monkeypatch.setattr(search_module, "SMALL", N - 1)
    assert not weighed(1.0, Options(method="refined", coarse=4.5))


def test_least_squares_make_files_of_few_bits_smaller():
    V, F = meshes.icosphere(4)
    V = V * (1 + 0.1 * np.sin(4 * V) @ np.ones((3, 1)))
    found, other = (info(encode(V, F, quality=2, solution=name)) for name in (None, "interpolated"))
    assert found.parameters.solution == "least-squares"
    assert found.size < 0.95 * other.size


def test_corrections_let_the_step_grow_while_files_shrink():
    def law(settings):
        error = settings.step if settings.largest == math.inf else min(settings.step, 1.0)
        return 30 - 4 * math.log2(settings.step) + settings.step, errors(0.0, largest=error)

    options = Options(method="refined", coarse=8)
    found, _ = search(law, options, Bounds(max=1.0))
    assert 2 < found.settings.step < 12  # the least of the law is at 4 / ln 2
    assert found.settings.largest == 1.0


def test_an_error_that_does_not_fall_is_a_missed_target():
    with pytest.raises(TargetError, match="normal deviation 1 cannot be met: the least found is 7"):
        search(lambda settings: (9.0, errors(7.0)), Options(), Bounds(normal_deviation=1.0))


def test_a_step_that_is_too_small_ends_the_search():
    def law(settings):
        if settings.step < 0.01:
            raise MeshError("too small")
        return 9.0, errors(100 * settings.step)

    with pytest.raises(TargetError, match="cannot be met"):
        search(law, Options(), Bounds(normal_deviation=0.5))


def test_an_error_of_nothing_lets_the_step_grow():
    def law(settings):
        return 9.0, errors(0.0 if settings.step < 50 else 1e9)

    options = Options(method="cartesian")
    assert search(law, options, Bounds(normal_deviation=1.0))[0].settings.step >= 16


def test_a_rate_is_not_searched_for():
    law = lambda settings: (9.0, errors(1.0))  # noqa: E731
    for options in (Options(method="highpass"), Options(method="cartesian", bits=9)):
        found, asked = search(law, options, None)
        assert asked == [found.settings]
        assert found.settings == replace(found.settings, bits=options.bits, largest=math.inf)


def test_auto_at_a_step_is_not_worse_than_refined():
    V, F = meshes.torus(24, 16)
    step = diagonal(V) / 500
    plain, auto = (info(encode(V, F, method=method, step=step)) for method in ("refined", "auto"))
    assert auto.meta.normal <= plain.meta.normal
    assert auto.size <= plain.size


def test_auto_at_a_rate_bends_nothing_that_refined_keeps_flat():
    i, j = (x.ravel() for x in np.meshgrid(np.arange(21) / 20, np.arange(13) / 12))
    V = np.stack((i, j, 0 * i), axis=1)
    F = meshes.grid(13, 21)[1]
    for bits in (5, 8, 11):
        auto, refined = (info(encode(V, F, method=m, bits=bits)).meta for m in ("auto", "refined"))
        assert auto.normal <= refined.normal
        assert auto.max <= refined.max
    assert refined.normal == 0


def test_zero_bits_are_a_least_squares_mesh():
    assert info(encode(*meshes.torus(8, 6), bits=0)).parameters.method == "highpass"


@pytest.mark.parametrize(
    "name", meshes.large_are_slow(["clean/1002_tray_bottom.STL", "unstated/fandisk.obj"], 200_000)
)
def test_more_effort_is_never_much_larger_on_real_meshes(name):
    mesh = meshes.real(name)
    sizes = [len(encode(mesh.vertices, mesh.faces, effort=effort)) for effort in (1, 2, 3)]
    assert sizes[2] <= 1.02 * sizes[1] <= 1.05 * sizes[0]


def test_a_rate_at_which_refined_would_drift_is_met_by_cartesian_coordinates():
    def law(settings):
        if settings.method == "refined":
            return 10.0, errors(1.0, rms=0.3, largest=0.5)
        return 20.0, errors(settings.step, rms=settings.step / 10, largest=settings.step)

    options, furthest = Options(bits=8), Bounds(rms=0.02)
    found, _ = search(law, options, None, furthest=furthest)
    assert found.settings.method == "cartesian"
    assert found.measured.errors.rms <= 0.02
    found, _ = search(law, options, None, furthest=Bounds(rms=0.4))
    assert found.settings.method == "refined"
