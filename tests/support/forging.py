"""Files that no encoder has written, with all checksums right: for tests of what is refused."""

from __future__ import annotations

import dataclasses
import struct
import zlib

from deltamesh._pipeline.decoder import read_content
from deltamesh_formats.container import layout
from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.container.writer import write_container

UNTOUCHED = object()


def forged(
    data,
    *,
    vertices=None,
    triangles=None,
    checksum=None,
    parameters=None,
    meta=UNTOUCHED,
    **payloads,
):
    """The file with other counts, parameters, digest or payloads."""
    container = read_container(data)
    own = {s.id: bytes(s.payload) for s in container.sections.values()}
    own = {name: payload for name, payload in own.items() if name not in ("PARM", "meta", "CHEK")}
    forged = build_container(
        container.vertices if vertices is None else vertices,
        container.triangles if triangles is None else triangles,
        dataclasses.replace(container.parameters, **(parameters or {})),
        own | payloads,
        container.meta if meta is UNTOUCHED else meta,
        container.digest if checksum is None else checksum,
    )
    return write_container(forged)


def consistent(data):
    """The file with the digest of what its payloads decode to; FormatError where they do not."""
    return forged(data, checksum=read_content(read_container(data), 2**40, 2**50).digest())


def section(name, payload):
    raw = name.encode("ascii") + write_varint(len(payload)) + payload
    return raw + struct.pack("<I", zlib.crc32(raw))


def with_header(data, *, magic=layout.MAGIC, version=layout.VERSION, reserved=0):
    """The file under another header, whose checksum is right."""
    container = read_container(data)
    start = next(iter(container.sections.values())).offset
    counts = write_varint(container.vertices) + write_varint(container.triangles)
    raw = magic + struct.pack("<HH", version, reserved) + counts
    return raw + struct.pack("<I", zlib.crc32(raw)) + data[start:]
