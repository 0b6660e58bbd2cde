"""The lossless method: every bit comes back, in few bytes, and what is forged is refused."""

from __future__ import annotations

import dataclasses
import json
from fractions import Fraction

import forging
import meshes
import numpy as np
import pytest
import spec_decoder
import strategies
from hypothesis import given, settings
from hypothesis import strategies as st

from deltamesh import decode, encode, info
from deltamesh._geometry import lossless
from deltamesh._geometry.solve import factorization
from deltamesh._kernels.coding.exact import NEGATIVE_ZERO, RAW
from deltamesh._mesh import LARGEST
from deltamesh._options import Options
from deltamesh._pipeline import encode_mesh
from deltamesh._shape.surface import surface_of
from deltamesh._streams import exact as exact_streams
from deltamesh._streams.decomposition import BINARY_DIGITS
from deltamesh._streams.format_choice import choose_formats
from deltamesh._streams.number_formats import (
    RAW_ONLY,
    ColumnFormats,
    NumberFormat,
    from_indices,
    to_indices,
)
from deltamesh_cli.program import run
from deltamesh_formats.container.container import Section
from deltamesh_formats.errors import FormatError, MeshError, OptionError
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

doubles = st.floats(-LARGEST, LARGEST)
singles = st.floats(-(2.0**100), 2.0**100, width=32)
decimals = st.builds(lambda m, k: m / 10**k, st.integers(-(10**7), 10**7), st.integers(0, 9))
dyadics = st.builds(lambda m, k: m / 2.0**k, st.integers(-(2**20), 2**20), st.integers(-40, 40))
extremes = st.sampled_from(
    [0.0, -0.0, 5e-324, -5e-324, 2.2250738585072014e-308, 1e150, -1e150, 1e-45]
)
numbers = st.sampled_from([doubles, singles, decimals, dyadics, extremes])


@st.composite
def positions(draw: st.DrawFn, count: int) -> np.ndarray:
    """Numbers of one kind or of several, all positions different."""
    kinds = draw(st.lists(numbers, min_size=1, max_size=3))
    rows = st.tuples(*[st.one_of(kinds)] * 3)
    bits = lambda row: np.array(row).tobytes()  # noqa: E731
    found = draw(st.lists(rows, min_size=count, max_size=count, unique_by=bits))
    return np.array(found)


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


# ---- Forms -------------------------------------------------------------------------------------


def every_number(form: NumberFormat, exponents: int) -> list[Fraction]:
    """The definition of SPEC.md 5.12, one by one."""
    b, d = form.base, form.digits
    found = {
        Fraction(m) * Fraction(b) ** (e - form.places)
        for e in range(exponents)
        for m in range(b ** (d - 1) if e else 0, b**d)
    }
    return sorted(found | {-x for x in found})


@pytest.mark.parametrize(
    "form",
    [
        NumberFormat(2, 3, 4),
        NumberFormat(2, -2, 1),
        NumberFormat(2, 60, 2),
        NumberFormat(10, 2, 2),
        NumberFormat(10, 5, 1),
    ],
)
def test_an_index_counts_the_numbers_of_a_form(form: NumberFormat) -> None:
    expected = every_number(form, 5)
    values = np.array([float(x) for x in expected])
    how = ColumnFormats((form,), (0,), form.places, raw=False, zeros=False)
    classes, indices = to_indices(values, how, single=False)
    assert not classes.any()
    half = len(expected) // 2
    assert indices.tolist() == list(range(-half, half + 1))
    assert from_indices(classes, indices, how, single=False).tolist() == values.tolist()
    between = (values[1:] + values[:-1]) / 2
    assert (to_indices(between, how, single=False)[0] == RAW).all()


@pytest.mark.parametrize(
    ("values", "single", "base", "places", "digits"),
    [
        ([0.25, -3.5, 17.75], False, 2, 2, 7),
        ([0.1, 0.25, -3.14], False, 10, 2, 3),
        ([0.001234, 0.1234, 12.34], False, 10, 6, 4),
        ([np.float32(0.13), np.float32(-3.14)], True, 10, 2, 3),
        ([-8.0, 1024.0, 24.0], False, 2, -3, 2),
        ([1e-7, 2e-7, 1.0], False, 10, 7, 1),
    ],
)
def test_the_shortest_form_is_found(
    values: list[float], single: bool, base: int, places: int, digits: int
) -> None:
    V = np.tile(np.array(values, dtype=np.float64), 100)
    how = choose_formats(V, np.abs(V), single)
    assert how.formats == (NumberFormat(base, places, digits),)
    assert not how.raw


def test_random_bits_have_the_form_of_their_type() -> None:
    rng = np.random.default_rng(3)
    V = rng.random(1000)
    assert choose_formats(V, V, False).formats[0].digits == BINARY_DIGITS
    single = V.astype(np.float32).astype(np.float64)
    assert {form.digits for form in choose_formats(single, V, True).formats} == {24}


def test_a_few_other_numbers_are_raw() -> None:
    V = np.random.default_rng(4).random(10000).round(4)
    V[77:80] = 1 / 3, 1e-20, 1e100
    how = choose_formats(V, V, False)
    assert how.formats == (NumberFormat(10, 4, 4),)
    assert how.raw
    assert np.flatnonzero(to_indices(V, how, False)[0]).tolist() == [77, 78, 79]


@settings(deadline=None)
@given(st.lists(st.one_of(doubles, singles, decimals, dyadics, extremes), min_size=1))
def test_formats_and_back(values: list[float]) -> None:
    V = np.array(values)
    with np.errstate(over="ignore"):
        single = bool((V.astype(np.float32) == V).all())
    how = choose_formats(V, np.abs(V), single)
    classes, integers = to_indices(V, how, single)
    assert from_indices(classes, integers, how, single).tobytes() == V.tobytes()
    assert ((classes == NEGATIVE_ZERO) <= how.zeros).all()
    assert (np.abs(integers[classes < RAW]) < 2**61).all()


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


# ---- What no encoder has written ---------------------------------------------------------------

SPHERE = surface_of(meshes.icosphere(0)[1], 12, 0)
PARAMETERS = lossless.quantize(
    SPHERE, meshes.icosphere(0)[0], np.zeros((0, 3)), EXACTLY, factorization(SPHERE.laplacian)
)[0]
flags, small = st.integers(0, 15), st.integers(-40, 1100)
form = st.builds(
    lambda *fields: exact_streams._FORMAT.pack(*fields),
    st.sampled_from([2, 10]),
    st.integers(-20, 30) | small,
    st.integers(0, 60),
    st.integers(0, 62),
)
axis = st.builds(
    lambda forms, bits, grid: exact_streams._COLUMN.pack(len(forms) | bits, grid) + b"".join(forms),
    st.lists(form, max_size=2),
    st.sampled_from([0, 4, 8, 12]),
    st.integers(-20, 30) | small,
)
payloads = st.builds(
    lambda width, axes, stream: bytes([width]) + b"".join(axes) + stream,
    st.sampled_from([32, 64]),
    st.tuples(axis, axis, axis),
    st.binary(max_size=300),
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
    axes = [dataclasses.replace(how, raw=True, zeros=bool(how.formats)) for how in axes]
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


# ---- Options and words -------------------------------------------------------------------------


@pytest.mark.parametrize(
    "rate", [{"bits": 8}, {"step": 0.1}, {"max_error": 1.0}, {"normal_error": 1.0}, {"coarse": 4.0}]
)
def test_rates_contradict_it(rate: dict) -> None:
    with pytest.raises(OptionError, match=r"means? nothing with method lossless"):
        Options(method="lossless", **rate)


@pytest.fixture
def mesh_file(tmp_path, monkeypatch):
    from deltamesh_formats.meshfiles.files import write_mesh

    monkeypatch.chdir(tmp_path)
    V, F = meshes.torus(9, 7)
    write_mesh("torus.obj", from_triangles(np.where(V == 0, -0.0, V), F))


def cli(line: str) -> int:
    return run(line.split())


@pytest.mark.parametrize("more", ["--bits 8", "--max-error 1", "--anchors 5", "--method cartesian"])
def test_usage(mesh_file: None, capsys: pytest.CaptureFixture[str], more: str) -> None:
    assert cli(f"encode torus.obj --lossless {more}") == 2
    assert more.split()[0] in capsys.readouterr().err


def test_commands(mesh_file: None, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("encode torus.obj a.dmesh --lossless") == 0
    assert "RMS 0 and max 0 of the diagonal, normals 0" in capsys.readouterr().out
    assert cli("encode torus.obj b.dmesh --method lossless") == 0
    assert cli("test a.dmesh b.dmesh") == 0
    capsys.readouterr()
    assert cli("info a.dmesh") == 0
    assert "\n  lossless\n" in capsys.readouterr().out
    assert cli("compare torus.obj a.dmesh --json") == 0
    errors = json.loads(capsys.readouterr().out)["errors"]
    assert errors.pop("diagonal") > 0
    assert set(errors.values()) == {0.0}
    assert cli("decode a.dmesh back.obj") == 0
    assert cli("encode back.obj again.dmesh --lossless") == 0
    with open("a.dmesh", "rb") as a, open("again.dmesh", "rb") as again:
        assert sorted(map(bytes, decode(a.read()).vertices)) == sorted(
            map(bytes, decode(again.read()).vertices)
        )


def test_compare_tells_zeros_apart(tmp_path, capsys: pytest.CaptureFixture[str]) -> None:
    """As the encoder does: two vertices at one position, but for the sign of a zero, are two."""
    lines = "0 0 0", "1 0 0", "0 1 0", "-0.0 1 0", "1 -0.0 0", "1 1 0"
    text = "".join(f"v {line}\n" for line in lines)
    (tmp_path / "two.obj").write_text(f"{text}f 1 2 3\nf 4 5 6\n")
    assert cli(f"encode {tmp_path}/two.obj {tmp_path}/two.dmesh --lossless") == 0
    capsys.readouterr()
    assert cli(f"compare {tmp_path}/two.obj {tmp_path}/two.dmesh --json") == 0
    shown = json.loads(capsys.readouterr().out)
    assert shown["b"]["vertices"] == 6
    assert shown["errors"]["rms"] == 0
