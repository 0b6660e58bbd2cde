"""The search for a step of each component: what it asks for, and what it makes of the answers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import meshes
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from deltamesh import TargetError, decode
from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.part_search import (
    NEAREST,
    Components,
    Steps,
    components_of,
    steps_near,
    with_nearer_base,
)
from deltamesh._geometry.search import smallest
from deltamesh._geometry.trial import Trial
from deltamesh._graph.adjacency import components_of_faces
from deltamesh._measures.measure import Measure, Measured
from deltamesh._measures.metrics import VertexErrors
from deltamesh._measures.parts import PartErrors, parts_of
from deltamesh._options import Options, Settings, settings_of
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh_formats.container.container import Parameters
from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh.mesh import from_triangles

SIZES = np.array([300, 40, 40, 100])
OF_VERTEX = np.repeat(np.arange(len(SIZES)), SIZES)
PARTS = np.arange(len(SIZES))


@dataclass
class Model:
    """Answers a search by laws: the error of a part grows with its step, its bits fall with it."""

    error: object
    asked: list

    def __call__(self, settings: Settings) -> Trial:
        self.asked.append(settings)
        exponents = np.frombuffer(settings.exponents, dtype=np.uint8).astype(float)
        exponents = exponents if len(exponents) else np.zeros(len(OF_VERTEX))
        steps = settings.step * 2.0 ** (-exponents / 4)
        part_steps = steps[np.cumsum(SIZES) - 1]
        angle = np.asarray(self.error(part_steps), dtype=float)
        zero, one = np.zeros(len(SIZES)), np.ones(len(SIZES))
        mean = float(angle @ SIZES / SIZES.sum())
        whole = VertexErrors(rms=0.0, max=0.0, normal_deviation=mean, dihedral=0.0)
        measured = Measured(whole, PartErrors(zero, zero, angle, zero, one))
        size = float(np.sum(40 - 3 * np.log2(steps))) / 8 + 10 * len(np.unique(exponents))
        parameters = Parameters(
            settings.method, True, None, None, settings.step, (0, 0, 0), 0, 0, 4, 0
        )
        write = {"DATA": bytes(max(int(size), 0))}.copy
        return Trial(settings, parameters, None, write, np.zeros((SIZES.sum(), 3)), measured)


BOUNDS = Bounds(normal_deviation=1.0, part_normal=1.0)


def search(error, edge, **options):
    components = Components(OF_VERTEX, np.asarray(edge, dtype=float), np.ones(4), PARTS, PARTS)
    model = Model(error, [])
    found = smallest(Options(method="cartesian", **options), BOUNDS, components, model)
    return found, model.asked


@given(
    st.lists(st.floats(-13, 13), min_size=4, max_size=4),
    st.floats(0.5, 1.2),
    st.integers(1, 3),
)
def test_every_part_is_near_its_bound(octaves, power, effort):
    scale = 2.0 ** np.array(octaves)
    found, asked = search(lambda steps: (steps * scale) ** power, 1 / scale, effort=effort)
    share = found.measured.parts.normal_deviation
    assert share.max() <= 1
    if len(set(found.settings.exponents)) > 2:
        assert (share > (0.3 if effort == 1 else 0.5)).all()
    assert len(asked) < 40


def test_a_wrong_beginning_is_put_right():
    scale = np.array([1.0, 2**-9, 2**9, 2**3])
    found, _ = search(lambda steps: steps * scale, np.ones(4))
    share = found.measured.parts.normal_deviation
    assert share.max() <= 1 < 3 * share.min()


def test_parts_that_need_nearly_the_same_get_the_same():
    scale = np.array([1.0, 1.1, 0.95, 1.05])
    found, _ = search(lambda steps: steps * scale, 1 / scale)
    assert found.settings.exponents == b""
    assert 0.8 < found.measured.parts.normal_deviation.max() <= 1


def test_parts_that_need_nearly_the_same_share_a_step_beside_others():
    scale = np.array([1.0, 80.0, 96.0, 110.0])
    found, _ = search(lambda steps: steps * scale, 1 / scale)
    assert len(set(found.settings.exponents)) == 2
    share = found.measured.parts.normal_deviation
    assert (share <= 1).all()
    assert (share > 0.55).all()


@pytest.mark.parametrize("share", [0.8, 0.85, 0.9, 0.96, 1.0])
def test_the_largest_component_comes_nearer_by_another_base(share):
    scale, level = np.array([1.0, 8.0, 16.0, 32.0]), np.array([0, 12, 18, 20])
    others = np.array([0, 1, 1, 1]) * 2.0 ** (level / 4) * [0, 0.5, 0.97, 0.99]
    model = Model(lambda steps: np.where(PARTS == 0, share, others) * steps, [])
    components = Components(OF_VERTEX, 1 / scale, np.ones(4), PARTS, PARTS)
    settings = settings_of(Options(method="cartesian"), "cartesian")
    first = model(components.settings(settings, Steps(1.0, level)))
    found, steps = with_nearer_base(settings, BOUNDS, (first, Steps(1.0, level)), components, model)
    shares = found.measured.parts.normal_deviation
    assert shares.max() <= 1
    if share > 0.95:  # too little to be had
        assert found is first
        return
    assert found.size < first.size
    assert shares[0] == pytest.approx(NEAREST)
    assert steps.base == pytest.approx(NEAREST / share)
    finer = math.ceil(4 * math.log2(NEAREST / share))
    assert steps.level.tolist() == [0, 12, 18 + finer, 20 + finer]


def test_what_is_within_the_bounds_counts_where_a_search_is_given_up():
    """The first trial is within the bounds, and many steps of their own cost more."""
    V, F = meshes.union(
        *(
            (0.01 * V + at, F)
            for at in np.random.default_rng(1).uniform(-9, 9, (40, 3))
            for V, F in [meshes.tetrahedron()]
        ),
    )
    mesh = from_triangles(V, F)
    auto, cartesian = (
        len(encode_mesh(mesh, Options(method=m, quality=5)).data) for m in ("auto", "cartesian")
    )
    assert auto <= cartesian


def test_a_part_that_cannot_be_kept_is_named():
    def error(steps):
        return np.where(PARTS == 2, 7.0, steps)

    with pytest.raises(TargetError, match=r"normal deviation 1 cannot be met in 2: .* is 7"):
        search(error, np.ones(4), quality=5)


def test_a_step_that_is_too_small_for_the_mesh_ends_the_search():
    def error(steps):
        if steps.min() < 1e-3:
            raise MeshError("too small")
        return np.where(PARTS == 1, 1e4 * steps, steps)

    with pytest.raises(TargetError, match="cannot be met in 1"):
        search(error, np.ones(4), quality=5)


def test_steps_further_apart_than_exponents_tell_are_as_fine_as_the_finest_needs():
    scale = 2.0 ** np.array([0.0, 0.0, 16.0, -18.0])
    found, _ = search(lambda steps: steps * scale, 1 / scale)
    share = found.measured.parts.normal_deviation
    assert (share <= 1).all()
    assert share[2] > 0.5
    assert max(found.settings.exponents) == 120


def test_steps_near_are_within_an_eighth_of_an_octave():
    wanted = np.array([3.0, 0.2, 1e-5, 2.9])
    steps = steps_near(wanted)
    found = steps.base * 2.0 ** (-steps.level / 4)
    assert (np.abs(np.log2(found / wanted)) <= 1 / 8 + 1e-12).all()
    assert (steps.coarsest, steps.finest) == (3.0, pytest.approx(found.min()))


def test_objects_within_a_component_hold_it_back():
    V, F = meshes.union(meshes.grid(6, 6), meshes.tetrahedron())
    component = components_of_faces(F, len(V))
    objects = np.where(np.arange(len(F)) < 3, 0, 1)
    parts = parts_of(F, component, [objects])
    components = components_of(V, F, parts, Measure(V, F, parts).diagonals)
    assert (parts.components, parts.count) == (2, 4)
    # Object 1 is the rest of the grid, and the tetrahedron.
    of_parts = np.array([0.1, 0.2, 5.0, 0.3])
    assert components.excess(of_parts).tolist() == [5.0, 0.3]


def random_scene(rng):
    kinds = [meshes.icosphere(1), meshes.torus(8, 6), meshes.grid(6, 5), meshes.tetrahedron()]
    chosen = [kinds[i] for i in rng.integers(len(kinds), size=rng.integers(2, 5))]
    size = [10.0 ** rng.uniform(-5, 1) for _ in chosen]
    moved = [(s * V + rng.uniform(-20, 20, 3), F) for s, (V, F) in zip(size, chosen, strict=True)]
    return meshes.union(*moved)


@pytest.mark.parametrize("method", ["auto", "refined", "highpass", "cartesian"])
@given(st.integers(0, 2**32 - 1))
@settings(max_examples=6)
def test_every_part_of_any_scene_keeps_the_quality(method, seed):
    rng = np.random.default_rng(seed)
    V, F = random_scene(rng)
    quality = int(rng.integers(3, 8))
    one = encode_mesh(from_triangles(V, F), Options(method=method, quality=quality))
    W = np.empty_like(V)
    W[one.order] = decode(one.data).vertices
    parts = parts_of(F, components_of_faces(F, len(V)))
    found = Measure(V, F, parts)(W).parts
    factor = 2 ** ((5 - quality) / 2)
    assert found.normal_deviation.max() <= factor
    assert found.relative_rms.max() <= 1.5e-3 * factor * (1 + 1e-6)
    meta = one.container.meta
    assert meta.parts == parts.count
    worst = max(meta.part_normal, meta.part_rms / 1.5e-3)
    expected = np.maximum(found.normal_deviation, found.relative_rms / 1.5e-3).max()
    assert math.isclose(worst, expected, rel_tol=1e-3)
