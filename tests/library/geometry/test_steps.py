"""Steps by vertex: exponents, to a payload and back, and what positions make of them."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import polygon_meshes
import pytest
import second_opinion
import stepped
import strategies
from graphs import tolerances_of, tolerances_of_points
from hypothesis import given
from hypothesis import strategies as st
from payloads import SURFACE, read_or_refused, section_of

from deltamesh import decode
from deltamesh._geometry import steps
from deltamesh._geometry.integers import Integers
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.systems import Systems
from deltamesh._measures.metrics import diagonal
from deltamesh._options import Options, Settings
from deltamesh._shape.surface import surface_of
from deltamesh_formats.container.container import Parameters, Section
from deltamesh_formats.container.payload_layout import MAX_EXPONENT
from deltamesh_formats.errors import FormatError, MeshError
from deltamesh_formats.polymesh.mesh import from_triangles

PARAMETERS = Parameters("highpass", anchor_method="farthest", step=0.01, isolated=3)
CARTESIAN = Parameters("cartesian", step=0.01, isolated=3)
# By how many of its own steps a delta may be rounded; without diffusion, with dead zones, along the
# surface and across it.
LARGEST_ROUNDING = {"highpass": 0.5 * 3**0.5, "refined": 0.65 * 8 * 3**0.5 + 0.6}

# As fine as the steps of these meshes can be.
some_exponents = st.lists(st.integers(0, 48), min_size=1, max_size=9)
PARTS = [name for name, *_, exponents, _ in stepped.golden() if exponents is not stepped.across]


def surface_and_positions(mesh: meshes.Arrays):
    """The surface of the vertices that faces use, their positions, and two isolated vertices."""
    V, F = mesh
    used, numbered = np.unique(F, return_inverse=True)
    surface = surface_of(numbered.reshape(-1, 3), len(used), 2)
    return surface, V[used], np.array([[-1.0, 0, 0], [0.5, 7, 1]])


def written(surface, V, isolated, settings):
    """Parameters, integers and positions of an encoder, and what is read of its payloads."""
    coder, systems = geometry_codec(settings.method), Systems(surface)
    parameters, integers, positions = coder.quantize(surface, V, isolated, settings, systems)
    payloads = coder.encode(surface, parameters, integers)
    sections = {name: Section(name, 0, payload) for name, payload in payloads.items()}
    read = coder.decode(surface, parameters, sections)
    for name, array in vars(integers).items():
        np.testing.assert_array_equal(getattr(read, name), array, err_msg=name)
    again = coder.reconstruct(surface, parameters, read, systems)
    if settings.interpolated:  # an encoder starts its iterations elsewhere
        allowed = tolerances_of_points(positions, surface, parameters, integers)
        assert (np.abs(again - positions) <= allowed).all()
    else:
        np.testing.assert_array_equal(again, positions)
    return parameters, integers, positions, payloads


def test_ratios_are_quarters_of_an_octave() -> None:
    expected = 2.0 ** (-np.arange(MAX_EXPONENT + 1) / 4)
    np.testing.assert_allclose(steps.RATIOS, expected, rtol=1e-15)
    np.testing.assert_array_equal(steps.RATIOS[::4], 0.5 ** np.arange(31))
    extra = steps.extra_bits(np.arange(MAX_EXPONENT + 1), MAX_EXPONENT + 2)
    assert extra[:6].tolist() == [0, 1, 1, 1, 1, 2]
    assert extra[-2:].tolist() == [30, 0]
    assert (steps.RATIOS * 2.0 ** extra[:-1] >= 1).all()


@strategies.SOME
@given(
    strategies.surfaces(),
    some_exponents,
    st.sampled_from(["highpass", "refined"]),
    st.sampled_from(["farthest", "random", "greedy"]),
    st.sampled_from([1e-3, 0.03]),
    st.booleans(),
)
def test_solved_positions_round_trip(
    mesh: meshes.Arrays,
    exponents: list[int],
    method: str,
    anchor_method: str,
    step: float,
    interpolated: bool,
) -> None:
    """With every vertex an anchor, no error is larger than all roundings of both together."""
    surface, V, isolated = surface_and_positions(mesh)
    each = np.resize([0, *exponents], len(V)).astype(np.uint8)
    settings = Settings(
        method,
        step=step,
        diffusion=False,
        anchors=len(V),
        anchor_method=anchor_method,
        exponents=bytes(each),
        interpolated=interpolated,
    )
    parameters, integers, positions, payloads = written(surface, V, isolated, settings)
    assert ("STEP" in payloads) == bool(any(each))
    np.testing.assert_array_equal(integers.exponents, each if any(each) else [])
    r = 2.0 ** (-each / 4)
    delta = LARGEST_ROUNDING[method] * step * r
    anchors = 0.5 * 3**0.5 * parameters.anchor_step * r[integers.anchors]
    bound = np.sqrt((delta**2).sum() + (anchors**2).sum())
    assert np.sqrt(((positions[: len(V)] - V) ** 2).sum()) <= 1.001 * bound + 1e-9 * diagonal(V)
    assert np.abs(positions[len(V) :] - isolated).max() <= 0.501 * parameters.anchor_step


@strategies.SOME
@given(strategies.surfaces(), some_exponents, st.sampled_from([1e-3, 0.1]))
def test_grid_points_round_trip(mesh: meshes.Arrays, exponents: list[int], step: float) -> None:
    """Every component is on a grid as fine as any of its vertices asks for."""
    surface, V, isolated = surface_and_positions(mesh)
    each = np.resize([0, *exponents], len(V))
    settings = Settings("cartesian", step=step, exponents=bytes(each.astype(np.uint8)))
    parameters, _, positions, payloads = written(surface, V, isolated, settings)
    finest = np.array([each[surface.labels == k].max() for k in range(surface.labels.max() + 1)])
    r = 2.0 ** (-finest[surface.labels] / 4)
    assert ("STEP" in payloads) == (len(set(finest.tolist())) > 1)
    assert parameters.step == pytest.approx(step * 2.0 ** (-finest.min() / 4), rel=1e-15)
    error = np.abs(positions - np.concatenate([V, isolated]))
    assert (error[: len(V)] <= 0.5001 * step * r[:, None] + 1e-14).all()
    assert (error[len(V) :] <= 0.5001 * parameters.step + 1e-14).all()


@pytest.mark.parametrize("name", PARTS)
def test_each_part_is_as_good_as_its_steps(name: str) -> None:
    """Parts of a ten millionth of the scene keep their shape, where the steps follow the sizes."""
    encoded = stepped.file_of(name)
    V, W = encoded.draft.positions, encoded.draft.chosen.vertices
    integers, surface = encoded.draft.chosen.integers, encoded.draft.content.structure.surface
    assert len(integers.exponents) == surface.vertex_count
    for k in range(surface.labels.max() + 1):
        part = np.flatnonzero(surface.labels == k)
        rms = np.sqrt(((V - W)[part] ** 2).sum(axis=1).mean())
        assert rms <= 0.04 * diagonal(V[part])


@pytest.mark.parametrize("name", [row[0] for row in stepped.golden()])
def test_solvers_agree_in_every_part(name: str) -> None:
    data = stepped.file_of(name).data
    one, two = (decode(data, solver=solver) for solver in ("scipy", "auto"))
    error = np.abs(one.vertices - two.vertices)
    assert (error <= tolerances_of(data, one)).all()


MESHES = {
    "complex": from_triangles(*meshes.union(*meshes.complexes().values())),
    "quads": polygon_meshes.quads(6, 5),
    "mixed": polygon_meshes.mixed(),
}


@pytest.mark.parametrize("method", ["highpass", "refined", "cartesian"])
@pytest.mark.parametrize("name", MESHES)
def test_points_and_polygons_by_a_second_opinion(name: str, method: str) -> None:
    """Exponents are those of points, and their graph is the one of the deltas."""
    options = Options(method=method, step=0.05)

    def exponents(surface, V):
        return stepped.across(surface, V) if method != "cartesian" else surface.labels % 7

    encoded = stepped.restepped(MESHES[name], options, exponents)
    several = encoded.draft.content.structure.surface.labels.max() > 0
    assert ("STEP" in encoded.container.sections) == (method != "cartesian" or several)
    second_opinion.assert_same(encoded.data)


def test_steps_that_are_all_alike_are_none() -> None:
    surface, V, isolated = surface_and_positions(meshes.two_components())
    for method in ("highpass", "refined", "cartesian"):
        plain = written(surface, V, isolated, Settings(method, step=0.01))
        same = Settings(method, step=0.01, exponents=bytes(len(V)))
        assert written(surface, V, isolated, same)[3] == plain[3]
    finer = np.where(np.arange(len(V)) % 2, 4, 0).astype(np.uint8)
    finer = Settings("cartesian", step=0.01, exponents=bytes(finer))
    plain = written(surface, V, isolated, Settings("cartesian", step=0.005))
    assert written(surface, V, isolated, finer)[3] == plain[3]


def test_without_a_step_there_are_no_exponents() -> None:
    surface, V, isolated = surface_and_positions(meshes.torus(7, 5))
    settings = Settings("highpass", bits=0, anchors=9, exponents=bytes([0, 4] * 17 + [1]))
    assert "STEP" not in written(surface, V, isolated, settings)[3]


@pytest.mark.parametrize("exponents", [b"\0\1", b"\1" * 35, b"\0\x79" * 17 + b"\0"])
def test_exponents_that_no_file_has(exponents: bytes) -> None:
    surface, V, isolated = surface_and_positions(meshes.torus(7, 5))
    with pytest.raises(ValueError, match="exponents"):
        written(surface, V, isolated, Settings("highpass", step=0.1, exponents=exponents))


def test_a_part_that_is_too_large_for_its_steps() -> None:
    surface, V, isolated = surface_and_positions(meshes.two_components())
    far = V.copy()
    far[surface.labels == 1] *= 1e4
    each = np.where(surface.labels == 0, 0, MAX_EXPONENT).astype(np.uint8)
    for method in ("highpass", "refined", "cartesian"):
        with pytest.raises(MeshError, match=r"step of .* is too small"):
            written(surface, far, isolated, Settings(method, step=0.5, exponents=bytes(each)))


# ---- Payloads that no encoder has written ------------------------------------------------------


heads = st.lists(st.integers(0, 130), max_size=6).map(lambda e: bytes([len(e), *e]))
labels = st.lists(st.integers(0, 4), min_size=42, max_size=42)


def assert_possible(exponents) -> None:
    assert exponents.shape == (42,)
    assert exponents.min() == 0
    assert 0 < exponents.max() <= MAX_EXPONENT


@given(st.binary(max_size=80) | st.tuples(heads, st.binary(max_size=60)).map(b"".join))
def test_random_steps(payload: bytes) -> None:
    found = read_or_refused(steps.decode, PARAMETERS, STEP=payload)
    if found is not None:
        assert_possible(found)


@given(labels, heads)
def test_labels_of_other_steps(values: list[int], head: bytes) -> None:
    """Labels that are right, of exponents that need not be."""
    exponents = np.array(values)
    payload = steps.encode(SURFACE, exponents)["STEP"]
    count, stream = payload[0], payload[1 + payload[0] :]
    found = read_or_refused(steps.decode, PARAMETERS, STEP=head + stream)
    fits = len(set(head[1:])) == head[0] == count > 1
    fits = fits and max(head[1:]) <= MAX_EXPONENT and min(head[1:]) == 0
    assert (found is not None) == fits
    if fits:
        assert_possible(found)


@given(st.binary(max_size=200))
def test_random_roots(payload: bytes) -> None:
    # Two components: those of one have nothing to differ in.
    surface = surface_of(*_two(), 0)
    each = np.where(surface.labels == 0, 0, 50)
    codec = geometry_codec("cartesian")
    sections = {"CART": section_of("CART", payload)}
    sections["STEP"] = section_of("STEP", steps.encode(surface, each)["STEP"])
    try:
        found = codec.decode(surface, replace(CARTESIAN, isolated=0), sections)
    except FormatError as error:
        assert 50 <= error.offset <= 60 + len(payload)  # noqa: PT017
        return
    assert np.abs(found.values).max() < 2**44


def _two() -> tuple[np.ndarray, int]:
    V, F = meshes.union(meshes.tetrahedron(), meshes.tetrahedron())
    return F, len(V)


@pytest.mark.parametrize("kind", ["highpass", "cartesian"])
def test_steps_within_a_component(kind: str) -> None:
    """Only a Cartesian file has steps by component."""
    each = np.arange(42) % 5
    integers = Integers(np.zeros((45, 3), dtype=np.int64), exponents=each)
    step = section_of("STEP", steps.encode(SURFACE, each)["STEP"])
    if kind == "highpass":
        read = steps.decode(SURFACE, PARAMETERS, {"STEP": step})
        np.testing.assert_array_equal(read, each)
        return
    codec = geometry_codec(kind)
    payload = codec.encode(SURFACE, CARTESIAN, integers)["CART"]
    with pytest.raises(FormatError, match="differ within a component") as caught:
        codec.decode(SURFACE, CARTESIAN, {"STEP": step, "CART": section_of("CART", payload)})
    assert caught.value.offset == step.start


def test_steps_of_0_bits_are_refused() -> None:
    payload = section_of("STEP", b"\2\0\1")
    with pytest.raises(FormatError, match="0 bits"):
        steps.decode(SURFACE, replace(PARAMETERS, step=0.0), {"STEP": payload})
