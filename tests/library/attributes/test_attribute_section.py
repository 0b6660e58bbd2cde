"""Section of the attributes, without a file around it: payload, integers and values."""

from __future__ import annotations

from dataclasses import replace

import attributed
import numpy as np
import pytest
from drafts import stages_of
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._attributes.candidates import AttributeSettings
from deltamesh._attributes.domains import Domains
from deltamesh._attributes.section import (
    CodedAttribute,
    decode_attributes,
    encode_attributes,
    restore_attribute,
)
from deltamesh_formats.container.attribute_table import read_table, write_table
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import PolyMesh

QUADS = attributed.with_all(attributed.quads())
MESHES = {
    "colours": replace(attributed.triangles(), attributes=()),
    "integers": attributed.triangles(),
    "quads": QUADS,
    "split": attributed.with_all(attributed.with_copies()),
}
MESHES["colours"] = replace(
    MESHES["colours"], attributes=tuple(attributed.colours(MESHES["colours"]))
)
MESHES["integers"] = replace(
    MESHES["integers"], attributes=tuple(attributed.integers(MESHES["integers"]))
)


def encoded(mesh: PolyMesh) -> tuple[bytes, tuple[CodedAttribute, ...], Domains]:
    draft = list(stages_of(mesh).values())[-1].after
    domains, provenance = Domains(draft.structure), draft.provenance
    positions = mesh.vertices[provenance.vertices]
    settings = AttributeSettings(12, 10, False, positions, 1e-9)
    payload, coded = encode_attributes(mesh, provenance, domains, settings)
    return payload, coded, domains


def assert_same_arrays(one: tuple[CodedAttribute, ...], other: tuple[CodedAttribute, ...]) -> None:
    # Origins of integers count modulo 2^64.
    tables = [write_table(tuple(coded.entry for coded in some)) for some in (one, other)]
    assert tables[0] == tables[1]
    arrays = [[array for coded in some for array in coded.arrays] for some in (one, other)]
    assert len(arrays[0]) == 4 * len(one)
    for a, b in zip(*arrays, strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("name", MESHES)
def test_the_decoder_has_the_integers_of_the_encoder(name: str) -> None:
    payload, coded, domains = encoded(MESHES[name])
    found = decode_attributes(memoryview(payload), domains)
    assert_same_arrays(found, coded)
    assert [one.entry.name for one in found] == [a.name for a in MESHES[name].attributes]


@pytest.mark.parametrize("name", ["colours", "integers"])
def test_values_come_back_where_they_were(name: str) -> None:
    mesh = MESHES[name]
    draft = list(stages_of(mesh).values())[-1].after
    payload, _, domains = encoded(mesh)
    p, V = draft.provenance, mesh.vertices[draft.provenance.vertices]
    places = {"vertex": p.vertices, "corner": p.corners, "face": p.polygons}
    found = decode_attributes(memoryview(payload), domains)
    for given_, coded in zip(mesh.attributes, found, strict=True):
        restored = restore_attribute(coded, domains, V)
        rows, at = restored.rows(), given_.rows()[places[given_.domain]]
        assert ((rows < 0) == (at < 0)).all()
        values, wanted = restored.values[rows[rows >= 0]], given_.values[at[at >= 0]]
        assert values.dtype == wanted.dtype
        np.testing.assert_allclose(values, wanted, rtol=0, atol=coded.entry.error)


@given(st.integers(0, 10**6), st.integers(0, 7))
def test_a_flipped_bit_is_refused_within_the_payload_or_means_something_else(
    at: int, bit: int
) -> None:
    payload, _, domains = ENCODED
    damaged = bytearray(payload)
    damaged[at % len(payload)] ^= 1 << bit
    offset, found = None, ()
    try:
        found = decode_attributes(memoryview(damaged), domains)
    except FormatError as error:
        offset = error.offset
    if offset is None:
        entries, _ = read_table(bytes(damaged))
        assert tuple(one.entry for one in found) == entries
    else:
        assert 0 <= offset <= len(payload)


ENCODED = encoded(QUADS)


def test_streams_of_other_sizes_than_the_table_has_are_refused() -> None:
    payload, _, domains = ENCODED
    entries, at = read_table(payload)
    more = write_table(entries) + payload[at:] + b"\0"
    for data in (more, payload[:-1], b"", b"\0"):
        with pytest.raises(FormatError):
            decode_attributes(memoryview(data), domains)
