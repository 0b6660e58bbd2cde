"""Coarse deltas and their correction along the normals."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import oracle
import pytest
import strategies
from coders import integers_of, slow_coder
from graphs import tolerances_of, tolerances_of_points
from hypothesis import given
from hypothesis import strategies as st
from payloads import SURFACE, read_or_refused

from deltamesh import FormatError, OptionError, decode, encode, info
from deltamesh._geometry import refined as refined_method
from deltamesh._geometry.integers import Integers
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.normals import vertex_normals
from deltamesh._geometry.positions import doubt
from deltamesh._geometry.quantize import Rounding, quantize_delta
from deltamesh._geometry.systems import Systems
from deltamesh._graph.adjacency import adjacency
from deltamesh._kernels.coding import delta as kernels
from deltamesh._kernels.coding import residual
from deltamesh._measures.metrics import diagonal
from deltamesh._options import Options, Settings
from deltamesh._pipeline.decoder import read_content
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh._shape.surface import surface_of
from deltamesh._streams import entropy
from deltamesh_formats.container.container import Parameters, Section
from deltamesh_formats.polymesh.mesh import from_triangles

SPHERE, TORUS = meshes.icosphere(3), meshes.torus(12, 9)


def refined(mesh, **options):
    return encode_mesh(from_triangles(*mesh), Options(method="refined", **options))


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
    one, plain = refined((V * scale, F), step=0.01 * scale), refined(TORUS, step=0.01)
    assert np.abs(one.mesh.vertices / scale - plain.mesh.vertices).max() < 1e-9


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
    one = refined(TORUS, anchors=3, coarse=5.0, solution="least-squares")
    content = read_content(info(one.data), 10**9, 2**40)
    surface, integers = content.structure.surface, content.integers
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
@pytest.mark.parametrize("solution", ["interpolated", "least-squares"])
def test_round_trip(name, solution):
    V, F = meshes.every()[name]
    one = refined((V, F), threads=1, solution=solution)
    assert refined((V, F), threads=2, solution=solution).data == one.data
    for solver in ("rslab", "scipy"):
        mesh = decode(one.data, solver=solver)
        assert (mesh.faces == one.mesh.faces).all()
        assert (np.abs(mesh.vertices - one.mesh.vertices) <= tolerances_of(one.data, mesh)).all()


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


def twin_of(data):
    return slow_coder(data, residual.SLOTS, residual.MIXERS)


@strategies.SOME
@given(st.binary(max_size=100), st.sampled_from([0x00, 0x55, 0xFF]), st.integers(0, 300), st.data())
def test_any_bytes_are_the_refinements_of_the_oracle(data, filler, more, draw):
    """... and what was decoded encodes to the same in both."""
    F, n = meshes.icosphere(1)[1], 42
    indptr, indices = graph = adjacency(F, n)
    around = [indices[indptr[i] : indptr[i + 1]].tolist() for i in range(n)]
    rng = np.random.default_rng(draw.draw(strategies.SMALL))
    deltas = np.rint(rng.normal(size=(n, 3)) * 2.0 ** rng.uniform(-2, 28, (n, 1))).astype(np.int64)
    data += bytes([filler]) * more
    decoder = entropy.decoder(data, residual.SLOTS, residual.MIXERS)
    out, twin = np.zeros((n, 1), dtype=np.int64), twin_of(data)
    kernels.code_refinements(decoder, *graph, deltas, out)
    zeros = [[0]] * n
    assert oracle.code_refinements(twin, around, deltas.tolist(), zeros) == out.tolist()
    assert decoder.registers.code == twin.code
    assert np.abs(out).max() < 2**31
    coder, twin = entropy.encoder(n, residual.SLOTS, residual.MIXERS), twin_of(None)
    kernels.code_refinements(coder, *graph, deltas, out.copy())
    oracle.code_refinements(twin, around, deltas.tolist(), out.tolist())
    assert entropy.finish(coder) == twin.finish()


@pytest.mark.parametrize("carry", [1.0, 0.0])
def test_a_dead_zone_makes_zeros_and_leaves_the_rest(carry):
    V, F = SPHERE
    graph = adjacency(F, len(V))
    delta = np.random.default_rng(9).normal(0, 0.5, (len(V), 3))
    rounding = Rounding(tangential=carry)
    plain = quantize_delta(delta, graph, 1.0, rounding)
    zoned = quantize_delta(delta, graph, 1.0, replace(rounding, zone=0.3))
    assert (zoned == 0).sum() > (plain == 0).sum()
    if carry == 0:
        outside = np.abs(delta) > 0.8
        assert (zoned[outside] == plain[outside]).all()
        assert (zoned[~outside] == 0).all()


def test_what_is_recorded():
    p = info(refined(SPHERE, coarse=3.5).data).parameters
    zones = refined_method.COARSE.zone, refined_method.FINE.zone
    assert (p.method, p.coarse) == ("refined", 3.5)
    assert (p.dead_zone, p.normal_dead_zone) == pytest.approx(zones, abs=0.005)
    assert info(encode(*SPHERE, method="highpass")).parameters.coarse == 1


@pytest.mark.parametrize("coarse", [0.5, 65.0, float("nan")])
def test_a_bad_factor_is_refused(coarse):
    with pytest.raises(OptionError, match=r"coarse must lie in 1\.\.64"):
        encode(*SPHERE, method="refined", coarse=coarse)


def test_a_factor_goes_with_the_refined_method_only():
    with pytest.raises(OptionError, match="coarse means nothing with method highpass"):
        encode(*SPHERE, method="highpass", coarse=4.0)


def test_every_flip_in_the_refinements_is_noticed():
    data = refined(TORUS).data
    section = info(data).sections["NORM"]
    for at in range(section.offset, section.offset + section.size):
        for bit in range(8):
            wrong = bytearray(data)
            wrong[at] ^= 1 << bit
            with pytest.raises(FormatError):
                decode(bytes(wrong))


# ---- Corrections of the positions --------------------------------------------------------------


def corrected(method, V, F, bound, interpolated):
    """A file in which the vertices further from where they were than the bound are corrected."""
    step = 0.02 * diagonal(V)
    surface = surface_of(F, len(V), 0)
    settings = Settings(method, step=step, anchors=1, largest=bound, interpolated=interpolated)
    none = np.zeros((0, 3))
    module = geometry_codec(method)
    return surface, module, module.quantize(surface, V, none, settings, Systems(surface))


@pytest.mark.parametrize("interpolated", [False, True])
@pytest.mark.parametrize("method", ["highpass", "refined"])
def test_corrections_are_where_the_error_is_too_large_and_nowhere_else(method, interpolated):
    # A step is too long for what high-pass coding errs by on a torus.
    V, F = TORUS if method == "refined" else meshes.grid(15, 15)
    W = corrected(method, V, F, np.inf, interpolated)[2][2]
    bound = np.median(np.linalg.norm(W - V, axis=1))
    surface, module, (parameters, integers, X) = corrected(method, V, F, bound, interpolated)
    far = np.linalg.norm(W - V, axis=1) > bound - doubt(parameters)
    assert far.any()
    assert not far.all()
    assert (X[~far] == W[~far]).all()
    # Half a step on each axis is what is left of an error.
    assert (np.abs(X - V)[far] <= 0.5 * parameters.step * (1 + 1e-9)).all()
    steps = np.rint((V - W) / parameters.step).astype(np.int64)
    assert (integers.corrections == np.where(far[:, None], steps, 0)).all()
    payloads = module.encode(surface, parameters, integers)
    assert "FIXS" in payloads
    sections = {k: Section(k, 0, v) for k, v in payloads.items()}
    read = module.decode(surface, parameters, sections)
    assert (read.corrections == integers.corrections).all()
    assert (read.values == integers.values).all()
    assert (read.refinements == integers.refinements).all()
    again = module.reconstruct(surface, parameters, read, Systems(surface))
    if interpolated:
        assert (np.abs(again - X) <= tolerances_of_points(X, surface, parameters, read)).all()
    else:
        np.testing.assert_array_equal(again, X)


@pytest.mark.parametrize("method", ["highpass", "refined"])
def test_without_a_bound_nothing_is_corrected(method):
    surface, module, (parameters, integers, _) = corrected(method, *TORUS, np.inf, True)
    assert integers.corrections.shape == (0, 3)
    assert "FIXS" not in module.encode(surface, parameters, integers)


def test_every_flip_in_the_corrections_of_positions_is_noticed():
    mesh = meshes.grid(15, 15)
    data = encode(*mesh, method="refined", anchors=1, normal_error=8.0, max_error_rel=2e-3)
    section = info(data).sections["FIXS"]
    for at in range(section.offset, section.offset + section.size):
        wrong = bytearray(data)
        wrong[at] ^= 1 << at % 8
        with pytest.raises(FormatError):
            decode(bytes(wrong))


@pytest.mark.parametrize(
    "name",
    meshes.large_are_slow(["unstated/bun_zipper.ply", "unstated/horse.ply", "clean/skull.obj"]),
)
def test_the_same_normals_in_fewer_bytes(name):
    """At equal normal deviation a tenth smaller than the plain method, and more."""
    mesh = meshes.real(name)
    step = 0.001 * diagonal(mesh.vertices)

    def at(method, step):
        coarse = 4.0 if method == "refined" else None
        options = Options(method=method, step=step, coarse=coarse, drop_isolated=True)
        container = info(encode_mesh(meshes.as_polymesh(mesh), options).data)
        return container.size, container.meta.normal

    size, normal = at("refined", step)
    sizes, normals = zip(*(at("highpass", step * k) for k in (4, 2, 1)), strict=True)
    plain = np.interp(np.log(normal), np.log(normals[::-1]), np.log(sizes[::-1]))
    assert size < 0.9 * np.exp(plain)


def test_payloads_of_refinements_come_back_or_are_refused() -> None:
    integers = Integers(
        integers_of(42, 1),
        np.arange(5) * 8,
        np.arange(15).reshape(5, 3),
        np.arange(9).reshape(3, 3),
        refinements=integers_of(42, 2)[:, :1],
    )
    parameters = Parameters(
        "refined", True, "greedy", None, 0.01, (0.0, 0.0, 0.0), 0.001, 0, 5, 3, coarse=8.0
    )
    payloads = refined_method.encode(SURFACE, parameters, integers)
    assert list(payloads) == ["ANCH", "DELT", "NORM"]
    found = read_or_refused(refined_method.decode, parameters, **payloads)
    assert found is not None
    np.testing.assert_array_equal(found.refinements, integers.refinements)
    np.testing.assert_array_equal(found.values, integers.values)
    for damaged in (payloads["NORM"] + b"\1", payloads["NORM"] + b"\0"):
        assert (
            read_or_refused(refined_method.decode, parameters, **payloads | {"NORM": damaged})
            is None
        )
