"""Samples of a surface: balls of vertices, and trials on them."""

from __future__ import annotations

from itertools import pairwise

import meshes
import numpy as np
import pytest

from deltamesh._geometry import sample as module
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.sample import sample_of
from deltamesh._geometry.systems import Systems
from deltamesh._measures.metrics import vertex_errors
from deltamesh._options import Options, settings_of
from deltamesh._shape.surface import Surface, surface_of

SMALL = {"LEAST": 500, "BALL": 100}


@pytest.fixture(autouse=True)
def of_small_surfaces(monkeypatch):
    for name, value in SMALL.items():
        monkeypatch.setattr(module, name, value)


def torus():
    V, F = meshes.torus(40, 25)
    return V, surface_of(F, len(V), 0)


def neighbours(surface: Surface) -> list[set]:
    indptr, indices = surface.graph
    return [set(indices[a:b].tolist()) for a, b in pairwise(indptr)]


def test_a_sample_has_balls_and_what_is_within_them():
    _, surface = torus()
    sample = sample_of(surface)
    of_whole, of_sample = neighbours(surface), neighbours(sample.surface)
    assert sample.surface.labels.max() + 1 == module.BALLS
    assert sample.share == len(sample.vertices) / surface.vertex_count
    assert 0.2 < sample.share < 0.5
    whole = sample.vertices.tolist()
    ball = dict(zip(whole, sample.surface.labels.tolist(), strict=True))
    for i, v in enumerate(whole):
        assert {whole[j] for j in of_sample[i]} == {
            w for w in of_whole[v] if ball.get(w) == ball[v]
        }
    expected = [f for f in surface.faces.tolist() if len({ball.get(v) for v in f} | {None}) == 2]
    expected = [f for f in expected if set(f) <= ball.keys()]
    assert sample.vertices[sample.surface.faces].tolist() == expected
    inside = {v for v in whole if all(ball.get(w) == ball[v] for w in of_whole[v])}
    inner = [f for f in expected if set(f) <= inside]
    assert sample.vertices[sample.inner].tolist() == inner
    assert 0.5 < len(inner) / len(expected) < 1


def test_quads_of_a_sample_are_those_whose_corners_are():
    i, j = (x.ravel() for x in np.mgrid[:39, :39])
    a = 40 * i + j
    quads = np.stack([a, a + 1, a + 41, a + 40], axis=1)
    faces = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    hidden = np.tile([False, False, True, True, False, False], len(quads))
    surface = surface_of(faces, 1600, 0, hidden, quads)
    sample = sample_of(surface)
    found = sample.vertices[sample.surface.quads]
    label = np.full(1600, -1)
    label[sample.vertices] = sample.surface.labels
    one_ball = (label[quads] == label[quads[:, :1]]).all(axis=1) & (label[quads[:, 0]] >= 0)
    assert found.tolist() == quads[one_ball].tolist()


def test_small_surfaces_and_those_of_one_hub_have_no_sample():
    V, F = meshes.torus(20, 20)
    assert sample_of(surface_of(F, len(V), 0)) is None
    rim = np.arange(1, 1001)
    star = np.stack([np.zeros(1000, dtype=np.int64), rim, np.roll(rim, -1)], axis=1)
    assert sample_of(surface_of(star, 1001, 0)) is None


@pytest.mark.parametrize("method", ["refined", "cartesian", "highpass"])
def test_a_trial_has_the_errors_of_the_inner_faces(method):
    V, surface = torus()
    sample = sample_of(surface)
    options = Options(method=method, step=0.01, anchors=None if method == "cartesian" else 40)
    trial = sample.attempt(V)(settings_of(options, method))
    own = V[sample.vertices]
    plain = vertex_errors(own, trial.vertices, sample.inner)
    assert trial.measured.errors.normal_deviation == pytest.approx(plain.normal_deviation)
    assert trial.measured.parts is None
    decoded = geometry_codec(method).reconstruct(
        sample.surface, trial.parameters, trial.integers, Systems(sample.surface)
    )
    assert np.abs(decoded - trial.vertices).max() < 1e-4
    assert trial.size > 0
    if method != "cartesian":
        assert trial.parameters.anchor_count == round(40 * sample.share)
