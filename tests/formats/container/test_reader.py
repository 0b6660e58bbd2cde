"""Reader of containers: everything that must be refused."""

from __future__ import annotations

import io
import math
import struct
import zlib
from contextlib import suppress

import meshes
import pytest
from containers import CARTESIAN, HIGHPASS, PAYLOADS, pieces, refused, with_parameters, written
from forging import section
from hypothesis import given, settings
from hypothesis import strategies as st
from spec_tables import spec_offset

import deltamesh
from deltamesh_formats.container import layout
from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.reader import read_container, read_source_format, read_varint
from deltamesh_formats.container.writer import write_container, write_varint
from deltamesh_formats.errors import FormatError


def header(vertices=1000, triangles=2000, version=layout.VERSION, reserved=0):
    counts = write_varint(vertices) + write_varint(triangles)
    raw = layout.MAGIC + struct.pack("<HH", version, reserved) + counts
    return raw + struct.pack("<I", zlib.crc32(raw))


@settings(deadline=None)
@given(st.binary(max_size=100), st.booleans())
def test_arbitrary_bytes_are_refused(data, with_magic):
    with pytest.raises(FormatError):
        read_container(layout.MAGIC + data if with_magic else data)


@settings(deadline=None)
@given(st.binary(max_size=60), st.sampled_from(["PARM", "meta", "CHEK"]))
def test_arbitrary_payloads_are_read_or_refused(payload, name):
    """Behind valid checksums: whatever is read can be written, byte for byte."""
    start, parts = pieces(written())
    data = start + b"".join(section(i, payload) if i == name else p for i, p in parts.items())
    try:
        found = read_container(data)
    except FormatError:
        return
    payloads = {i: bytes(found.sections[i].payload) for i in PAYLOADS["highpass"]}
    again = build_container(
        found.vertices, found.triangles, found.parameters, payloads, found.meta, found.digest
    )
    # The flags have unused bits, which are ignored and not kept.
    assert again.size == len(data)
    assert write_container(found) == data


@pytest.mark.parametrize(
    ("data", "offset"),
    [
        (b"", 0),
        (b"\x80", 1),
        (b"\xff" * 8, 8),
        (b"\x80\x00", 0),
        (b"\xff\x80\x00", 0),
        (b"\xff" * 9, 0),
        (b"\xff" * 9 + b"\x01", 0),
    ],
)
def test_malformed_varints_are_refused(data, offset):
    with pytest.raises(FormatError) as caught:
        read_varint(data, 0)
    assert caught.value.offset == offset


@pytest.mark.parametrize("parameters", [HIGHPASS, CARTESIAN], ids=lambda p: p.method)
def test_every_truncation_is_refused(parameters):
    data = written(parameters, abcd=b"unknown")
    for size in range(1, len(data)):
        assert refused(data[:size], "truncated") == size


@pytest.mark.parametrize("extra", [b"\0", b"\x89", written()], ids=["zero", "byte", "file"])
def test_appended_bytes_are_refused(extra):
    data = written()
    assert refused(data + extra, f"{len(extra)} bytes follow") == len(data)


def test_every_bit_flip_is_refused():
    data = written(abcd=b"unknown")
    for i in range(8 * len(data)):
        flipped = bytearray(data)
        flipped[i // 8] ^= 1 << i % 8
        refused(flipped)


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


def test_a_section_longer_than_the_file():
    start, parts = pieces(written())
    huge = b"CONN" + write_varint(2**63 - 1)
    refused(start + parts["PARM"] + huge + bytes(20), "truncated: section CONN at byte .* 16 are")


@pytest.mark.parametrize(
    ("order", "message"),
    [
        ("CONN ANCH DELT meta CHEK", "PARM is missing"),
        ("PARM ANCH DELT meta CHEK", "CONN is missing"),
        ("PARM CONN DELT CHEK", "ANCH is missing"),
        ("PARM CONN ANCH meta CHEK", "DELT is missing"),
        ("PARM CHEK", "CONN is missing"),
        ("CHEK", "PARM is missing"),
        ("PARM CONN ANCH DELT meta", "truncated: section CHEK is missing"),
        ("", "truncated: section CHEK is missing"),
        ("PARM ANCH CONN DELT CHEK", "CONN is missing, ANCH is in its place"),
        ("PARM CONN ANCH DELT CART CHEK", "CART has no place here in a highpass file"),
        ("PARM CONN ANCH DELT abcd meta CHEK", "meta has no place"),
        ("meta PARM CONN ANCH DELT CHEK", "PARM is missing"),
        ("PARM CONN CONN ANCH DELT CHEK", "CONN comes a second time"),
        ("PARM CONN ANCH DELT meta meta CHEK", "meta comes a second time"),
        ("PARM CONN ANCH DELT CHEK meta", "bytes follow the last section"),
        ("PARM CONN COPY STCH ANCH DELT CHEK", "STCH is missing, COPY is in its place"),
        ("PARM STCH CONN ANCH DELT CHEK", "CONN is missing, STCH is in its place"),
        ("PARM CONN ANCH DELT STCH CHEK", "STCH is missing, ANCH is in its place"),
        ("PARM CONN ANCH DELT WXYZ CHEK", "WXYZ is unknown: it needs a newer deltamesh"),
    ],
)
def test_sections_out_of_order(order, message):
    start, parts = pieces(written())
    parts |= {name: section(name, b"?") for name in ("CART", "STCH", "COPY", "abcd", "WXYZ")}
    refused(start + b"".join(parts[name] for name in order.split()), message)


def test_unknown_optional_sections_are_skipped():
    container = read_container(written(abcd=b"x", eFGH=b""))
    assert list(container.sections)[-4:] == ["meta", "abcd", "eFGH", "CHEK"]
    assert container.parameters == HIGHPASS


@pytest.mark.parametrize("name", [b"AB1D", b"\0\0\0\0", b"AB D", "é".encode() * 2])
def test_ids_are_letters(name):
    start, parts = pieces(written())
    assert refused(start + parts["PARM"] + name + bytes(10), "cannot be called") == len(
        start + parts["PARM"]
    )


def test_too_many_sections():
    ids = [f"x{chr(97 + i % 26)}{chr(97 + i // 26)}z" for i in range(61)]
    start, parts = pieces(written(meta=None))
    check = parts.pop("CHEK")
    body = start + b"".join(parts.values())
    full = body + b"".join(section(i, b"") for i in ids[:59]) + check
    assert len(read_container(full).sections) == 64
    refused(body + b"".join(section(i, b"") for i in ids) + check, "more than 64 sections")
    with pytest.raises(ValueError, match="64 sections"):
        written(meta=None, **dict.fromkeys(ids, b""))


@pytest.mark.parametrize(
    ("changes", "field", "message"),
    [
        ({"method": 4}, "method", "method 4 is unknown"),
        ({"method": 3}, "anchor_method", "method lossless with anchor method farthest"),
        ({"method": 3, "bits": 8, "anchor_method": 255}, "bits", "8 bits in a lossless file"),
        ({"method": 3, "bits": 255, "anchor_method": 255}, "step", "step of 0.001"),
        ({"method": 1}, "anchor_method", "method cartesian with anchor method farthest"),
        ({"anchor_method": 3}, "anchor_method", "anchor method 3 is unknown"),
        ({"anchor_method": 255}, "anchor_method", "method highpass with anchor method none"),
        ({"bits": 63}, "bits", "63 bits"),
        ({"step": float("nan")}, "step", "step of nan"),
        ({"step": float("inf")}, "step", "step of inf"),
        ({"step": -1.0}, "step", "step of -1"),
        ({"step": 0.0}, "step", "step of 0"),
        ({"bits": 0}, "step", "step of 0.001"),
        ({"origin_y": float("nan")}, "origin_y", "origin of nan"),
        ({"anchor_step": float("-inf")}, "anchor_step", "anchor step of -inf"),
        ({"coarse": 2.0}, "coarse", "method highpass with deltas 2.0 times as coarse"),
        ({"coarse": float("nan")}, "coarse", "method highpass with deltas nan times as coarse"),
        ({"method": 2, "coarse": 0.5}, "coarse", "method refined with deltas 0.5 times as coarse"),
        ({"anchor_count": 1001}, "anchor_count", "1001 anchor vertices among 1000"),
        ({"isolated": 2**63 - 1}, "isolated", "isolated vertices among 1000"),
        ({"extra": b"\0"}, None, "PARM: 1 bytes follow the last field"),
    ],
)
def test_parameters_out_of_range(changes, field, message):
    data = with_parameters(**changes)
    offset = refused(data, message)
    if field in changes and field != "isolated":
        read = read_container(written()).sections["PARM"]
        assert offset == read.offset + 5 + spec_offset("4.1", field)


def test_unused_flags_are_ignored():
    assert read_container(with_parameters(flags=0xFF)).parameters.diffusion
    assert not read_container(with_parameters(flags=0xFE)).parameters.diffusion
    for flags, single in ((0xFF, True), (0xFD, False), (2, True), (0, False)):
        assert read_container(with_parameters(flags=flags)).parameters.single is single


@pytest.mark.parametrize("cut", range(1, 20))
def test_a_short_parameter_payload(cut):
    start, parts = pieces(written())
    payload = bytes(read_container(written()).sections["PARM"].payload)
    parts["PARM"] = section("PARM", payload[:-cut])
    refused(start + b"".join(parts.values()), "truncated")


# Numbers and names of a `meta` that goes on with two parts.
PARTS = bytes(33) + b"\0\0\0\0\2"


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        (struct.pack("<ddffd", 1, 1, 1, 1, float("nan")) + b"\0\0\0", "diagonal is nan"),
        (struct.pack("<ddffd", -1, 1, 1, 1, 1) + b"\0\0\0", "rms is -1"),
        (bytes(33) + b"\1\x1b\0", "control characters"),
        (bytes(33) + b"\1\xff\0", "not UTF-8"),
        (bytes(33) + b"\0\1", "truncated"),
        (bytes(33) + b"\0\0\1", "meta: truncated"),
        (bytes(33) + b"\0\0\1\2\1\0", "meta: 1 bytes follow the last field"),
        (bytes(33) + b"\0\0\0\0\1", "no faces are lost or turned, and there is one part"),
        (bytes(33) + b"\0\0\1\0\0", "0 parts"),
        (bytes(33) + b"\0\0\0\0\2", "meta: truncated"),
        (PARTS + struct.pack("<fd", -1, 1) + b"\0", "part_normal is -1"),
        (PARTS + struct.pack("<fd", 1, math.inf) + b"\0", "part_rms is inf"),
        (PARTS + struct.pack("<fd", 1, 1) + b"\1\n", "the part name holds control characters"),
        (PARTS + struct.pack("<fd", 1, 1) + b"\1n\0", "meta: 1 bytes follow the last field"),
    ],
)
def test_meta_out_of_range(payload, message):
    start, parts = pieces(written())
    parts["meta"] = section("meta", payload)
    refused(start + b"".join(parts.values()), message)


def test_the_digest_has_its_size():
    start, parts = pieces(written())
    for payload, message in (
        (b"1234567", "truncated"),
        (b"123456789", "CHEK: 1 bytes follow the last field"),
    ):
        parts["CHEK"] = section("CHEK", payload)
        refused(start + b"".join(parts.values()), message)


class Counted(io.BytesIO):
    """A file that counts the bytes that are read."""

    count = 0

    def read(self, size: int | None = -1) -> bytes:
        data = super().read(size)
        self.count += len(data)
        return data


def test_the_source_format_is_read_without_the_payloads():
    for parameters in (CARTESIAN, HIGHPASS):
        assert read_source_format(io.BytesIO(written(parameters))) == "ply"
        assert read_source_format(io.BytesIO(written(parameters, meta=None))) == ""
    large = deltamesh.encode(*meshes.torus(60, 40), source_format="obj")
    stream = Counted(large)
    assert read_source_format(stream) == "obj"
    assert stream.count < 500 < len(large)


@settings(deadline=None)
@given(st.binary(max_size=100), st.integers(0, 200))
def test_the_source_format_of_damaged_files_is_none_or_refused(data, at):
    good = written()
    for damaged in (header() + data, good[:at], good[:at] + data + good[at:]):
        with suppress(FormatError):
            assert isinstance(read_source_format(io.BytesIO(damaged)), str)
