"""Beginnings of files: decoded at every stage, and streams as their bytes come."""

from __future__ import annotations

import gzip
import io
from dataclasses import replace
from pathlib import Path

import meshes
import numpy as np
import pytest
from forging import forged

import deltamesh
from deltamesh._geometry.solve import LeastSquares
from deltamesh._graph.adjacency import adjacency
from deltamesh._pipeline.decoder import read_content
from deltamesh._prefixes import Partial, solvable, stages
from deltamesh_formats.container.reader import read_prefix
from deltamesh_formats.container.stages import stages_of
from deltamesh_formats.polymesh.mesh import PolyMesh

V, F = meshes.torus(24, 16)
V = V + 0.01 * np.random.default_rng(3).normal(size=V.shape)
MESH = deltamesh.from_arrays(V, F, vertex={"heat": V[:, 0]}, face={"region": np.arange(len(F)) % 5})
WHOLE = replace(
    MESH,
    parts=(deltamesh.Parts("group", ("left", "right"), (np.arange(len(F)) > 300).astype(int)),),
    metadata={"comment": ("made by nobody",)},
)
OPTIONS = {
    "refined": {"method": "refined", "anchors": 8},
    "refined, least squares": {"method": "refined", "anchors": 8, "solution": "least-squares"},
    "refined, corrected": {
        "method": "refined",
        "anchors": 1,
        "normal_error": 8.0,
        "max_error_rel": 1e-3,
        "solution": "interpolated",
        "coarse": 4.5,
    },
    "highpass": {"method": "highpass", "bits": 7, "anchors": 8},
    "highpass, interpolated": {
        "method": "highpass",
        "bits": 7,
        "anchors": 8,
        "solution": "interpolated",
    },
    "0 bits": {"method": "highpass", "bits": 0, "anchors": 60},
    "cartesian": {"method": "cartesian", "bits": 10},
    "lossless": {"method": "lossless"},
}
SOLVED = [name for name, one in OPTIONS.items() if one["method"] in ("refined", "highpass")]


def encoded(name: str, mesh: PolyMesh = WHOLE, **more: object) -> bytes:
    return deltamesh.encode(mesh, **OPTIONS[name], **more)


def ends(data: bytes) -> dict[str, int]:
    return stages_of(deltamesh.info(data))


def off(found: PolyMesh, whole: PolyMesh) -> float:
    """RMS distance of the vertices, of the diagonal."""
    squares = ((found.vertices - whole.vertices) ** 2).sum(axis=1)
    return float(np.sqrt(squares.mean()) / np.linalg.norm(np.ptp(whole.vertices, axis=0)))


@pytest.mark.parametrize("name", OPTIONS)
def test_each_stage_is_reached_at_its_byte(name: str) -> None:
    data, reached = encoded(name, keep_order=True), [""]
    whole = deltamesh.decode(data)
    for stage, size in ends(data).items():
        found = deltamesh.decode(data[:size], partial=True)
        assert isinstance(found, Partial)
        assert found.stage == stage
        assert found.is_whole == (stage == "whole")
        assert found.size <= size
        assert len(found.mesh.vertices) == len(whole.vertices)
        if reached[-1]:
            assert deltamesh.decode(data[: size - 1], partial=True).stage == reached[-1]
        else:
            with pytest.raises(deltamesh.FormatError, match="no vertex has a position"):
                deltamesh.decode(data[: size - 1], partial=True)
        reached.append(stage)
    assert found.absent == ()
    assert found.mesh.attributes[0].name == "heat"
    np.testing.assert_array_equal(found.mesh.vertices, whole.vertices)


@pytest.mark.parametrize("name", SOLVED)
def test_stages_come_nearer_and_end_in_the_positions_of_the_file(name: str) -> None:
    data = encoded(name)
    whole = deltamesh.decode(data)
    far = [off(deltamesh.decode(data[:n], partial=True).mesh, whole) for n in ends(data).values()]
    assert far == sorted(far, reverse=True)
    assert far[-1] == 0
    positions = ends(data)["positions"]
    found = deltamesh.decode(data[:positions], partial=True)
    assert off(found.mesh, whole) < 1e-6
    assert found.mesh.attributes == ()
    assert found.mesh.parts == ()


def test_the_first_stage_is_the_least_squares_mesh_of_the_anchors() -> None:
    """Whatever the file's own solution, and though its deltas are not there."""
    meshes_of = []
    for name in ("refined", "refined, least squares", "highpass, interpolated"):
        data = encoded(name)
        found = deltamesh.decode(data[: ends(data)["anchors"]], partial=True).mesh
        graph = adjacency(found.triangles, len(found.vertices))
        prefix = solvable(read_prefix(data[: ends(data)["anchors"]]))
        integers, p = read_content(prefix, 2**40, 2**50).integers, prefix.parameters
        places = np.array(p.origin) + integers.positions * p.anchor_step
        zeros = np.zeros_like(found.vertices)
        expected = LeastSquares(graph, integers.anchors).solve(zeros, places)
        assert np.abs(found.vertices - expected).max() < 1e-9
        meshes_of.append(found.vertices)
    assert np.abs(meshes_of[0] - meshes_of[1]).max() < 0.2


def test_a_coarse_surface_without_vectors_of_cells_has_no_spikes() -> None:
    """As solved by least squares; interpolated anchors would stand out of it."""
    options = {"method": "refined", "anchors": 12, "solution": "interpolated"}
    data = deltamesh.encode(MESH, normal_error=6.0, **options)
    assert deltamesh.info(data).parameters.interpolated
    prefix = read_prefix(data[: ends(data)["deltas"]])
    assert not solvable(prefix).parameters.interpolated
    assert solvable(prefix).parameters.method == "highpass"
    whole = deltamesh.decode(data)
    found = deltamesh.decode(prefix, partial=True)
    assert off(found.mesh, whole) < 0.5 * off(
        deltamesh.decode(data[: ends(data)["anchors"]], partial=True).mesh, whole
    )


def test_whole_sections_after_the_geometry_count() -> None:
    data = encoded("refined", keep_order=True)
    sections = deltamesh.info(data).sections
    found = deltamesh.decode(data[: sections["ATTR"].end], partial=True)
    assert [one.name for one in found.mesh.attributes] == ["heat", "region"]
    order, further = "order of the source", ("poses", "frames beyond the first")
    assert found.absent == ("names, parts and metadata", order, *further)
    found = deltamesh.decode(data[: sections["PART"].end + 5], partial=True)
    assert found.mesh.parts[0].names == ("left", "right")
    assert found.absent == (order, *further)
    found = deltamesh.decode(data[: sections["ORDR"].end], partial=True)
    assert found.absent == further
    assert found.stage == "positions"
    np.testing.assert_array_equal(found.mesh.triangles, F)


def test_polygons_stitches_and_steps() -> None:
    """The sections between connectivity and anchors belong to the first stage."""
    V, F = meshes.grid(12, 9)
    quads = [
        [9 * i + j, 9 * i + j + 1, 9 * i + j + 10, 9 * i + j + 9]
        for i in range(11)
        for j in range(8)
    ]
    small = 1e-2 * V + [3, 0, 0.0]
    places = np.concatenate([V + [0, 0, 0.1] * np.sin(9 * V), small, V[:1] + 5])
    faces = [*quads, *(F + len(V)).tolist(), [0, 1, 2 * len(V)]]
    data = deltamesh.encode(deltamesh.from_arrays(places, faces), quality=5, method="refined")
    assert {"STCH", "POLY", "STEP"} <= {*deltamesh.info(data).sections}
    whole = deltamesh.decode(data)
    for stage, size in ends(data).items():
        found = deltamesh.decode(data[:size], partial=True)
        assert found.stage == stage
        np.testing.assert_array_equal(found.mesh.corners, whole.corners)
        np.testing.assert_array_equal(found.mesh.offsets, whole.offsets)


@pytest.mark.parametrize("name", ["refined", "cartesian"])
def test_damage_is_refused_and_a_file_that_is_cut_needs_the_option(name: str) -> None:
    data = encoded(name)
    size = ends(data)["deltas" if name == "refined" else "positions"]
    flipped = bytearray(data[: size + 3])
    flipped[size // 2] ^= 1
    with pytest.raises(deltamesh.FormatError, match="damaged"):
        deltamesh.decode(bytes(flipped), partial=True)
    for read in (deltamesh.decode, deltamesh.info):
        with pytest.raises(deltamesh.FormatError, match="truncated"):
            read(data[:size])
    prefix = deltamesh.info(data[:size], partial=True)
    assert not prefix.is_whole
    for refuse in (deltamesh.decode, deltamesh.verify):
        with pytest.raises(deltamesh.FormatError, match="CHEK is missing"):
            refuse(prefix)


def test_the_content_of_a_whole_file_is_proved() -> None:
    data = forged(encoded("refined"), checksum=b"8 wrong!")
    assert deltamesh.decode(data[:-1], partial=True).stage == "positions"
    with pytest.raises(deltamesh.FormatError, match="checksum of the decoded integers"):
        deltamesh.decode(data, partial=True)


def test_the_limits_hold() -> None:
    data = encoded("refined")
    cut = data[: ends(data)["deltas"]]
    for limit in ({"max_vertices": 100}, {"memory": 1000}):
        with pytest.raises(deltamesh.LimitError):
            deltamesh.decode(cut, partial=True, **limit)
        with pytest.raises(deltamesh.LimitError):
            list(stages(io.BytesIO(cut), **limit))


def test_paths_files_and_compression_around_them(tmp_path: Path) -> None:
    data = encoded("refined")
    size = ends(data)["deltas"]
    (tmp_path / "a.dmesh").write_bytes(data[: size + 4])
    packed = gzip.compress(data)
    (tmp_path / "b.dmesh.gz").write_bytes(packed[: len(packed) * 2 // 3])
    for source in (tmp_path / "a.dmesh", io.BytesIO(data[: size + 4])):
        assert deltamesh.load(source, partial=True).stage == "deltas"
    found = deltamesh.load(tmp_path / "b.dmesh.gz", partial=True)
    assert found.stage in ("anchors", "deltas", "refinements", "positions")
    with pytest.raises(deltamesh.FormatError, match="gzip"):
        deltamesh.load(tmp_path / "b.dmesh.gz")
    assert isinstance(deltamesh.load(io.BytesIO(data)), PolyMesh)


class Slow(io.BytesIO):
    """A stream of which a few bytes come at once."""

    def __init__(self, data: bytes, size: int = 100) -> None:
        super().__init__(data)
        self.size = size

    def read1(self, size: int | None = -1) -> bytes:
        return self.read(self.size)


@pytest.mark.parametrize("name", OPTIONS)
@pytest.mark.parametrize("size", [1, 37])
def test_a_stream_yields_each_stage_as_its_bytes_come(name: str, size: int) -> None:
    data = encoded(name)
    stream, seen = Slow(data, size), []
    for found in deltamesh.stages(stream):
        end = ends(data)[found.stage]
        assert end <= stream.tell() < end + size
        seen.append(found.stage)
    assert seen == (list(ends(data)) if size == 1 else [s for s in ends(data) if s in seen])
    np.testing.assert_array_equal(found.mesh.vertices, deltamesh.decode(data).vertices)


def test_stages_that_are_overtaken_are_left_out() -> None:
    data = encoded("refined")
    assert [found.stage for found in stages(io.BytesIO(data))] == ["whole"]
    half = io.BytesIO(data[: ends(data)["deltas"] + 20])
    assert [found.stage for found in stages(half)] == ["deltas"]


def test_a_stream_that_ends_too_early_or_is_damaged() -> None:
    data = encoded("refined")
    for size in (0, 7, 40, 70, ends(data)["anchors"] - 1):
        with pytest.raises(deltamesh.FormatError):
            list(stages(Slow(data[:size])))
    flipped = bytearray(data)
    flipped[ends(data)["deltas"] - 9] ^= 1
    found = stages(Slow(bytes(flipped)))
    assert next(found).stage == "anchors"
    with pytest.raises(deltamesh.FormatError, match="section DELT is damaged"):
        next(found)
    with pytest.raises(deltamesh.FormatError, match="bytes follow"):
        list(stages(io.BytesIO(data + b"!")))
