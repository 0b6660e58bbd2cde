"""Lossless method: every bit comes back, in few bytes, and what is forged is refused."""

from __future__ import annotations

import dataclasses

import forging
import meshes
import numpy as np
import pytest
import spec_decoder
import strategies
from converted_numbers import KINDS, as_single, walk
from exact_numbers import positions
from hypothesis import given, settings
from hypothesis import strategies as st

from deltamesh import decode, encode, info
from deltamesh._geometry import lossless
from deltamesh._geometry.systems import Systems
from deltamesh._mesh import LARGEST
from deltamesh._options import Options
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh._shape.surface import surface_of
from deltamesh._streams import exact as exact_streams
from deltamesh._streams.number_formats import RAW_ONLY
from deltamesh_formats.container.container import Section
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import FormatError, MeshError
from deltamesh_formats.polymesh.mesh import from_triangles

EXACTLY = Options(method="lossless")
TORUS = meshes.torus(7, 6)


def assert_kept(V, F):
    """Encode, decode, and compare with the input, bit for bit."""
    encoded = encode_mesh(from_triangles(V, F), EXACTLY)
    decoded = decode(encoded.data)
    assert decoded.vertices.dtype == np.float64
    assert decoded.vertices.tobytes() == V[encoded.order].tobytes()
    faces = strategies.canonical(encoded.order[decoded.faces])
    assert faces == strategies.canonical(F)
    return encoded


# ---- Round trips -------------------------------------------------------------------------------


@settings(deadline=None)
@given(positions(12))
def test_any_numbers(V: np.ndarray) -> None:
    assert_kept(V, meshes.icosphere(0)[1])


@strategies.SOME
@given(strategies.surfaces(), st.sampled_from(["f8", "f4", "f2"]), st.integers(-1, 12))
def test_any_surface(mesh: meshes.Arrays, kind: str, places: int) -> None:
    V, F = mesh
    kept = V.astype(kind).astype(np.float64)
    shorter = kept if places < 0 else kept.round(places)
    if len(np.unique(shorter.view(np.int64), axis=0)) == len(V):  # else faces may degenerate
        assert_kept(shorter, F)


@pytest.mark.parametrize("scale", [5e-324, 1e-310, 1e-300, 1.0, 3e140])
@pytest.mark.parametrize("digits", [24, 53])
def test_any_scale(scale: float, digits: int) -> None:
    V, F = meshes.icosphere(2)
    V = V.astype(np.float32).astype(np.float64) if digits == 24 else V
    assert_kept(np.rint(V * 1000) * 5e-324 if scale == 5e-324 else V * scale, F)


def test_wild_numbers() -> None:
    for mesh in (TORUS, meshes.with_isolated(), meshes.grid(9, 9)):
        assert_kept(*meshes.wild(mesh))


def test_exponents_as_far_apart_as_can_be() -> None:
    """Differences of indices would not fit 64 bits: such numbers are raw."""
    V, F = meshes.icosphere(2)
    rng = np.random.default_rng(6)
    exponents = rng.integers(-1074, 495, V.shape)
    assert_kept(np.ldexp(1 + rng.random(V.shape), exponents), F)


def test_zeros_of_both_signs_are_two_positions() -> None:
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [-0.0, 1, 0], [1, -0.0, 0], [1, 1, 0]])
    F = np.array([[0, 1, 2], [3, 4, 5]])
    assert "COPY" not in info(assert_kept(V, F).data).sections
    assert "COPY" in info(encode(V, F, method="cartesian")).sections
    assert "COPY" in info(encode(V[[0, 1, 2, 2, 1, 5]], F, method="lossless")).sections


def test_negative_zeros_cost_little() -> None:
    V, F = meshes.grid(40, 40)
    V[:, 2] = 0.0
    plain = len(encode(V, F, method="lossless"))
    assert len(encode(V * [1, 1, -1], F, method="lossless")) < plain + 10
    V[::3, 2] = -0.0
    assert len(encode(V, F, method="lossless")) < plain + len(V) / 7


@strategies.FEW
@given(
    strategies.SMALL,
    st.lists(st.sampled_from([*KINDS, "constant", "noise"]), min_size=3, max_size=3),
    st.sampled_from([0.0, 0.01, 0.3]),
)
def test_converted_numbers(seed: int, kinds: list[str], share: float) -> None:
    """Axes of any kinds, some of the numbers replaced by neighbours, zeros and subnormal ones."""
    V, F = converted_mesh(kinds, seed)
    rng = np.random.default_rng(seed)
    with np.errstate(under="ignore"):
        near = np.nextafter(V.astype("f4"), np.float32(np.inf)).astype("f8")
    other = np.where(rng.random(V.shape) < 0.5, near, rng.choice([-0.0, 5e-324, 2.0**-149]))
    V = np.where(rng.random(V.shape) < share, other, V)
    assert_kept(V, F)


def converted_mesh(kinds, seed):
    """A sphere, every axis of which is made as its kind says."""
    V, F = meshes.icosphere(2)
    columns = []
    for axis, kind in enumerate(kinds):
        decimals = (100 * V[:, axis] + walk(len(V), seed + axis) / 100).round(3)
        if kind in KINDS:
            single, function = KINDS[kind]
            columns.append(function(as_single(decimals) if single else decimals))
        else:
            columns.append(np.full(len(V), 1.1) if kind == "constant" else 0.1 + V[:, axis])
    return np.stack(columns, axis=1), F


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_not_numbers_are_refused_by_index(bad: float) -> None:
    V, F = TORUS[0].copy(), TORUS[1]
    V[17, 1] = bad
    with pytest.raises(MeshError, match="vertex 17 is not finite"):
        encode(V, F, method="lossless")


@pytest.mark.parametrize(
    "name",
    meshes.large_are_slow(
        ["unstated/horse.ply", "unstated/fandisk.obj", "clean/featuretype.ply", "clean/spot.obj"]
    ),
)
def test_real_mesh(name: str) -> None:
    mesh = meshes.real(name)
    encoded = assert_kept(mesh.vertices, mesh.faces)
    assert len(encoded.data) < 0.4 * (12 * len(mesh.vertices) + 12 * len(mesh.faces))


# ---- Size --------------------------------------------------------------------------------------


def size(V: np.ndarray, F: np.ndarray) -> int:
    return len(encode(V, F, method="lossless"))


def test_decimals_are_no_larger_than_cartesian_coordinates() -> None:
    V, F = meshes.icosphere(4)
    rounded = V.round(3)
    assert size(rounded, F) < 1.03 * len(encode(rounded, F, method="cartesian", step=1e-3))
    assert size(np.rint(1000 * V) / 1e8, F) < 1.1 * size(rounded, F)


def test_digits_cost_what_they_hold() -> None:
    """Three bits and a third for each decimal, of each coordinate."""
    V, F = meshes.icosphere(4)
    noisy = V + 1e-3 * np.random.default_rng(5).normal(size=V.shape)
    sizes = [8 * size(noisy.round(k), F) / V.size for k in (5, 6, 7, 8)]
    assert np.diff(sizes) == pytest.approx(np.log2(10), abs=0.1)


def test_whole_numbers_among_others_are_cheap() -> None:
    """Marching cubes: two coordinates of each vertex are whole."""
    V, F = meshes.icosphere(4)
    V = (100 * V).astype(np.float32).astype(np.float64)
    whole = np.arange(3) != np.random.default_rng(1).integers(0, 3, len(V))[:, None]
    mixed = np.where(whole, np.rint(V), V)
    assert len(np.unique(mixed, axis=0)) == len(V)
    assert size(mixed, F) < 0.6 * size(V, F)


# ---- The second decoder ------------------------------------------------------------------------


@strategies.FEW
@given(positions(12))
def test_the_second_decoder_on_any_numbers(V: np.ndarray) -> None:
    data = encode(V, meshes.icosphere(0)[1], method="lossless")
    assert spec_decoder.decode(data)[0].tobytes() == decode(data).vertices.tobytes()


@pytest.mark.parametrize("name", ["wild", "half", "singles", "decimals", "zeros"])
def test_the_second_decoder(name: str) -> None:
    V, F = meshes.grid(9, 11)
    rng = np.random.default_rng(8)
    V = V + 0.01 * rng.normal(size=V.shape)
    V = {
        "wild": meshes.wild((V, F))[0],
        "half": np.where(rng.random(V.shape) < 0.4, V, V.round(2)),
        "singles": V.astype(np.float32).astype(np.float64),
        "decimals": V.round(4),
        "zeros": np.where(rng.random(V.shape) < 0.2, np.where(V > 0.5, -0.0, 0.0), V),
    }[name]
    data = encode(V, F, method="lossless")
    assert spec_decoder.decode(data)[0].tobytes() == decode(data).vertices.tobytes()


@pytest.mark.parametrize("kind", [*KINDS, "units in the last place"])
def test_the_second_decoder_on_converted_numbers(kind: str) -> None:
    if kind in KINDS:
        V, F = converted_mesh([kind] * 3, 4)
    else:
        V, F = converted_mesh(["* 25.4"] * 3, 4)
        V[::7] = np.nextafter(V[::7].astype("f4"), np.float32(np.inf))
    encoded = assert_kept(V, F)
    formats = exact_streams.unpack_formats(memoryview(section_of(encoded.data, "EXAC")))[1]
    assert any(column.conversion.operations for column in formats)
    deviate = [column.conversion.deviations for column in formats]
    assert any(deviate) == (kind not in KINDS)
    assert spec_decoder.decode(encoded.data)[0].tobytes() == decode(encoded.data).vertices.tobytes()


def section_of(data: bytes, name: str) -> bytes:
    return bytes(read_container(data).sections[name].payload)


# ---- What no encoder has written ---------------------------------------------------------------

SPHERE = surface_of(meshes.icosphere(0)[1], 12, 0)
PARAMETERS = lossless.quantize(
    SPHERE,
    meshes.icosphere(0)[0],
    np.zeros((0, 3)),
    EXACTLY,
    Systems(SPHERE),
)[0]
flags, small = st.integers(0, 15), st.integers(-40, 1100)
operation = st.builds(
    lambda *fields: exact_streams._OPERATION.pack(*fields),
    st.integers(0, 3),
    st.sampled_from([0.001, 25.4, -1e150, 2.0**-1022]) | st.floats(),
)
form = st.builds(
    lambda *fields: exact_streams._FORMAT.pack(*fields),
    st.sampled_from([2, 10]),
    st.integers(-20, 30) | small,
    st.integers(0, 60),
    st.integers(0, 62),
)
axis = st.builds(
    lambda forms, operations, bits, grid: (
        exact_streams._COLUMN.pack(len(forms) | len(operations) << 4 | bits, grid)
        + b"".join([*operations, *forms])
    ),
    st.lists(form, max_size=2),
    st.lists(operation, max_size=2),
    st.sampled_from([0, 4, 8, 12, 64, 128, 132, 196]),
    st.integers(-20, 30) | small,
)
payloads = st.builds(
    lambda width, axes, stream: bytes([width]) + b"".join(axes) + stream,
    st.sampled_from([32, 64]),
    st.tuples(axis, axis, axis),
    st.binary(max_size=300)
    | st.builds(
        lambda size, *two: bytes([size, 0, 0, 0]) + b"".join(two),
        st.integers(0, 30),
        st.binary(max_size=30),
        st.binary(max_size=100),
    ),
)


@given(payloads)
def test_forged_payloads(payload: bytes) -> None:
    """They are refused, or decode to positions that a mesh can have."""
    section = Section("EXAC", 0, payload)
    try:
        integers = lossless.decode(SPHERE, PARAMETERS, {"EXAC": section})
    except FormatError as error:
        offset = error.offset
    else:
        offset = section.start
        assert (np.abs(integers.values.view(np.float64)) <= LARGEST).all()
    assert offset is not None
    assert section.start <= offset <= section.start + len(payload)


@given(st.data())
def test_any_forms_that_a_file_may_name(data: st.DataObject) -> None:
    """An encoder may choose badly: what is in none of its forms is raw."""
    payload = data.draw(payloads)
    try:
        _, axes, _ = exact_streams.unpack_formats(memoryview(payload))
    except FormatError:
        return
    V = data.draw(positions(12))
    axes = [
        dataclasses.replace(
            how,
            raw=True,
            zeros=bool(how.formats) and how.conversion.identical,
            conversion=dataclasses.replace(how.conversion, double=False),
        )
        for how in axes
    ]
    bits = V.view(np.int64)
    integers = lossless.exactly(bits, exact_streams.pack_formats(exact_streams.DOUBLE, axes))
    exact = lossless.encode(SPHERE, PARAMETERS, integers)["EXAC"]
    section = Section("EXAC", 0, exact)
    read = lossless.decode(SPHERE, PARAMETERS, {"EXAC": section})
    assert read.values.tobytes() == bits.tobytes()


def test_a_file_of_other_forms_is_as_good() -> None:
    V, F = meshes.icosphere(1)
    data = encode(V, F, method="lossless")
    mesh, surface = decode(data), surface_of(decode(data).faces, len(V), 0)
    raw = [RAW_ONLY] * 3
    forms = exact_streams.pack_formats(exact_streams.DOUBLE, raw)
    integers = lossless.exactly(mesh.vertices.view(np.int64), forms)
    other = forging.forged(data, **lossless.encode(surface, PARAMETERS, integers))
    with pytest.raises(FormatError, match="checksum"):
        decode(other)
    other = forging.consistent(other)
    assert len(other) > len(data)
    assert decode(other).vertices.tobytes() == mesh.vertices.tobytes()


@pytest.mark.parametrize("seed", [1, 2])
def test_vertices_that_are_next_to_nothing_beside_others(seed: int) -> None:
    rng = np.random.default_rng(seed)
    near, far = rng.standard_normal((300, 3)) * 1e-6, rng.standard_normal((30, 3)) * 1e9
    V, F = np.concatenate([near, far]), np.arange(300).reshape(100, 3)
    again = decode(encode(V, F, method="lossless", keep_order=True))
    np.testing.assert_array_equal(again.vertices, V)
    np.testing.assert_array_equal(again.faces, F)
