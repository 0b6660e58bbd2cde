"""Summary of a file, as text and numbers."""

from __future__ import annotations

from dataclasses import replace

import pytest
from containers import CARTESIAN, DIGEST, HIGHPASS, META, PAYLOADS, written

from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.container import Container, Parameters
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.figures import (
    attributes_of,
    bits_per_vertex,
    finest_step,
    header_bytes,
    polygons,
    relative,
)
from deltamesh_formats.container.lines import achieved, counts
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.container.summary import container_html, container_text
from deltamesh_formats.errors import FormatError


def file_of(parameters: Parameters = CARTESIAN, **payloads: bytes) -> Container:
    own = PAYLOADS[parameters.method] | payloads
    return build_container(1000, 2000, parameters, own, META, DIGEST)


def test_bytes_of_the_header_and_of_all_sections_are_all() -> None:
    data = written()
    container = read_container(data)
    sections = sum(section.size for section in container.sections.values())
    assert header_bytes(container) + sections == len(data)


def test_counts_name_polygons_where_there_are_some() -> None:
    container = file_of()
    assert polygons(container) == 2000
    assert counts(container).startswith("1000 vertices, 2000 faces, ")
    merged = file_of(POLY=write_varint(900) + b"?")
    assert polygons(merged) == 900
    assert "900 polygons (2000 triangles)" in counts(merged)
    assert polygons(file_of(POLY=b"\xff")) == 2000  # damaged there, which decoding tells


def test_the_finest_step_is_told_without_decoding() -> None:
    assert finest_step(file_of()) == 0.5
    assert finest_step(file_of(STEP=b"\2\0\6labels")) == 0.5 * 0.7071067811865476 / 2
    for damaged in (b"", b"\0", b"\xff"):
        assert finest_step(file_of(STEP=damaged)) == 0.5


def test_rates_and_errors_are_relative() -> None:
    assert bits_per_vertex(100, 50) == 16
    assert bits_per_vertex(100, 0) == 800
    assert relative(1.0, 4.0) == 0.25
    assert relative(0.0, 0.0) == 0
    assert achieved(META).startswith("RMS 0.0625 and max 0.1562 of the diagonal")


def test_text_tells_the_parameters_that_the_method_has() -> None:
    text = container_text(file_of())
    assert "step 0.5" in text
    assert "anchors" not in text
    text = container_text(file_of(HIGHPASS))
    assert "8 bits, step 0.001, error diffusion" in text
    assert f"anchors: 200, random, seed {HIGHPASS.seed}, least-squares" in text
    assert "isolated vertices: 3" in text
    text = container_text(file_of(replace(HIGHPASS, anchor_method="random", seed=9)))
    assert "anchors: 200, random, seed 9" in text
    through = replace(HIGHPASS, interpolated=True)
    assert f"anchors: 200, random, seed {HIGHPASS.seed}, interpolated" in container_text(
        file_of(through)
    )
    assert (through.solution, CARTESIAN.solution) == ("interpolated", None)
    text = container_text(file_of(replace(HIGHPASS, bits=None), STEP=b"\3\0\x28\x02labels"))
    assert "step 0.001 down to 9.766e-07, error diffusion" in text
    for name in ("CONN", "ANCH", "DELT", "total"):
        assert name in text
        assert f"<td>{name}</td>" in container_html(file_of(HIGHPASS))


def test_a_damaged_table_of_attributes_is_told() -> None:
    assert attributes_of(file_of()) == ()
    with pytest.raises(FormatError):
        attributes_of(file_of(ATTR=b"?"))
