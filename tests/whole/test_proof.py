"""Proof of what an encoder writes: everything decodes, however few bytes its elements take."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import commandline
import forging
import meshes
import numpy as np
import pytest
import second_opinion
import spec_decoder

import deltamesh
from deltamesh import FormatError, decode, encode, from_arrays, info
from deltamesh import _limits as limits
from deltamesh._limits import filling
from deltamesh._pipeline import encoder
from deltamesh._sections.draft import Draft
from deltamesh._sections.table import Section
from deltamesh._shape.announced import announced
from deltamesh_formats.container.payload_layout import MAX_ELEMENTS_PER_BYTE
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh

CORNERS = np.eye(3)
TRIANGLE = np.array([[0, 1, 2]])
PENTAGON = np.array([[1, 0, 0], [0.3, 1, 0], [-0.8, 0.6, 0], [-0.8, -0.6, 0], [0.3, -1, 0]])


def with_vertices_at_one_point(count: int, point: tuple[float, float, float]) -> PolyMesh:
    return from_arrays(np.vstack([CORNERS, np.tile(point, (count, 1))]), TRIANGLE)


def book(pages: int) -> PolyMesh:
    """Faces at one edge."""
    angle = np.arange(pages) / pages
    rim = np.stack((np.cos(angle), np.sin(angle), angle), axis=1)
    faces = np.stack((0 * angle, 0 * angle + 1, 2 + np.arange(pages)), axis=1).astype(np.int64)
    return from_arrays(np.vstack([[[0, 0, 0], [0, 0, 1]], rim]), faces)


def degenerate(count: int, face: tuple[int, int, int]) -> PolyMesh:
    return from_arrays(CORNERS, np.vstack([TRIANGLE, np.tile(face, (count, 1))]))


def separate(count: int) -> PolyMesh:
    """Components of one face each."""
    offsets = np.repeat(np.arange(count)[:, None] * [2.0, 0.0, 0.0], 3, axis=0)
    return from_arrays(np.tile(CORNERS, (count, 1)) + offsets, np.arange(3 * count).reshape(-1, 3))


def with_one_label(count: int) -> PolyMesh:
    faces = np.tile(TRIANGLE, (count, 1))
    labels, constant = np.full(count, 7), np.ones((3 * count, 2))
    return from_arrays(CORNERS, faces, face={"label": labels}, corner={"constant": constant})


def of_constant_attributes() -> PolyMesh:
    V, F = meshes.grid(70, 70)
    n, m = len(V), len(F)
    integers, halves = np.full((n, 64), -3), np.full((n, 40), 0.1)
    bytes_of_faces = {"g": np.zeros((m, 30), np.uint8)}
    return from_arrays(V, F, vertex={"i": integers, "f": halves}, face=bytes_of_faces)


def of_one_part() -> PolyMesh:
    mesh = from_arrays(*meshes.grid(150, 150))
    return replace(mesh, parts=(Parts("group", ("all",), np.zeros(len(mesh.faces), np.int64)),))


MADE = {
    "copies of a face": lambda: from_arrays(CORNERS, np.tile(TRIANGLE, (190_000, 1))),
    "copies in both windings": lambda: from_arrays(
        CORNERS, np.vstack([np.tile(TRIANGLE, (99_000, 1)), np.tile([[1, 0, 2]], (99_000, 1))])
    ),
    "isolated vertices at one point": lambda: with_vertices_at_one_point(10**6, (1, 1, 1)),
    "isolated vertices at a corner": lambda: with_vertices_at_one_point(100_000, (1, 0, 0)),
    "faces at one edge": lambda: book(50_000),
    "degenerate faces": lambda: degenerate(100_000, (0, 0, 1)),
    "degenerate faces of a vertex": lambda: degenerate(100_000, (2, 2, 2)),
    "pentagons": lambda: from_arrays(PENTAGON, np.tile(np.arange(5), (50_000, 1))),
    "one label": lambda: with_one_label(200_000),
    "constant attributes": of_constant_attributes,
    "one part": of_one_part,
    "components": lambda: separate(50_000),
}


def several() -> tuple[np.ndarray, np.ndarray]:
    return meshes.union(meshes.doubled(), meshes.with_isolated())


@pytest.fixture(scope="module", autouse=True)
def loaded() -> None:
    """Modules are imported before anything is timed."""
    for method in ("auto", "cartesian", "lossless"):
        decode(encode(*several(), method=method))


@pytest.mark.parametrize("method", [pytest.param("auto", marks=pytest.mark.slow), "lossless"])
@pytest.mark.parametrize("name", MADE)
def test_many_elements_of_few_bytes(name: str, method: str) -> None:
    mesh = MADE[name]()
    start = time.process_time()
    again = decode(encode(mesh, method=method))
    assert time.process_time() - start < 60
    assert len(again.vertices) == len(mesh.vertices)
    np.testing.assert_array_equal(sorted(np.diff(again.offsets)), sorted(np.diff(mesh.offsets)))
    assert [part.names for part in again.parts] == [part.names for part in mesh.parts]
    for ours, theirs in zip(mesh.attributes, again.attributes, strict=True):
        np.testing.assert_array_equal(ours.dense(), theirs.dense())  # constants, in any order
    if method == "lossless":
        rows = [np.unique(one.vertices, axis=0, return_counts=True) for one in (mesh, again)]
        for ours, theirs in zip(*rows, strict=True):
            np.testing.assert_array_equal(ours, theirs)


# ---- FILL --------------------------------------------------------------------------------------


def copies(count: int) -> bytes:
    """A face, and so many copies of it."""
    return encode(CORNERS, np.tile(TRIANGLE, (1 + count, 1)), method="cartesian")


def most_without_fill() -> int:
    """How many copies the bytes of STCH are enough for, which are the same for many counts."""
    return MAX_ELEMENTS_PER_BYTE * (len(info(copies(180_000)).sections["STCH"].payload) + 4)


def test_fill_has_the_bytes_that_elements_lack() -> None:
    most = most_without_fill()
    sizes = {}
    for count in (most, most + 1, most + MAX_ELEMENTS_PER_BYTE, most + MAX_ELEMENTS_PER_BYTE + 1):
        data = copies(count)
        sections = info(data).sections
        assert MAX_ELEMENTS_PER_BYTE * (len(sections["STCH"].payload) + 4) == most
        sizes[count - most] = len(sections["FILL"].payload) if "FILL" in sections else 0
        assert len(decode(data).faces) == 1 + count
    assert sizes == {0: 0, 1: 1, MAX_ELEMENTS_PER_BYTE: 1, MAX_ELEMENTS_PER_BYTE + 1: 2}


@pytest.mark.slow
def test_second_decoder_agrees_on_fill() -> None:
    data = copies(most_without_fill() + 1)
    assert bytes(info(data).sections["FILL"].payload) == b"\0"
    second_opinion.assert_same(data)
    for wrong in (b"", b"\0\0", b"\1"):
        with pytest.raises(Exception, match="bytes of FILL"):
            spec_decoder.decode(forging.forged(data, FILL=wrong))


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        (b"", "do not fit into 8 bytes and 0 of FILL"),
        (b"\0\0", "FILL: 2 bytes where 1 are lacking"),
        (b"\1", "FILL: a byte that is not zero"),
    ],
)
def test_other_fill_is_refused(payload: bytes, message: str) -> None:
    data = copies(most_without_fill() + 1)
    with pytest.raises(FormatError, match=message) as caught:
        decode(forging.forged(data, FILL=payload))
    assert caught.value.offset is not None


@pytest.mark.parametrize("method", ["highpass", "refined", "cartesian", "lossless"])
@pytest.mark.parametrize("payload", [b"", b"\0"])
def test_fill_that_nothing_lacks_is_refused(method: str, payload: bytes) -> None:
    data = encode(*meshes.icosphere(1), method=method)
    assert filling(info(data), announced(info(data))) == 0
    with pytest.raises(FormatError, match="where 0 are lacking"):
        decode(forging.forged(data, FILL=payload))


# ---- Files that an encoder gets wrong ----------------------------------------------------------


def with_section(monkeypatch: pytest.MonkeyPatch, name: str, change: Any) -> None:
    """Let the encoder of a stage of the pipeline return what `change` makes of its results."""

    def changed(section: Section) -> Section:
        if section.stage != name:
            return section
        return replace(section, encode=lambda draft: change(*section.encode(draft)))

    monkeypatch.setattr(encoder, "SECTIONS", tuple(map(changed, encoder.SECTIONS)))


def shortened(payloads: dict[str, bytes], draft: Draft) -> tuple[dict[str, bytes], Draft]:
    return {name: payload[:-1] for name, payload in payloads.items()}, draft


def of_other_points(payloads: dict[str, bytes], draft: Draft) -> tuple[dict[str, bytes], Draft]:
    integers = draft.content.integers
    integers = replace(integers, values=integers.values + 1)
    return payloads, replace(draft, content=replace(draft.content, integers=integers))


@pytest.mark.parametrize("stage", ["connectivity", "stitches", "split vertices", "geometry"])
def test_no_file_that_cannot_be_decoded(stage, monkeypatch, tmp_path) -> None:
    with_section(monkeypatch, stage, shortened)
    target = tmp_path / "a.dmesh"
    target.write_bytes(b"before")
    with pytest.raises(RuntimeError, match=r"the encoded file cannot be decoded: .*byte"):
        deltamesh.save(target, from_arrays(*several()), method="cartesian")
    assert [*tmp_path.iterdir()] == [target]
    assert target.read_bytes() == b"before"


@pytest.mark.parametrize("method", ["refined", "cartesian", "lossless"])
def test_no_file_of_another_content(method, monkeypatch) -> None:
    with_section(monkeypatch, "geometry", of_other_points)
    with pytest.raises(RuntimeError, match="the checksum of the decoded integers is wrong"):
        encode(*meshes.icosphere(1), method=method)


def mesh_file(folder: Path) -> str:
    source = folder / "a.ply"
    deltamesh.write_mesh(source, from_arrays(*meshes.icosphere(1)))
    return str(source)


def test_command_reports_a_bug_and_writes_nothing(monkeypatch, tmp_path, capsys) -> None:
    with_section(monkeypatch, "connectivity", shortened)
    source, target = mesh_file(tmp_path), tmp_path / "a.dmesh"
    assert commandline.cli("encode", source, str(target)) == 1
    assert "a bug in deltamesh" in capsys.readouterr().err
    assert not target.exists()


def test_the_proof_has_no_limit_of_memory(monkeypatch, tmp_path, capsys) -> None:
    """A file that takes more than the default limits is written; the command says so."""
    monkeypatch.setattr(limits, "DEFAULT_MEMORY", 1 << 20)
    source, target = mesh_file(tmp_path), str(tmp_path / "a.dmesh")
    assert commandline.cli("encode", source, target) == 0
    note = "more memory than its default limit: give deltamesh decode --memory 1G"
    assert note in capsys.readouterr().err
    assert commandline.cli("encode -f -q", source, target) == 0
    assert "memory" not in capsys.readouterr().err
    assert commandline.cli("batch -f", source) == 0
    assert note in capsys.readouterr().err
    assert commandline.cli("batch -f -q", source) == 0
    assert capsys.readouterr().err == ""
