"""Writer of the `.dmesh` container: a `Container` becomes bytes."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from typing import Any

from deltamesh_formats.container import layout
from deltamesh_formats.container.container import Container, Meta, Parameters, Section
from deltamesh_formats.container.layout import Field
from deltamesh_formats.errors import MeshError


def write_container(container: Container) -> bytes:
    """Return the bytes of a `.dmesh` file; `reader.read_container` takes them apart again.

    Parameters
    ----------
    container : Container
        From `building.build_container` or `reader.read_container`. The payloads of its sections are
        written as they are.
    """
    c = container
    header = write_header(c.version, c.vertices, c.triangles)
    return b"".join([header, *map(_section, c.sections.values())])


def write_header(version: int, vertices: int, triangles: int) -> bytes:
    """Return the bytes of a header.

    Raises
    ------
    MeshError
        For a count that the format does not hold.
    """
    for name, count in (("vertices", vertices), ("triangles", triangles)):
        if not 0 <= count <= layout.MAX_COUNT:
            raise MeshError(f"{count} {name}, outside 0..{layout.MAX_COUNT}")
    values = {
        "magic": layout.MAGIC,
        "version": version,
        "reserved": 0,
        "vertices": vertices,
        "triangles": triangles,
    }
    return _with_crc(write_fields(layout.HEADER_FIELDS[:-1], values))


def write_parameters(parameters: Parameters) -> bytes:
    """Return the payload of `PARM`.

    Raises
    ------
    MeshError
        For a value that its field does not hold.
    """
    p = parameters
    flags = p.diffusion * layout.FLAG_DIFFUSION | p.single * layout.FLAG_SINGLE
    values = {
        "method": layout.METHODS[p.method].id,
        "flags": flags | p.interpolated * layout.FLAG_INTERPOLATED,
        "anchor_method": layout.ANCHOR_METHODS[p.anchor_method],
        "bits": layout.BITS_FROM_STEP if p.bits is None else p.bits,
        "step": p.step,
        "origin_x": p.origin[0],
        "origin_y": p.origin[1],
        "origin_z": p.origin[2],
        "anchor_step": p.anchor_step,
        "seed": p.seed,
        "anchor_count": p.anchor_count,
        "isolated": p.isolated,
        "coarse": p.coarse,
        "dead_zone": round(p.dead_zone * layout.ZONE_UNIT),
        "normal_dead_zone": round(p.normal_dead_zone * layout.ZONE_UNIT),
    }
    fields: tuple[Field, ...] = layout.PARAMETER_FIELDS
    if p.anchor_method == layout.RANDOM:
        fields += layout.SEED_FIELDS
    return write_fields(fields, values)


def write_meta(meta: Meta) -> bytes:
    """Return the payload of `meta`.

    Raises
    ------
    MeshError
        For a value that its field does not hold.
    """
    fields: tuple[Field, ...] = layout.META_FIELDS
    if meta.has_losses:
        fields += layout.META_LOSS_FIELDS
    if meta.parts > 1:
        fields += layout.META_PART_FIELDS
    return write_fields(fields, vars(meta))


def write_digest(digest: bytes) -> bytes:
    """Return the payload of `CHEK`."""
    return write_fields(layout.CHECK_FIELDS, {"digest": digest})


def write_varint(value: int) -> bytes:
    """Return the shortest unsigned LEB128 form of a number from 0 to 2**63 - 1."""
    if not 0 <= value <= layout.VARINT_MAX:
        raise ValueError(f"{value} is outside the range of a varint")
    out = bytearray()
    while value >= 0x80:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
    return bytes(out)


def _string(text: str) -> bytes:
    raw = text.encode()
    if len(raw) > layout.STRING_MAX_BYTES:
        raise ValueError(f"more than {layout.STRING_MAX_BYTES} bytes: {text[:20]!r}...")
    return bytes([len(raw)]) + raw


def _field(value: Any, kind: str) -> bytes:
    if kind == "varint":
        return write_varint(value)
    if kind == "string":
        return _string(value)
    return layout.STRUCT_CODES[kind].pack(value)


def write_fields(fields: tuple[Field, ...], values: Mapping[str, Any]) -> bytes:
    """Return the bytes of a byte table."""
    parts = []
    for name, kind in fields:
        try:
            parts.append(_field(values[name], kind))
        except (ValueError, OverflowError, struct.error) as error:
            raise MeshError(f"the file cannot hold {name} = {values[name]!r}: {error}") from None
    return b"".join(parts)


def _section(section: Section) -> bytes:
    length = write_varint(len(section.payload))
    return _with_crc(section.id.encode("ascii") + length + section.payload)


def _with_crc(raw: bytes) -> bytes:
    return raw + _field(zlib.crc32(raw), "u32")
