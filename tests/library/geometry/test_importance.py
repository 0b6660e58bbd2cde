"""Importance of vertices: steps that follow it, bounds that hold where it is 1."""

from __future__ import annotations

import meshes
import numpy as np
import pytest

import deltamesh
from deltamesh._geometry.importance import (
    MOST,
    SLOPE,
    coarser,
    holding,
    importance_of,
    important,
    largest_distances,
    of_points,
    without_bits,
)
from deltamesh._geometry.steps import chosen
from deltamesh._measures.measure import errors_by_importance
from deltamesh._options import Options, Settings
from deltamesh._pipeline.decoder import read_content
from deltamesh._pipeline.encoder import Encoded, encode_mesh
from deltamesh._shape.surface import surface_of
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.regions import regions_of
from deltamesh_formats.errors import MeshError, OptionError
from deltamesh_formats.polymesh.mesh import PolyMesh

V, F = meshes.torus(40, 30)
V = V + 0.01 * np.random.default_rng(11).normal(size=V.shape)
LEFT = V[:, 0] < 0.2
MESH = deltamesh.from_arrays(V, F)
SURFACE = surface_of(F, len(V), 0)


def encoded(importance: object, mesh: PolyMesh = MESH, **options: object) -> Encoded:
    return encode_mesh(mesh, Options(importance=importance, **options))


def inside_and_outside(made: Encoded, importance: np.ndarray) -> tuple[object, object]:
    faces = np.asarray(made.mesh.triangulation().faces)
    order = made.order
    return errors_by_importance(V[order], faces, made.mesh.vertices, importance[order])


# ---- The map -------------------------------------------------------------------------------------


def test_a_map_is_an_array_or_an_attribute() -> None:
    given = np.linspace(0, 1, len(V))
    mesh = deltamesh.from_arrays(V, F, vertex={"quality": given.astype(np.float32)})
    np.testing.assert_array_equal(importance_of(MESH, given), given)
    np.testing.assert_array_equal(importance_of(MESH, given[:, None]), given)
    np.testing.assert_array_equal(importance_of(mesh, "quality"), given.astype(np.float32))
    assert importance_of(MESH, LEFT).sum() == LEFT.sum()
    assert encoded("quality", mesh, quality=3).mesh.vertex_data["quality"].shape == (len(V),)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (np.where(np.arange(len(V)) == 17, np.nan, 1.0), "importance nan of vertex 17 is not in 0"),
        (np.where(np.arange(len(V)) == 3, -0.5, 1.0), "-0.5 of vertex 3 .* run from -0.5 to 1"),
        (np.linspace(0, 250, len(V)), "vertex 5 is not in 0..1: values run from 0 to 250"),
        (np.zeros(len(V)), "no vertex has an importance above 0"),
    ],
)
def test_numbers_out_of_range_are_refused_with_their_vertex(wrong: object, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        deltamesh.encode(MESH, importance=wrong)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ("quality", "no attribute 'quality' of one number for each vertex .*: heat"),
        ("pair", "no attribute 'pair'"),
        (np.ones(4), r"shape \(4,\), not \(1200,\)"),
        (np.ones((len(V), 2)), r"shape \(1200, 2\)"),
        (np.full(len(V), "1"), "real numbers, not <U1"),
    ],
)
def test_what_is_no_map_is_refused(wrong: object, message: str) -> None:
    mesh = deltamesh.from_arrays(V, F, vertex={"heat": V[:, 0], "pair": V[:, :2]})
    with pytest.raises(OptionError, match=message):
        deltamesh.encode(mesh, importance=wrong)


@pytest.mark.parametrize("options", [{"method": "lossless"}, {"method": "highpass", "bits": 0}])
def test_it_means_nothing_where_nothing_is_rounded(options: dict[str, object]) -> None:
    with pytest.raises(OptionError, match="importance means nothing"):
        deltamesh.encode(MESH, importance=np.ones(len(V)), **options)


def test_a_point_has_the_largest_importance_of_its_vertices() -> None:
    found = of_points(np.array([0.5, 0.25, 1.0, 0.125]), np.array([1, 0, 1, -1]), 3)
    assert found.tolist() == [0.25, 1.0, 0.0]


# ---- Levels --------------------------------------------------------------------------------------


def test_steps_are_never_coarser_than_asked_and_grow_by_a_slope() -> None:
    importance = np.where(LEFT, 2.0**-9, np.random.default_rng(1).choice([1, 0.3, 0.5], len(V)))
    levels, none = coarser(SURFACE, importance)
    level = np.frombuffer(levels, dtype=np.uint8).astype(int)
    assert none == b""
    assert (level / 4 <= -np.log2(importance)).all()
    indptr, head = SURFACE.graph
    tail = np.repeat(np.arange(len(V)), np.diff(indptr))
    assert (level[head] - level[tail] <= SLOPE).all()
    assert level.max() > 16
    # Nor are they finer than they have to be: each is what is asked, or next to what holds it back.
    held = np.full(len(V), MOST)
    np.minimum.at(held, tail, level[head] + SLOPE)
    asked = 4 * np.floor(-np.log2(importance))
    np.testing.assert_array_equal(level, np.minimum(asked, held))


def test_maps_of_few_values() -> None:
    assert coarser(SURFACE, np.ones(len(V))) == (b"", b"")
    assert coarser(SURFACE, np.full(len(V), 0.5)) == (b"", b"")
    levels, none = coarser(SURFACE, np.where(LEFT, 0.0, 1.0))
    assert levels == b""
    np.testing.assert_array_equal(np.frombuffer(none, dtype=bool), LEFT)
    levels, _ = coarser(SURFACE, np.where(LEFT, 1e-300, 1.0))
    assert np.frombuffer(levels, dtype=np.uint8).max() <= MOST


def test_a_step_is_that_of_importance_1() -> None:
    settings = Settings("highpass", step=0.01, coarser=bytes([0, 4, 8]), exponents=bytes([2, 2, 0]))
    three = surface_of(np.array([[0, 1, 2]]), 3, 0)
    step, exponents = chosen(settings, three, 0.01)
    np.testing.assert_allclose(
        step * 2.0 ** (-exponents / 4), 0.01 * 2.0 ** (np.array([-2, 2, 8]) / 4)
    )
    assert chosen(Settings("highpass"), three, 0.01)[0] == 0.01
    assert len(chosen(settings, three, 0.0)[1]) == 0
    for wrong in (bytes([1, 2, 3]), bytes(2), bytes([0, 1, 121])):
        for name in ("coarser", "exponents"):
            with pytest.raises(ValueError, match="exponents of"):
                chosen(Settings("highpass", **{name: wrong}), three, 0.01)


def test_distances_are_allowed_by_importance() -> None:
    settings = Settings("highpass", largest=0.5, coarser=bytes([0, 4, 8]), no_bits=bytes([0, 0, 1]))
    assert list(largest_distances(settings)) == [0.5, 1.0, np.inf]
    assert largest_distances(Settings("highpass", largest=0.5)) == 0.5
    assert without_bits(Settings("highpass")) is None


def test_settings_without_importance_stay() -> None:
    settings = Settings("refined", interpolated=True)
    assert important(SURFACE, None, settings, None) is settings
    assert important(SURFACE, np.ones(len(V)), settings, None) == settings


def test_rings_around() -> None:
    """All vertices beside those without bits, and the one that is the furthest inside."""
    found = holding(SURFACE, LEFT, interpolated=True)
    indptr, head = SURFACE.graph
    near = {i: set(head[indptr[i] : indptr[i + 1]].tolist()) for i in range(len(V))}
    rest = set(np.flatnonzero(~LEFT).tolist())
    beside = {i for i in rest if near[i] - rest}
    (inner,) = set(found.tolist()) - beside
    assert beside < set(found.tolist())
    shells = [rest]
    while len(reached := set().union(*shells)) < len(V):
        shells.append({i for i in range(len(V)) if i not in reached and near[i] & reached})
    assert inner == min(shells[-1])
    assert set(found.tolist()) < set(holding(SURFACE, LEFT, interpolated=False).tolist())


# ---- Files ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["refined", "highpass", "auto"])
@pytest.mark.parametrize("outside", [0.125, 0.0])
def test_bounds_hold_where_importance_is_1(method: str, outside: float) -> None:
    V, F = meshes.torus(120, 90)
    V = V + 0.003 * np.random.default_rng(2).normal(size=V.shape)
    mesh, importance = deltamesh.from_arrays(V, F), np.where(V[:, 0] < 0.8, outside, 1.0)
    made, uniform = encoded(importance, mesh, method=method), encoded(None, mesh, method=method)
    faces, order = np.asarray(made.mesh.triangulation().faces), made.order
    W = made.mesh.vertices
    full, reduced = errors_by_importance(V[order], faces, W, importance[order])
    assert full.normal_deviation <= 1.0
    assert full.rms <= 1.5e-3 * made.container.meta.diagonal
    assert reduced.normal_deviation > 2
    assert len(made.data) < 0.8 * len(uniform.data)
    assert made.draft.cost.error <= made.draft.cost.bound


def test_bounds_are_divided_by_the_importance() -> None:
    """No vertex moves further than the largest distance over its importance."""
    importance = np.clip(0.5 + V[:, 0], 0.1, 1.0)
    largest = 4e-3
    made = encoded(importance, method="refined", max_error=largest, normal_error=3.0)
    moved = np.linalg.norm(made.mesh.vertices - V[made.order], axis=1)
    assert (moved * importance[made.order] <= largest).all()
    assert (moved > largest).any()


def test_a_rate_has_its_step_where_importance_is_1() -> None:
    importance = np.where(LEFT, 0.25, 1.0)
    made = encoded(importance, method="highpass", step=0.01)
    content = read_content(made.container, 10**9, 2**40)
    steps = made.container.parameters.step * 2.0 ** (-content.integers.exponents / 4)
    of_vertex = importance[made.order]
    np.testing.assert_allclose(steps[of_vertex == 1], 0.01)
    assert (steps <= 0.01 / of_vertex * (1 + 1e-12)).all()
    assert steps.max() == pytest.approx(0.04)
    bits = encoded(importance, method="highpass", bits=7)
    plain = encoded(None, method="highpass", bits=7)
    finest = bits.container.parameters.step * 2.0**-2
    assert finest == pytest.approx(plain.container.parameters.step)


@pytest.mark.parametrize("method", ["refined", "highpass"])
@pytest.mark.parametrize("solution", [None, "least-squares"])
def test_no_importance_takes_no_bits(method: str, solution: str | None) -> None:
    importance = np.where(LEFT, 0.0, 1.0)
    made = encoded(importance, method=method, step=1e-3, solution=solution)
    integers = read_content(made.container, 10**9, 2**40).integers
    none = LEFT[made.order]
    assert not integers.values[none].any()
    assert integers.values[~none].any(axis=1).mean() > 0.5
    assert not integers.refinements[none[: len(integers.refinements)]].any()
    assert made.container.parameters.anchor_method == "greedy"
    assert made.container.parameters.interpolated == (solution is None)
    found = regions_of(made.container)
    assert (found.full, found.reduced, found.none) == ((~LEFT).sum(), 0, LEFT.sum())
    if solution is None:  # what has no bits does not move the rest, however it is
        assert found.rms_full < 1.5e-3
        assert found.normal_full < 1.0
        assert found.rms_reduced > 10 * found.rms_full


def test_what_is_important_comes_as_near_as_steps_are_fine() -> None:
    importance = np.where(LEFT, 0.0, 1.0)
    far = [
        regions_of(encoded(importance, method="refined", step=step).container).rms_full
        for step in (1e-3, 1e-4, 1e-5)
    ]
    assert far[0] > 5 * far[1] > 25 * far[2]


def test_what_a_file_tells_is_not_weighted_but_both_regions_are() -> None:
    importance = np.where(LEFT, 0.125, 1.0)
    made = encoded(importance)
    meta, found = made.container.meta, regions_of(made.container)
    moved = np.linalg.norm(made.mesh.vertices - V[made.order], axis=1)
    assert meta.max == pytest.approx(moved.max(), rel=1e-6)
    assert meta.rms == pytest.approx(np.sqrt((moved**2).mean()), rel=1e-6)
    full, reduced = inside_and_outside(made, importance)
    for name, field in (("rms", "rms"), ("max", "max"), ("normal", "normal_deviation")):
        assert getattr(found, f"{name}_full") == pytest.approx(getattr(full, field), rel=1e-6)
        assert getattr(found, f"{name}_reduced") == pytest.approx(getattr(reduced, field), rel=1e-6)
    assert regions_of(encoded(None).container) is None


def test_components_and_parts() -> None:
    """Important ones keep the bounds of parts; others have steps of their own."""
    small = 0.02 * V + [3, 0, 0]
    both = deltamesh.from_arrays(np.concatenate([V, small]), np.concatenate([F, F + len(V)]))
    importance = np.concatenate([np.full(len(V), 0.125), np.ones(len(V))])
    for method in ("auto", "cartesian"):
        made, plain = encoded(importance, both, method=method), encoded(None, both, method=method)
        assert len(made.data) < len(plain.data)
        found = regions_of(made.container)
        extent = np.linalg.norm(np.ptp(small, axis=0))
        assert found.normal_full <= 1.0
        assert found.rms_full <= 1.5e-3 * extent


def container_of(data: bytes) -> Container:
    return deltamesh.info(data)


def test_the_same_map_makes_the_same_bytes_and_none_makes_those_of_before() -> None:
    importance = np.where(LEFT, 0.25, 1.0)
    assert encoded(importance).data == encoded(importance.tolist()).data
    bare = encoded(None).data
    ones = encoded(np.ones(len(V))).data
    sections = container_of(ones).sections
    assert {*sections} - {*container_of(bare).sections} == {"regs"}
    assert all(
        bytes(one.payload) == bytes(sections[name].payload)
        for name, one in container_of(bare).sections.items()
    )
