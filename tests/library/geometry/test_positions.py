"""Positions of encoded meshes with interpolated anchors: what integers say, and what fits do."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import oracle
import poisson_oracle
import pytest
import stepped
from graphs import tolerances_of_points

from deltamesh._geometry import highpass, positions
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.integers import NO_CELLS, NONE
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.systems import Systems
from deltamesh._options import Options, Settings
from deltamesh._pipeline.decoder import read_content
from deltamesh._pipeline.encoder import Encoded, encode_mesh
from deltamesh._shape.surface import surface_of
from deltamesh_formats.container.container import Parameters, Section
from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh.mesh import from_triangles

ROUGH = {
    name: (V + 0.02 * np.random.default_rng(7).normal(size=V.shape), F)
    for name, (V, F) in {
        "sphere": meshes.icosphere(2),
        "torus": meshes.torus(24, 16),
        "grid": meshes.grid(17, 17),
        "two": meshes.union(meshes.icosphere(2), meshes.torus(15, 12)),
    }.items()
}
METHODS = ["refined", "highpass"]


def encoded(name: str, method: str, **options) -> Encoded:
    options = {"step": 0.02, "anchors": 12, "solution": "interpolated"} | options
    return encode_mesh(from_triangles(*ROUGH[name]), Options(method=method, **options))


def contents(one: Encoded):
    """Surface, positions in its order, parameters and integers of a file without points apart."""
    content = read_content(one.container, 10**9, 2**40)
    surface = content.structure.surface
    n = surface.vertex_count
    return surface, one.draft.positions[:n], one.container.parameters, content.integers


def ratios_of(integers, n):
    return (
        np.ones((n, 1))
        if not len(integers.exponents)
        else 2.0 ** (-integers.exponents[:, None] / 4)
    )


def vectors_of(p, integers, L, stage):
    """What SPEC.md 5.20 says of y, anchor by anchor."""
    anchors = integers.anchors.tolist()
    if not len(integers.cells):
        return np.zeros((len(anchors), 3))
    each = p.step * ratios_of(integers, len(L))
    return poisson_oracle.vectors(L, anchors, integers.cells[stage], integers.units[stage], each)


def dense(surface, p, integers):
    """The last stage's Laplacian, deltas, and the positions of the anchors and of all vertices."""
    n = surface.vertex_count
    L, r = oracle.laplacian(surface.faces, n), ratios_of(integers, n)
    anchors = integers.anchors.tolist()
    points = np.array(p.origin) + integers.positions * p.anchor_step * r[anchors]
    delta = integers.values * (p.coarse * p.step * r)
    d = poisson_oracle.completed(L, anchors, delta, vectors_of(p, integers, L, 0))
    x = poisson_oracle.solution(L, anchors, d, points)
    if p.method == "refined":
        N = oracle.normals(x, surface.faces, p.coarse * p.step * r)
        delta = delta + p.step * r * integers.refinements * N
        d = poisson_oracle.completed(L, anchors, delta, vectors_of(p, integers, L, 1))
        x = poisson_oracle.solution(L, anchors, d, points)
    return L, d, points, x


def rms(x):
    return np.sqrt((x**2).sum(axis=1).mean())


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ROUGH)
def test_decoded_positions_are_those_of_dense_matrices(name: str, method: str) -> None:
    one = encoded(name, method)
    surface, _, p, integers = contents(one)
    assert p.interpolated
    assert "CELL" in one.container.sections
    *_, expected = dense(surface, p, integers)
    found = geometry_codec(method).reconstruct(surface, p, integers, Systems(surface))
    allowed = tolerances_of_points(found, surface, p, integers)
    assert (np.abs(found - expected) <= allowed).all()
    assert (np.abs(one.draft.chosen.vertices - expected) <= allowed).all()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ROUGH)
def test_the_stored_system_is_consistent_but_for_rounding(name: str, method: str) -> None:
    """Its least squares, with the rows of the anchors, are within a fraction of a step of it."""
    surface, _, p, integers = contents(encoded(name, method))
    L, d, points, x = dense(surface, p, integers)
    squares = oracle.least_squares(L, integers.anchors, d, points)
    assert np.abs(squares - x).max() < {"refined": 0.2, "highpass": 0.04}[method] * p.step
    # Without the vectors it is not so: the rows of the anchors have to be given up.
    bare = replace(integers, cells=NO_CELLS, units=NONE)
    L, d, points, through = dense(surface, p, bare)
    without = oracle.least_squares(L, integers.anchors, d, points)
    assert rms(without - through) > 1.5 * rms(squares - x)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ROUGH)
def test_anchors_are_no_spikes(name: str, method: str) -> None:
    surface, V, p, integers = contents(encoded(name, method))
    L, *_, x = dense(surface, p, integers)
    error = L @ (x - V)
    at = np.isin(np.arange(len(V)), integers.anchors)
    assert rms(error[at]) < 2 * rms(error[~at])


@pytest.mark.parametrize("solution", ["interpolated", "least-squares"])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ROUGH)
def test_a_fit_errs_less_than_none(name: str, method: str, solution: str) -> None:
    """Than anchors at the vertices' own positions."""
    options = {"anchors": 20, "solution": solution, "anchor_method": "farthest"}
    surface, V, p, integers = contents(encoded(name, method, **options))
    assert p.interpolated == (solution == "interpolated")
    plain, bare = positions.placed(V[integers.anchors], V, np.zeros((0, 3)), p, integers)
    bare = replace(bare, cells=NO_CELLS, units=NONE)
    coder, systems = geometry_codec(method), Systems(surface)
    fitted, copied = (
        coder.reconstruct(surface, *one, systems) for one in ((p, integers), (plain, bare))
    )
    assert rms(fitted - V) < 0.95 * rms(copied - V)


@pytest.mark.parametrize("method", METHODS)
def test_a_component_of_one_anchor_has_no_vector(method: str) -> None:
    one = encoded("two", method, anchors=2)
    assert "CELL" not in one.container.sections
    assert one.container.parameters.interpolated
    surface, _, _, integers = contents(encoded("two", method, anchors=3))
    stages = 2 if method == "refined" else 1
    assert integers.cells.shape == (stages, 2, 3)
    owners = surface.labels[integers.anchors]
    np.testing.assert_array_equal(
        Cells(surface.graph, surface.labels, integers.anchors).shared,
        np.flatnonzero(np.bincount(owners)[owners] > 1),
    )


@pytest.mark.parametrize("method", METHODS)
def test_steps_by_vertex(method: str) -> None:
    V, F = ROUGH["two"]
    surface = surface_of(F, len(V), 0)
    each = stepped.across(surface, V).astype(np.uint8)
    settings = Settings(
        method, step=0.05, anchors=15, exponents=bytes(each), interpolated=True, coarse=4.0
    )
    coder, systems = geometry_codec(method), Systems(surface)
    p, integers, found = coder.quantize(surface, V, np.zeros((0, 3)), settings, systems)
    assert len(set(integers.exponents.tolist())) > 3
    assert integers.cells.any()
    payloads = coder.encode(surface, p, integers)
    sections = {name: Section(name, 0, payload) for name, payload in payloads.items()}
    read = coder.decode(surface, p, sections)
    for name, array in vars(integers).items():
        np.testing.assert_array_equal(getattr(read, name), array, err_msg=name)
    *_, expected = dense(surface, p, integers)
    allowed = tolerances_of_points(found, surface, p, integers)
    assert (np.abs(found - expected) <= allowed).all()
    again = coder.reconstruct(surface, p, read, Systems(surface))
    assert (np.abs(again - expected) <= allowed).all()


@pytest.mark.parametrize("method", METHODS)
def test_scale_and_place_change_no_integer(method: str) -> None:
    V, F = ROUGH["torus"]
    V = np.rint(V * 2**20) / 2**20
    found = []
    for scale, shift in ((1.0, 0.0), (2.0**-30, 0.0), (2.0**9, 64.0)):
        surface = surface_of(F, len(V), 0)
        settings = Settings(method, step=0.02 * scale, anchors=12, interpolated=True, coarse=4.0)
        moved = (V + np.array([shift, 0, -shift])) * scale
        coder = geometry_codec(method)
        found.append(
            coder.quantize(surface, moved, np.zeros((0, 3)), settings, Systems(surface))[1]
        )
    for other in found[1:]:
        for name in ("values", "anchors", "units"):
            np.testing.assert_array_equal(getattr(other, name), getattr(found[0], name))
        # What is rounded of solutions may be at the edge between two numbers.
        for name in ("cells", "positions", "refinements"):
            one, two = getattr(found[0], name), getattr(other, name)
            assert np.abs(one - two).max(initial=0) <= 1
            assert (one != two).mean() < 0.01 if one.size else True


@pytest.mark.parametrize("method", METHODS)
def test_the_same_again_to_the_last_byte(method: str) -> None:
    one, two, three = (encoded("torus", method, threads=k) for k in (1, 1, 2))
    assert one.data == two.data == three.data


def test_vectors_that_are_too_large_are_refused() -> None:
    V, F = ROUGH["sphere"]
    surface = surface_of(F, len(V), 0)
    settings = Settings("highpass", step=0.02, anchors=12, interpolated=True)
    none, systems = np.zeros((0, 3)), Systems(surface)
    p, integers, _ = highpass.quantize(surface, V, none, settings, systems)
    cells = systems.cells(integers.anchors)
    y = np.full((12, 3), 1e9)
    with pytest.raises(MeshError, match=r"step of .* is too small"):
        positions.with_vectors(y, p, integers, cells, -1)
    nothing = positions.with_vectors(0 * y, p, replace(integers, cells=NO_CELLS), cells, -1)
    assert len(nothing.cells) == len(nothing.units) == 0


def test_by_how_much_positions_may_differ() -> None:
    plain = Parameters("highpass", anchor_method="farthest", step=0.01)
    assert positions.doubt(plain) == 0
    solved = replace(plain, interpolated=True, anchor_count=1)
    assert positions.doubt(solved) == pytest.approx(3**0.5 * 1e-5)
    assert positions.doubt(replace(solved, anchor_count=0)) == 0
    one = encoded("torus", "refined").draft.chosen
    assert one.measured.doubt == positions.doubt(one.parameters) > 0


def test_what_is_made_for_anchors_is_remembered() -> None:
    surface = surface_of(ROUGH["sphere"][1], len(ROUGH["sphere"][0]), 0)
    systems, one, two = Systems(surface), np.array([3, 5]), np.array([3, 6])
    kept = systems.cells, systems.interpolation, systems.fit
    for make in (*kept, systems.least_squares, systems.of_choice):
        first = make(one)
        assert make(one.copy()) is first
        assert make(two) is not first
    finer = systems.to_precision(0.1)
    assert (systems.precision, finer.precision) == (1, 0.1)
    assert finer.cells(two) is systems.cells(two)
    np.testing.assert_array_equal(systems.cells(one).anchors, one)
    assert systems.interpolation(one).cells is systems.cells(one)
