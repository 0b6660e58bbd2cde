"""Header of a file: counts, versions, and signatures of something else."""

from __future__ import annotations

import struct
import zlib

import pytest
from containers import pieces, refused, written
from hypothesis import given
from hypothesis import strategies as st

from deltamesh_formats.container import layout
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.header import read_header, write_header
from deltamesh_formats.container.reader import read_container


def header(vertices=1000, triangles=2000, version=layout.VERSION, reserved=0):
    counts = write_varint(vertices) + write_varint(triangles)
    raw = layout.MAGIC + struct.pack("<HH", version, reserved) + counts
    return raw + struct.pack("<I", zlib.crc32(raw))


@given(st.integers(0, 2**40), st.integers(0, 2**40))
def test_counts_come_back(vertices, triangles):
    data = write_header(layout.VERSION, vertices, triangles)
    assert data == header(vertices, triangles)
    values, end = read_header(memoryview(data + b"PARM"))
    assert (values["vertices"], values["triangles"], end) == (vertices, triangles, len(data))


def test_empty_input():
    assert refused(b"", "empty") == 0


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"\r\n", b"\n"),
        (b"\n", b"\r\n"),
        (b"\n", b"\r"),
        (b"\x89", b"\x09"),
        (b"\x89", b"\xc2\x89"),
        (b"\x89", b"\xef\xbf\xbd"),
    ],
)
def test_text_transfer_is_recognized(old, new):
    refused(written().replace(old, new), "as text")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"ply\nformat ascii 1.0\n", r"a mesh file \(PLY\)"),
        (b"glTF\2\0\0\0", r"a mesh file \(GLB\)"),
        (b"OFF\n8 6 12\n", r"a mesh file \(OFF\)"),
        (b"solid cube\n", r"a mesh file \(STL\)"),
        (b"\x89PNG\r\n\x1a\n" + bytes(50), "not a .dmesh file"),
        (b"v", "not a .dmesh file"),
    ],
)
def test_other_files_are_named(data, message):
    assert refused(data, message) == 0


def test_versions_and_reserved_bits():
    rest = b"".join(pieces(written())[1].values())
    assert read_container(header() + rest)
    assert refused(header(version=5) + b"anything", "version 5 needs a newer deltamesh") == 8
    for old in (1, 2, 3):
        message = f"version {old} needs an older deltamesh, this one reads 4"
        assert refused(header(version=old) + rest, message) == 8
    assert refused(header(version=0) + rest, "no container version 0") == 8
    for bit in range(16):
        assert refused(header(reserved=1 << bit) + rest, "reserved .* newer deltamesh") == 10


def test_huge_counts_are_refused():
    rest = b"".join(pieces(written())[1].values())
    assert read_container(header(2**40, 2**40) + rest)
    assert refused(header(2**40 + 1, 0) + rest, "vertices, more than") == 12
    assert refused(header(0, 2**63 - 1) + rest, "triangles, more than") == 13
    crafted = header()[:12] + b"\x80\x00" + bytes(6)
    assert refused(crafted + rest, "longer than it needs") == 12
