"""Quality asked for in units, and proved."""

from __future__ import annotations

import os

import meshes
import numpy as np
import pytest

from deltamesh import MeshError, OptionError, TargetError, decode, encode, info
from deltamesh._geometry.bounds import Bounds, bounds_of
from deltamesh._measures.measure import Measured
from deltamesh._measures.metrics import VertexErrors, diagonal
from deltamesh._options import Options
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh_formats.polymesh.mesh import from_triangles

METHODS = ("auto", "highpass", "refined", "cartesian")
BUMPY = meshes.torus(24, 16)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("bound", [3.0, 0.2])
def test_angles_are_within_their_bounds_and_near_them(method, bound):
    meta = info(encode(*BUMPY, method=method, normal_error=bound, only=True)).meta
    assert 0.5 * bound < meta.normal <= bound
    meta = info(encode(*BUMPY, method=method, dihedral_error=bound, only=True)).meta
    assert 0.5 * bound < meta.dihedral <= bound


def test_bounds_go_together():
    scale = diagonal(BUMPY[0])
    meta = info(encode(*BUMPY, quality=4, normal_error=9.0, max_error_rel=2e-3)).meta
    assert meta.normal <= 2**0.5
    assert meta.max <= 2e-3 * scale
    assert meta.rms <= 1.5e-3 * 2**0.5 * scale


def test_two_levels_of_quality_halve_the_bounds():
    five, seven = (bounds_of(Options(quality=q), 10.0) for q in (5, 7))
    assert (five.normal_deviation, five.rms) == (1.0, pytest.approx(0.015))
    assert (seven.normal_deviation, seven.rms) == (0.5, pytest.approx(0.0075))
    assert bounds_of(Options(), 10.0) == five
    assert bounds_of(Options(method="refined"), 10.0) == five
    assert bounds_of(Options(method="refined", bits=7), 10.0) is None
    assert bounds_of(Options(method="lossless"), 10.0) is None


@pytest.mark.parametrize("quality", range(1, 10))
def test_a_better_quality_is_within_the_bounds_of_a_worse(quality):
    meta = info(encode(*BUMPY, quality=quality)).meta
    assert meta.normal <= 2 ** ((5 - quality) / 2)
    assert meta.rms <= 1.5e-3 * diagonal(BUMPY[0]) * 2 ** ((5 - quality) / 2)


def test_the_excess_is_the_worst_share_and_names_what_was_missed():
    bounds = Bounds(rms=2.0, normal_deviation=1.0)
    errors = VertexErrors(rms=1.0, max=99.0, normal_deviation=3.0, dihedral=5.0)
    assert bounds.excess(Measured(errors)) == 3.0
    assert bounds.part_excess(Measured(errors)) == (0.5, 3.0)
    binding = bounds.binding(Measured(errors))
    assert (binding.name, binding.error, binding.bound) == ("normal deviation", 3.0, 1.0)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("relative", [True, False])
def test_no_vertex_is_beyond_the_bound(method, relative):
    V, F = BUMPY
    scale = diagonal(V)
    asked = {"max_error_rel": 1e-3} if relative else {"max_error": 1e-3 * scale}
    one = encode_mesh(from_triangles(V, F), Options(method=method, **asked))
    for solver in ("rslab", "scipy"):
        W = decode(one.data, solver=solver).vertices
        assert np.linalg.norm(W - V[one.order], axis=1).max() <= 1e-3 * scale
    assert info(one.data).meta.max > 0.3e-3 * scale


def test_a_bound_below_what_numbers_hold_is_missed():
    with pytest.raises(TargetError, match="cannot be promised"):
        encode(*BUMPY, max_error_rel=1e-15)
    with pytest.raises(TargetError, match=r"cannot be met: the least found is .*"):
        encode(*BUMPY, method="cartesian", normal_error=1e-12)


@pytest.mark.parametrize("name", ["normal_error", "dihedral_error", "max_error", "max_error_rel"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_bounds_are_numbers_above_zero(name, value):
    with pytest.raises(OptionError, match=f"{name} must be a number above 0"):
        encode(*BUMPY, **{name: value})


def test_one_rate_at_most():
    with pytest.raises(OptionError, match="bits and max_error exclude each other"):
        encode(*BUMPY, bits=8, max_error=1.0)
    with pytest.raises(OptionError, match="bits and step exclude each other"):
        encode(*BUMPY, bits=8, step=1.0)


@pytest.mark.parametrize(("name", "most"), [("quality", 9), ("effort", 3)])
def test_levels_are_whole_numbers_from_one(name, most):
    for value in (0, most + 1, 1.5, True):
        with pytest.raises(OptionError, match=f"{name} must lie in 1..{most}"):
            encode(*BUMPY, **{name: value})


@pytest.mark.parametrize(
    "name",
    meshes.large_are_slow(
        ["unstated/fandisk.obj", "unstated/camelhead.off", "clean/spot.obj", "clean/tank.obj"],
        most_bytes=350_000,
    ),
)
@pytest.mark.parametrize("method", METHODS)
def test_the_bound_holds_on_real_meshes(name, method):
    error = largest_error(meshes.real(name), method, max_error_rel=1e-3, only=True)
    assert 0.3 * 1e-3 < error <= 1e-3


def largest_error(mesh, method, **options):
    """Of the decoded vertices, over the diagonal."""
    one = encode_mesh(meshes.as_polymesh(mesh), Options(method=method, **options))
    error = np.linalg.norm(decode(one.data).vertices - mesh.vertices[one.order], axis=1)
    return error.max() / diagonal(mesh.vertices)


# All of them take minutes.
MOST = {"expensive": 10**9}.get(os.environ.get("HYPOTHESIS_PROFILE", ""), 1_000_000)
PUBLIC = meshes.names(most_bytes=MOST)


@pytest.mark.skipif(not PUBLIC, reason="no folder of real meshes")
@pytest.mark.parametrize("name", meshes.large_are_slow(PUBLIC, most_bytes=200_000))
def test_no_vertex_of_any_real_mesh_is_beyond_the_bound(name):
    try:
        mesh = meshes.real(name)
    except MeshError as error:
        pytest.skip(str(error))
    assert largest_error(mesh, "refined", max_error_rel=1e-3) <= 1e-3
    assert largest_error(mesh, "auto", quality=4, max_error_rel=2e-3) <= 2e-3


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "faces", [[[0, 0, 1], [1, 1, 2]], [[0, 0, 0]], [[0, 1, 2], [1, 3, 2]]], ids=str
)
@pytest.mark.parametrize("turn", [0, 1], ids=["on a line", "at a point"])
def test_faces_without_an_area_keep_distances(method, faces, turn):
    V = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]) * (1 - turn)
    for options in ({"quality": 7}, {"max_error": 0.01}, {"normal_error": 1.0, "only": True}):
        W = decode(encode(V, faces, method=method, keep_order=True, **options)).vertices
        if "only" not in options:
            assert np.abs(W - V).max() <= 0.01


@pytest.mark.parametrize("method", METHODS[1:])
def test_a_named_method_comes_as_near_to_the_default_quality_as_it_can(method):
    V = np.array([[0.1, -1e-10, 0], [0.2, -5e-10, 0], [1.3, 9e-10, 0], [-1.3, -6e-10, 0]])
    F = np.array([[2, 3, 0], [1, 2, 0], [1, 3, 2], [1, 0, 3]])
    one = encode_mesh(from_triangles(V, F), Options(method=method))
    assert one.draft.cost.error > one.draft.cost.bound
    assert one.container.meta.rms <= 1.5e-3 * diagonal(V)
    with pytest.raises(TargetError):
        encode(V, F, method=method, quality=5)
    assert info(encode(V, F)).parameters.method == "lossless"
