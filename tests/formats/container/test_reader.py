"""Reader of containers: everything that must be refused."""

from __future__ import annotations

import io
from contextlib import suppress

import meshes
import pytest
from containers import CARTESIAN, HIGHPASS, PAYLOADS, pieces, refused, written
from forging import section
from hypothesis import given, settings
from hypothesis import strategies as st

import deltamesh
from deltamesh_formats.container import layout
from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.header import write_header
from deltamesh_formats.container.reader import read_container, read_source_format
from deltamesh_formats.container.writer import write_container
from deltamesh_formats.errors import FormatError

START = write_header(layout.VERSION, 1000, 2000)


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
    for damaged in (START + data, good[:at], good[:at] + data + good[at:]):
        with suppress(FormatError):
            assert isinstance(read_source_format(io.BytesIO(damaged)), str)
