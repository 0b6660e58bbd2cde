"""Parts of the reader and the writer of PLY: header, properties, body, records."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles import text
from deltamesh_formats.meshfiles.ply.body import Ascii, Binary
from deltamesh_formats.meshfiles.ply.header import Element, Property, read_header
from deltamesh_formats.meshfiles.ply.properties import GROUPS, NAMES, TYPES, properties_of, role_of
from deltamesh_formats.meshfiles.ply.records import read_rows

# ---- Header ------------------------------------------------------------------------------------

HEADER = """ply
format binary_little_endian 1.0
comment made by hand
obj_info from a scan
element vertex 3
property float x
property uchar y
element face 1
property list uchar int vertex_indices
end_header
"""


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_headers_have_elements_in_their_order(end: str) -> None:
    data = HEADER.replace("\n", end).encode()
    found = read_header(data + b"\nbody")
    assert found.order == "<"
    assert found.body == len(data)
    assert found.elements == [
        Element("vertex", 3, [Property("x", "f4"), Property("y", "u1")]),
        Element("face", 1, [Property("vertex_indices", "i4", "u1")]),
    ]
    assert (found.comments, found.obj_info) == (["made by hand"], ["from a scan"])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("ply\n", "plyx\n", "does not begin with 'ply'"),
        ("end_header\n", "", "its header has no end"),
        ("format binary_little_endian 1.0\n", "", "its header has no format"),
        ("binary_little_endian", "binary_middle_endian", "line 2: not a line of a PLY header"),
        ("vertex 3", "vertex -3", "line 5"),
        ("vertex 3", "vertex three", "line 5"),
        ("element vertex 3\n", "", "line 5"),  # a property without an element
        ("property float x", "property real x", "line 6"),
        ("property float x", "property float", "line 6"),
        ("list uchar", "list float", "line 9"),
        ("property float x", "propertx float x", "line 6"),
    ],
)
def test_headers_that_are_none_are_refused(old: str, new: str, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        read_header(HEADER.replace(old, new).encode())


# ---- Properties --------------------------------------------------------------------------------


def test_types_have_one_name_that_is_written() -> None:
    assert {TYPES[name] for name in NAMES.values()} == set(NAMES)
    assert all(TYPES[name] == kind for kind, name in NAMES.items())


@pytest.mark.parametrize("group", GROUPS, ids=lambda group: "_".join(group.properties))
def test_properties_of_an_attribute_are_those_of_its_group(group) -> None:
    found = properties_of(group.name, len(group.properties))
    assert found == next(
        one.properties
        for one in GROUPS
        if (one.name, len(one.properties)) == (group.name, len(group.properties))
    )


def test_other_attributes_have_numbered_properties() -> None:
    assert properties_of("heat", 1) == ("heat",)
    assert properties_of("flow", 3) == ("flow_0", "flow_1", "flow_2")
    assert [role_of(name) for name in ("normal", "uv2", "colours")] == ["normal", "uv", "other"]


# ---- Bodies and records ------------------------------------------------------------------------

FACE = [Property("id", "i4"), Property("indices", "i4", "u1"), Property("weight", "f4")]
records = st.lists(
    st.tuples(
        st.integers(-9, 9),
        st.lists(st.integers(0, 99), max_size=4),
        st.floats(-1e3, 1e3, width=32),
    ),
    min_size=1,
    max_size=6,
)


def packed(rows, order: str) -> bytes:
    return b"".join(
        struct.pack(f"{order}iB{len(indices)}if", number, len(indices), *indices, weight)
        for number, indices, weight in rows
    )


def spelled(rows) -> bytes:
    lines = [" ".join(map(str, (i, len(some), *some, repr(w)))) for i, some, w in rows]
    return "\n".join(lines).encode()


@given(records, st.sampled_from(["<", ">", "text"]))
def test_records_are_columns_whatever_the_lengths_of_their_lists(rows, order: str) -> None:
    if order == "text":
        body = Ascii(text.split_lines(b"0 0\n" + spelled(rows)))
        start = 2
    else:
        body, start = Binary(b"??" + packed(rows, order), order), 2
    columns, end = read_rows(body, start, Element("face", len(rows), FACE))
    assert end == len(body.cells)
    assert columns["id"].values.tolist() == [row[0] for row in rows]
    assert columns["indices"].counts.tolist() == [len(row[1]) for row in rows]
    assert columns["indices"].values.tolist() == [i for row in rows for i in row[1]]
    assert columns["weight"].values.tolist() == [row[2] for row in rows]
    assert columns["id"].counts is None
    assert [columns[p.name].values.dtype for p in FACE] == [np.dtype(p.type) for p in FACE]


@given(records, st.integers(1, 30))
def test_records_that_are_cut_short_are_refused(rows, missing: int) -> None:
    data = packed(rows, "<")
    with pytest.raises(MeshError, match=r"bytes are left for .* records of face: is it cut short"):
        read_rows(Binary(data[:-missing], "<"), 0, Element("face", len(rows), FACE))


def test_counts_that_lie_are_refused_before_anything_is_allocated() -> None:
    with pytest.raises(MeshError, match="is it cut short"):
        read_rows(Binary(bytes(9), "<"), 0, Element("face", 10**18, FACE))
    with pytest.raises(MeshError, match=r"a list of -1 numbers \(at byte 0 of its body\)"):
        read_rows(Binary(b"\xff", "<"), 0, Element("f", 1, [Property("indices", "i4", "i1")]))


@pytest.mark.parametrize(
    ("data", "kind", "message"),
    [
        (b"1\n2.5", "u1", "line 2: '2.5' is not a whole number of 8 bits, unsigned"),
        (b"1\n-1", "u1", "line 2: '-1' is not a whole number"),
        (b"1 200", "i1", "line 1: '200' is not a whole number of 8 bits, signed"),
        (b"1 nan", "i4", "'nan' is not a whole number"),
        (b"1 one", "f4", "'one' is not a number"),
    ],
)
def test_text_that_its_type_cannot_hold_is_refused(data: bytes, kind: str, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        read_rows(Ascii(text.split_lines(data)), 0, Element("e", 2, [Property("x", kind)]))


def test_integers_of_64_bits_are_read_to_the_last() -> None:
    largest = 2**63 - 1
    body = Ascii(text.split_lines(f"{largest} {-largest}".encode()))
    columns, _ = read_rows(body, 0, Element("e", 2, [Property("x", "i8")]))
    assert columns["x"].values.tolist() == [largest, -largest]


def test_a_list_in_text_has_a_whole_count() -> None:
    body = Ascii(text.split_lines(b"1.5 7"))
    with pytest.raises(MeshError, match=r"line 1: 1\.5 is not a count"):
        read_rows(body, 0, Element("e", 1, [Property("indices", "i4", "u1")]))
