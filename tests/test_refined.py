"""Coarse deltas and their correction along the normals."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh import FormatError, OptionError, codec, decode, encode, entropy, info
from deltamesh.codec import encode_mesh
from deltamesh.kernels import delta as kernels
from deltamesh.kernels import residual
from deltamesh.laplacian import adjacency
from deltamesh.mesh import Mesh
from deltamesh.metrics import diagonal
from deltamesh.normals import vertex_normals
from deltamesh.options import Options
from deltamesh.quantize import quantize_delta

SPHERE, TORUS = meshes.icosphere(3), meshes.torus(12, 9)


def refined(mesh, **options):
    return encode_mesh(Mesh(*mesh), Options(method="refined", **options))


@pytest.mark.parametrize("name", sorted(meshes.every()))
def test_normals_against_a_loop(name):
    V, F = meshes.every()[name]
    np.testing.assert_allclose(vertex_normals(V, F, 0.1), oracle.normals(V, F, 0.1), atol=1e-12)


def test_normals_of_a_sphere_point_outwards():
    V, F = SPHERE
    assert ((vertex_normals(V, F, 1e-3) * V).sum(axis=1) > 0.99).all()


@pytest.mark.parametrize("scale", [1e-150, 1e140])
def test_scale_changes_nothing(scale):
    V, F = TORUS
    np.testing.assert_allclose(
        vertex_normals(V * scale, F, scale), vertex_normals(V, F, 1.0), atol=1e-12
    )
    one = refined((V * scale, F))
    assert np.abs(one.mesh.vertices / scale - refined(TORUS).mesh.vertices).max() < 1e-9


def test_normals_fade_where_faces_cancel():
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5]])
    F = np.array([[0, 1, 2], [0, 2, 1]])
    assert (vertex_normals(V, F, 0.01) == 0).all()
    V[1, 2] = 1e-12  # what two machines may differ by: the normals must not
    assert np.abs(vertex_normals(V, F, 0.01)).max() < 1e-5


@pytest.mark.parametrize("step", [1.0, 2.0])
def test_solvers_agree_where_the_coarse_surface_collapses(step):
    V, F = meshes.two_components()
    data = refined((V, F), step=step, anchors=1).data
    one, other = (decode(data, solver=solver).vertices for solver in ("rslab", "scipy"))
    assert np.abs(one - other).max() <= 1e-9 * diagonal(V)


def test_the_positions_are_those_of_two_dense_least_squares_problems():
    V, _ = TORUS
    one = refined(TORUS, anchors=3, coarse=5.0)
    _, surface, integers = codec._read(info(one.data), 10**9, 2**40, codec.silent)
    p = info(one.data).parameters
    L = oracle.laplacian(surface.faces, len(V))
    anchored = np.array(p.origin) + integers.positions * p.anchor_step
    delta = integers.values * (p.coarse * p.step)
    x = oracle.least_squares(L, integers.anchors, delta, anchored)
    delta = delta + p.step * integers.refinements * oracle.normals(
        x, surface.faces, p.coarse * p.step
    )
    x = oracle.least_squares(L, integers.anchors, delta, anchored)
    assert np.abs(decode(one.data).vertices - x).max() < 1e-9 * diagonal(V)


@pytest.mark.parametrize("name", sorted(meshes.every()))
def test_round_trip(name):
    V, F = meshes.every()[name]
    one = refined((V, F), threads=1)
    assert refined((V, F), threads=2).data == one.data
    for solver in ("rslab", "scipy"):
        mesh = decode(one.data, solver=solver)
        assert (mesh.faces == one.mesh.faces).all()
        assert np.abs(mesh.vertices - one.mesh.vertices).max() <= 1e-9 * diagonal(V)


numbers = st.integers(-(2**30), 2**30) | st.integers(-4, 4)


@given(st.data())
def test_any_refinements_come_back(data):
    V, F = meshes.icosphere(1)
    n = len(V)
    graph = adjacency(F, n)
    column = st.lists(numbers, min_size=n, max_size=n)
    deltas = np.array([data.draw(column) for _ in range(3)]).T.copy()
    values = np.array(data.draw(column)).reshape(n, 1)
    coder = entropy.encoder(n, residual.SLOTS, residual.MIXERS)
    kernels.code_refinements(coder, *graph, deltas, values.copy())
    decoder = entropy.decoder(entropy.finish(coder), residual.SLOTS, residual.MIXERS)
    out = np.zeros((n, 1), dtype=np.int64)
    kernels.code_refinements(decoder, *graph, deltas, out)
    assert (out == values).all()
    entropy.check_end(decoder, 0)


@pytest.mark.parametrize("diffusion", [True, False])
def test_a_dead_zone_makes_zeros_and_leaves_the_rest(diffusion):
    V, F = SPHERE
    graph = adjacency(F, len(V))
    delta = np.random.default_rng(9).normal(0, 0.5, (len(V), 1))
    plain = quantize_delta(delta, graph, 1.0, diffusion)
    zoned = quantize_delta(delta, graph, 1.0, diffusion, 0.3)
    assert (zoned == 0).sum() > (plain == 0).sum()
    if not diffusion:
        outside = np.abs(delta) > 0.8
        assert (zoned[outside] == plain[outside]).all()
        assert (zoned[~outside] == 0).all()


def test_what_is_recorded():
    p = info(refined(SPHERE, coarse=3.5).data).parameters
    assert (p.method, p.coarse, p.dead_zone, p.normal_dead_zone) == ("refined", 3.5, 0.2, 0.1)
    assert info(encode(*SPHERE)).parameters.coarse == 1


@pytest.mark.parametrize("coarse", [0.5, 65.0, float("nan")])
def test_a_bad_factor_is_refused(coarse):
    with pytest.raises(OptionError, match=r"coarse must lie in 1\.\.64"):
        encode(*SPHERE, method="refined", coarse=coarse)


def test_a_factor_goes_with_the_refined_method_only():
    with pytest.raises(OptionError, match="coarse means nothing with method highpass"):
        encode(*SPHERE, coarse=4.0)


def test_every_flip_in_the_corrections_is_noticed():
    data = refined(TORUS).data
    section = info(data).sections["NORM"]
    for at in range(section.offset, section.offset + section.size):
        for bit in range(8):
            wrong = bytearray(data)
            wrong[at] ^= 1 << bit
            with pytest.raises(FormatError):
                decode(bytes(wrong))


@pytest.mark.parametrize(
    "name", ["unstated/bun_zipper.ply", "unstated/horse.ply", "clean/skull.obj"]
)
def test_the_same_normals_in_fewer_bytes(name):
    """At equal normal deviation a tenth smaller than the plain method, and more."""
    mesh = meshes.real(name)
    step = 0.001 * diagonal(mesh.vertices)

    def at(method, step):
        coarse = 4.0 if method == "refined" else None
        options = Options(method=method, step=step, coarse=coarse, drop_isolated=True)
        container = info(encode_mesh(mesh, options).data)
        return container.size, container.meta.normal

    size, normal = at("refined", step)
    sizes, normals = zip(*(at("highpass", step * k) for k in (4, 2, 1)), strict=True)
    plain = np.interp(np.log(normal), np.log(normals[::-1]), np.log(sizes[::-1]))
    assert size < 0.9 * np.exp(plain)
