"""Containers: what is written is what is read, section by section."""

from __future__ import annotations

import pytest
from containers import CARTESIAN, DIGEST, HIGHPASS, META, PAYLOADS, written
from hypothesis import given, settings
from hypothesis import strategies as st

from deltamesh_formats.container import layout, method_layouts
from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.container import Meta, Parameters
from deltamesh_formats.container.fields import VARINT_MAX
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.container.writer import write_container


@pytest.mark.parametrize("parameters", [HIGHPASS, CARTESIAN], ids=lambda p: p.method)
@pytest.mark.parametrize("meta", [META, None], ids=["meta", "bare"])
def test_reader_mirrors_writer(parameters, meta):
    data = written(parameters, meta)
    container = read_container(data)
    assert (container.vertices, container.triangles) == (1000, 2000)
    assert (container.version, container.digest, container.size) == (
        layout.VERSION,
        DIGEST,
        len(data),
    )
    assert (container.parameters, container.meta) == (parameters, meta)
    for name, payload in PAYLOADS[parameters.method].items():
        assert container.sections[name].payload == payload
    start = next(iter(container.sections.values())).offset
    assert start + sum(s.size for s in container.sections.values()) == len(data)
    assert written(parameters, meta) == data


def test_payloads_are_views_of_any_buffer():
    data = written()
    container = read_container(memoryview(bytearray(data)))
    assert isinstance(container.sections["DELT"].payload, memoryview)
    assert container == read_container(data)


finite = st.floats(allow_nan=False, allow_infinity=False)
positive = st.floats(min_value=5e-324, allow_infinity=False)
not_negative = st.floats(min_value=0, allow_infinity=False)
single = st.floats(min_value=0, allow_infinity=False, width=32)
names = st.text(max_size=60).filter(lambda s: s.isprintable() and len(s.encode()) <= 255)
halvings = st.integers(0, 255)
errors = (not_negative, not_negative, single, single, not_negative, halvings, names, names)
several = {
    "parts": st.integers(2, VARINT_MAX),
    "part": names,
    "part_normal": single,
    "part_rms": not_negative,
}
faces = {name: st.integers(0, VARINT_MAX) for name in ("lost", "turned")}
metas = st.builds(Meta, *errors, **faces) | st.builds(Meta, *errors, **faces, **several)
origins = st.tuples(finite, finite, finite)
seeds = st.integers(0, 2**64 - 1)


@st.composite
def containers(draw):
    vertices, triangles = draw(st.integers(0, 2**40)), draw(st.integers(0, 2**40))
    method, counts = draw(st.sampled_from(list(method_layouts.METHODS))), st.integers(0, vertices)
    bits = draw(st.none() | st.integers(0, layout.MAX_BITS))
    anchored, lossless = method in ("highpass", "refined"), method == "lossless"
    bits = None if lossless else bits
    hundredths = st.integers(0, 255).map(lambda n: n / 100)
    chosen = draw(st.sampled_from(["farthest", "random", "greedy"])) if anchored else None
    parameters = Parameters(
        method,
        draw(st.booleans()),
        chosen,
        bits,
        0.0 if lossless or (method == "highpass" and bits == 0) else draw(positive),
        (0.0, 0.0, 0.0) if lossless else draw(origins),
        draw(not_negative) if anchored else 0.0,
        draw(seeds) if chosen == "random" else 0,
        draw(counts) if anchored else 0,
        draw(counts),
        draw(st.floats(1, 2**100, width=32)) if method == "refined" else 1.0,
        draw(hundredths),
        draw(hundredths),
        draw(st.booleans()),
    )
    further = method_layouts.METHODS[method].further
    needed = draw(st.sets(st.sampled_from((*layout.AFTER_CONNECTIVITY, *further))))
    required = method_layouts.required(method, needed)[1:]
    payloads = {name: draw(st.binary(max_size=300)) for name in required}
    ids = st.from_regex(r"[a-z][A-Za-z]{3}", fullmatch=True).filter(lambda i: i != "meta")
    payloads |= draw(st.dictionaries(ids, st.binary(max_size=20), max_size=3))
    return (
        vertices,
        triangles,
        parameters,
        payloads,
        draw(st.none() | metas),
        draw(st.binary(min_size=8, max_size=8)),
    )


@settings(deadline=None)
@given(containers())
def test_any_container_comes_back(arguments):
    vertices, triangles, parameters, payloads, meta, digest = arguments
    container = build_container(*arguments)
    data = write_container(container)
    assert read_container(data) == container
    assert list(read_container(data).sections) == list(container.sections)
    assert len(data) == container.size
    assert (container.vertices, container.triangles) == (vertices, triangles)
    assert (container.parameters, container.meta) == (parameters, meta)
    assert container.digest == digest
    assert {i: s.payload for i, s in container.sections.items() if i in payloads} == payloads
    assert list(container.sections)[-1] == "CHEK"


def test_sections_know_their_place():
    data = written(CARTESIAN, CONN=bytes(200), CART=bytes(20_000))
    for one in read_container(data).sections.values():
        assert data[one.offset : one.offset + 4].decode() == one.id
        assert data[one.start : one.start + len(one.payload)] == one.payload
        assert one.end == one.offset + one.size == one.start + len(one.payload) + 4
