"""Measuring codecs: ours, other ones, and tables of what they took."""

from __future__ import annotations

import importlib.util

import meshes
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import deltamesh
from deltamesh._compare.correspondence import match
from deltamesh._compare.welding import welded, without_isolated
from deltamesh._measures import metrics
from deltamesh._mesh import TriangleMesh
from deltamesh._options import Options
from deltamesh.bench import _measure as bench
from deltamesh.bench import _peers as peers
from deltamesh.bench import _rates as rates
from deltamesh.bench import codec_of, labels, missing
from deltamesh.bench._peer_names import PEER_NAMES
from deltamesh_formats import zstd_frames
from deltamesh_formats.errors import OptionError


@pytest.fixture(scope="module")
def torus():
    """A torus of 600 vertices, in double precision that float32 does not have."""
    V, F = meshes.torus(30, 20)
    return TriangleMesh(V + np.random.default_rng(1).normal(0, 0.01, V.shape), F)


def rows(*measurements):
    return [rates.row_of(one) for one in measurements]


# ---- Our own codec -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("method", "rate"),
    [("highpass", {"bits": 6}), ("cartesian", {"bits": 9}), ("refined", {"step": 0.02})],
)
def test_a_measurement_is_what_encode_decode_and_compare_say(torus, method, rate):
    codec = bench.deltamesh_codec(Options(method=method, **rate))
    measured = bench.measure("torus", torus, codec)
    data = deltamesh.encode(torus.vertices, torus.faces, method=method, **rate)
    decoded = deltamesh.decode(data)
    order = match(torus, decoded)
    errors = metrics.compare(torus, TriangleMesh(decoded.vertices[order], torus.faces))
    assert (measured.mesh, measured.codec, measured.bytes) == (
        "torus",
        codec.label,
        len(data),
    )
    assert (measured.vertices, measured.faces) == (600, 1200)
    assert measured.bpv == 8 * len(data) / 600
    for column in ("rms", "max", "hausdorff", "visual"):
        # The samples of the Hausdorff distance depend on the order of the faces.
        expected = pytest.approx(getattr(errors, column) / errors.diagonal, rel=1e-6)
        close = pytest.approx(getattr(errors, column) / errors.diagonal, rel=0.05)
        assert getattr(measured, column) == (close if column == "hausdorff" else expected)
    assert measured.normal_deg == pytest.approx(errors.normal_deviation, rel=1e-6)
    assert measured.dihedral_deg == pytest.approx(errors.dihedral, rel=1e-6)
    assert {"PARM", "CONN", "CHEK"} < set(measured.sections)
    assert sum(measured.sections.values()) < len(data) < sum(measured.sections.values()) + 30
    assert measured.encode_seconds > 0 < measured.decode_seconds


@pytest.mark.parametrize(
    ("options", "label"),
    [
        (Options(), "auto"),
        (Options(method="refined", coarse=4.0), "refined coarse=4.0"),
        (Options(method="highpass", bits=4, diffusion=False), "highpass bits=4 diffusion=False"),
        (Options(step=1e-3, anchors=0.01, anchor_method="random", seed=7), None),
        (Options(method="cartesian", max_error_rel=1e-4, drop_isolated=True), None),
        (Options(solver="scipy", threads=2, source_format="ply"), "auto"),
    ],
)
def test_labels_say_everything_that_bytes_depend_on(torus, options, label):
    codec = bench.deltamesh_codec(options)
    assert label in (None, codec.label)
    again = bench.codec_of(codec.label)
    assert again.label == codec.label
    assert again.code(torus).size == codec.code(torus).size


@pytest.mark.parametrize(
    "label",
    [
        "",
        "jpeg bits=3",
        "highpass bit=3",
        "highpass 3",
        "highpass bits=x",
        "highpass bits=99",
        "draco",
        "draco bits=0",
        "draco bits=11 level=1",
        "meshopt bits=17",
        "zstd bits=3",
    ],
)
def test_labels_that_mean_nothing_are_refused(label):
    with pytest.raises(deltamesh.OptionError):
        bench.codec_of(label)


def test_warming_up_measures_nothing_and_never_fails():
    bench.warm_up(bench.codec_of("highpass max_error=1e-300"))
    bench.warm_up(bench.codec_of("cartesian"))


# ---- Other codecs ------------------------------------------------------------------------------


def sorted_rows(points):
    return points[np.lexsort(points.T)]


def triangles(mesh):
    """The corners' coordinates of each face, from the least corner on, in order."""
    corners = mesh.vertices[mesh.faces]
    turns = [np.roll(corners, -k, axis=1).reshape(-1, 9) for k in range(3)]
    return sorted(min(tuple(turn[i]) for turn in turns) for i in range(len(corners)))


@pytest.mark.parametrize("bits", [4, 8, 11, 14, 20])
@pytest.mark.parametrize("scale", [1.0, 1e-3, 12345.678])
def test_draco_puts_vertices_where_its_decoder_does(torus, bits, scale):
    draco = pytest.importorskip("DracoPy")
    V = scale * (torus.vertices + np.array([0.1, 20, -0.7]))
    coded = peers.draco(TriangleMesh(V, torus.faces), bits)
    data = draco.encode(
        V.astype(np.float32),
        torus.faces.astype(np.uint32),
        quantization_bits=bits,
        compression_level=10,
    )
    points = np.asarray(draco.decode(data).points, dtype=np.float32)
    assert coded.size == len(data)
    assert np.array_equal(
        sorted_rows(points), sorted_rows(coded.decoded.vertices.astype(np.float32))
    )
    step = np.ptp(V, axis=0).max() / (2**bits - 1)
    assert np.abs(coded.decoded.vertices - V).max() < 0.51 * step + 1e-6 * np.abs(V).max()


def test_what_draco_refuses_is_a_mesh_error():
    pytest.importorskip("DracoPy")
    with pytest.raises(deltamesh.MeshError, match="Draco refuses"):
        peers.draco(TriangleMesh(np.zeros((3, 3)), np.array([[0, 0, 1]])), 11)


@pytest.mark.parametrize("bits", [6, 12, 16])
def test_meshopt_gives_back_the_mesh_on_its_grid(torus, bits):
    pytest.importorskip("meshopt")
    coded = peers.meshopt(torus, bits)
    assert triangles(coded.reference) == triangles(torus)
    assert np.array_equal(coded.decoded.faces, coded.reference.faces)
    step = np.ptp(torus.vertices, axis=0).max() / (2**bits - 1)
    assert np.abs(coded.decoded.vertices - coded.reference.vertices).max() <= 0.501 * step
    assert coded.size < 4 * 600 * 3  # far less than the float32 positions alone


def test_zstd_gives_back_float32(torus):
    coded = peers.zstd(torus)
    arrays = torus.vertices.astype(np.float32).tobytes() + torus.faces.astype(np.int32).tobytes()
    assert coded.size == len(zstd_frames.frame(arrays, 19))
    assert np.array_equal(coded.decoded.vertices, torus.vertices.astype(np.float32))
    assert np.array_equal(coded.decoded.faces, torus.faces)


def test_missing_packages_are_named(monkeypatch):
    assert peers.missing("highpass bits=3") == ()
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert peers.missing("meshopt bits=3") == ("meshopt",)
    assert peers.labels("meshopt", (3, 4)) == ["meshopt bits=3", "meshopt bits=4"]
    assert peers.labels("zstd", (3, 4)) == ["zstd"]
    assert tuple(peers.PEERS) == PEER_NAMES


def test_a_welded_mesh_has_each_position_and_no_isolated_vertex():
    V, F = meshes.with_isolated()
    soup = TriangleMesh(V[F].reshape(-1, 3), np.arange(3 * len(F)).reshape(-1, 3))
    sphere = meshes.icosphere(1)[0]
    for mesh in (soup, TriangleMesh(V, F)):
        bare = without_isolated(welded(mesh))
        assert np.array_equal(sorted_rows(bare.vertices), sorted_rows(sphere))
        assert np.array_equal(bare.vertices[bare.faces], V[F])


# ---- Tables ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def table(torus):
    labels = ("highpass bits=5", "cartesian bits=9")
    return rows(*(bench.measure("a, b.ply", torus, bench.codec_of(one)) for one in labels))


def altered(row, **columns):
    return {**row, **{name: str(value) for name, value in columns.items()}}


def test_tables_are_text_of_four_digits_without_times(table):
    text = rates.as_text(table)
    again = rates.from_text(text)
    assert tuple(again[0]) == rates.COLUMNS
    assert "seconds" not in text
    assert again == [{name: row[name] for name in rates.COLUMNS} for row in table]
    assert rates.as_text(again) == text
    for row, column in ((row, column) for row in table for column in (*rates.ERRORS, "bpv")):
        assert row[column] == f"{float(row[column]):.4g}"
    assert rates.changes(again, table) == []


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("ply\nformat ascii 1.0\n", "no mesh, codec"),
        ("", "no mesh, codec"),
        (",".join(rates.COLUMNS[:-1]) + "\na,b,1,1,1,1,1,1,1,1,1,1\n", "no sections"),
        (",".join(rates.COLUMNS) + "\na,b,1,1,many,1,1,1,1,1,1,1,\n", "'many'"),
        (",".join(rates.COLUMNS) + "\na,b,1\n", "no faces"),
    ],
)
def test_other_text_is_no_table(text, why):
    with pytest.raises(deltamesh.DeltameshError, match=why):
        rates.from_text(text)


def test_growth_of_one_percent_is_found_and_reruns_pass(table):
    old, other = table
    size = int(old["bytes"])
    for factor, expected in ((1.01, "grew"), (1.004, None), (0.99, "shrank"), (1, None)):
        new = altered(old, bytes=round(size * factor))
        found = rates.changes([old, other], [new, other])
        assert [one.verdict for one in found] == [expected] * (expected is not None)
        assert any(one.worse for one in found) == (expected == "grew")
        if found:
            assert found[0].growth == pytest.approx(factor - 1, abs=1e-3)
            assert (found[0].mesh, found[0].codec) == ("a, b.ply", "highpass bits=5")
            assert (found[0].column, found[0].before) == ("bytes", str(size))
    exact = rates.changes([old], [altered(old, bytes=size + 1)], tolerance=0)
    assert [one.verdict for one in exact] == ["grew"]


@pytest.mark.parametrize("column", rates.ERRORS)
def test_errors_have_a_tolerance_of_their_own(table, column):
    old = altered(table[0], **{column: "2"})

    def verdicts(value, **tolerance):
        found = rates.changes([old], [altered(old, **{column: value})], **tolerance)
        return [(one.column, one.verdict) for one in found]

    assert verdicts("2.015") == []
    assert verdicts("2.025") == [(column, "grew")]
    assert verdicts("2.025", error_tolerance=0.02) == []
    assert verdicts("1.9") == [(column, "shrank")]
    assert verdicts("nan") == [(column, "grew")]


def test_what_is_as_good_as_no_error_may_move(table):
    old = altered(table[0], rms="0", normal_deg="1e-07")
    assert rates.changes([old], [altered(old, rms="3e-16", normal_deg="2e-5")]) == []
    found = rates.changes([old], [altered(old, rms="3e-6")])
    assert [(one.verdict, one.growth) for one in found] == [("grew", float("inf"))]


def test_rows_that_come_and_go_are_changes(table):
    first, second = table
    found = rates.changes([first], [second])
    assert [(one.codec, one.column, one.verdict, one.worse) for one in found] == [
        ("highpass bits=5", "row", "gone", True),
        ("cartesian bits=9", "row", "new", False),
    ]
    other = rates.changes([first], [altered(first, faces="7")])
    assert [(one.column, one.verdict, one.worse) for one in other] == [("faces", "changed", True)]


@given(st.integers(1, 10**9), st.floats(0, 0.5), st.floats(-0.9, 3))
def test_a_gate_opens_for_what_is_within_the_tolerance_only(size, tolerance, growth):
    row = dict.fromkeys(rates.COLUMNS, "1")
    now = max(round(size * (1 + growth)), 1)
    old, new = altered(row, bytes=size), altered(row, bytes=now)
    worse = any(one.worse for one in rates.changes([old], [new], tolerance=tolerance))
    assert worse == (now - size > tolerance * size)


def test_labels_that_are_none_are_refused() -> None:
    for wrong in (None, 3, b"draco"):
        with pytest.raises(OptionError, match="text must be a str"):
            codec_of(wrong)  # type: ignore[arg-type]
        with pytest.raises(OptionError, match="label must be a str"):
            missing(wrong)  # type: ignore[arg-type]
        with pytest.raises(OptionError, match="name must be one of draco, meshopt, zstd"):
            labels(wrong, [3])  # type: ignore[arg-type]
