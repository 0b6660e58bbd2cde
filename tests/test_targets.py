"""Quality asked for in units, and proved."""

from __future__ import annotations

import math

import meshes
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh import OptionError, TargetError, decode, encode, info
from deltamesh.codec import encode_mesh
from deltamesh.mesh import Mesh
from deltamesh.metrics import diagonal
from deltamesh.options import Options
from deltamesh.targets import find_step
from deltamesh_formats.errors import MeshError

METHODS = ("highpass", "refined", "cartesian")
BUMPY = meshes.torus(24, 16)


@given(
    st.floats(0.6, 1.8),
    st.floats(1e-6, 1e6),
    st.floats(1e-3, 1e3),
    st.floats(0, 0.05),
    st.randoms(),
)
def test_a_power_law_with_noise_gets_a_good_step(power, scale, bound, noise, rng):
    asked = []

    def measure(step):
        asked.append(step)
        return scale * step**power * (1 + noise * (2 * rng.random() - 1))

    right = (bound / scale) ** (1 / power)
    step = find_step(measure, bound, right * rng.choice([1e-3, 0.1, 1, 10, 1e3]))
    assert scale * step**power * (1 - noise) <= bound
    assert step > 0.3 * right
    assert len(asked) <= 16


def test_an_error_that_does_not_fall_is_a_missed_target():
    with pytest.raises(TargetError, match=r"an error of 1 cannot be met: 7 is the least"):
        find_step(lambda step: 7.0, 1.0, 1.0)


def test_a_step_that_is_too_small_ends_the_search():
    def measure(step):
        if step < 0.01:
            raise MeshError("too small")
        return 100 * step

    with pytest.raises(TargetError, match="cannot be met"):
        find_step(measure, 1e-6, 1.0)


def test_an_error_of_nothing_lets_the_step_grow():
    assert find_step(lambda step: 0.0 if step < 50 else math.inf, 1.0, 1.0) >= 16


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("bound", [3.0, 0.2])
def test_normals_are_within_their_bound_and_near_it(method, bound):
    meta = info(encode(*BUMPY, method=method, normal_error=bound)).meta
    assert 0.5 * bound < meta.normal <= bound


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("relative", [True, False])
def test_no_vertex_is_beyond_the_bound(method, relative):
    V, F = BUMPY
    scale = diagonal(V)
    asked = {"max_error_rel": 1e-3} if relative else {"max_error": 1e-3 * scale}
    one = encode_mesh(Mesh(V, F), Options(method=method, **asked))
    for solver in ("rslab", "scipy"):
        W = decode(one.data, solver=solver).vertices
        assert np.linalg.norm(W - V[one.order], axis=1).max() <= 1e-3 * scale
    assert info(one.data).meta.max > 0.3e-3 * scale


def test_a_bound_below_what_numbers_hold_is_missed():
    with pytest.raises(TargetError, match="cannot be met"):
        encode(*BUMPY, method="cartesian", max_error_rel=1e-15)


@pytest.mark.parametrize("name", ["normal_error", "max_error", "max_error_rel"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_bounds_are_numbers_above_zero(name, value):
    with pytest.raises(OptionError, match=f"{name} must be a number above 0"):
        encode(*BUMPY, **{name: value})


def test_one_rate_at_most():
    with pytest.raises(OptionError, match="bits and max_error exclude each other"):
        encode(*BUMPY, bits=8, max_error=1.0)


@pytest.mark.parametrize(
    "name",
    ["unstated/fandisk.obj", "unstated/camelhead.off", "clean/spot.obj", "clean/tank.obj"],
)
@pytest.mark.parametrize("method", METHODS)
def test_the_bound_holds_on_real_meshes(name, method):
    mesh = meshes.real(name)
    one = encode_mesh(mesh, Options(method=method, max_error_rel=1e-3))
    error = np.linalg.norm(decode(one.data).vertices - mesh.vertices[one.order], axis=1)
    assert 0.3 * 1e-3 < error.max() / diagonal(mesh.vertices) <= 1e-3
