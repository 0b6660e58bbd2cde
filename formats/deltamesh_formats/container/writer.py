"""`Container` to bytes: the mirror of `reader`."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from typing import Any

from deltamesh_formats.container import layout
from deltamesh_formats.container.layout import Field, Meta, Parameters
from deltamesh_formats.errors import MeshError


def write_container(
    vertices: int,
    faces: int,
    parameters: Parameters,
    payloads: Mapping[str, bytes],
    meta: Meta | None,
    digest: bytes,
) -> bytes:
    """Return the bytes of a `.dmesh` file; `reader.read_container` takes them apart again.

    Parameters
    ----------
    vertices, faces : int
        Counts of the decoded mesh.
    parameters : Parameters
    payloads : mapping of section id to bytes
        The sections that are the codec's own: `CONN`, `STCH` and `COPY` where they are needed,
        those of the method, `FIXS`, `PART` and `ORDR` where they are needed. Ids unknown
        to this version must be optional ones; they come last, in their order.
    meta : Meta or None
    digest : bytes, 8
        Of the decoded integers.

    Raises
    ------
    MeshError
        When a value is outside what the format holds.
    ValueError
        For payloads that do not belong to the method, too many of them, or a digest of another
        size.
    """
    _check_counts(vertices, faces)
    required = layout.required(parameters.method, payloads)[1:]
    others = [name for name in payloads if name not in required]
    if not set(required) <= set(payloads):
        raise ValueError(f"the payloads are {list(payloads)}, not {required}")
    if any(name in layout.KNOWN or not _is_optional_id(name) for name in others):
        raise ValueError(f"not ids of optional sections: {others}")
    if len(others) + len(required) + 3 > layout.MAX_SECTIONS:
        raise ValueError(f"more than {layout.MAX_SECTIONS} sections")
    if len(digest) != layout.DIGEST_SIZE:
        raise ValueError(f"a digest of {len(digest)} bytes, not {layout.DIGEST_SIZE}")
    parts = [_header(vertices, faces), _parameters(parameters, vertices)]
    parts += [_section(name, payloads[name]) for name in required]
    parts += [] if meta is None else [_meta(meta)]
    parts += [_section(name, payloads[name]) for name in others]
    parts += [_section(layout.CHECK, _fields(layout.CHECK_FIELDS, {"digest": digest}))]
    return b"".join(parts)


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


def _fields(fields: tuple[Field, ...], values: Mapping[str, Any]) -> bytes:
    """Return the bytes of a byte table."""
    parts = []
    for name, kind in fields:
        try:
            parts.append(_field(values[name], kind))
        except (ValueError, OverflowError, struct.error) as error:
            raise MeshError(f"the file cannot hold {name} = {values[name]!r}: {error}") from None
    return b"".join(parts)


def _with_crc(raw: bytes) -> bytes:
    return raw + _field(zlib.crc32(raw), "u32")


def _header(vertices: int, faces: int) -> bytes:
    values = {
        "magic": layout.MAGIC,
        "version": layout.VERSION,
        "reserved": 0,
        "vertices": vertices,
        "faces": faces,
    }
    return _with_crc(_fields(layout.HEADER_FIELDS[:-1], values))


def _check_counts(vertices: int, faces: int) -> None:
    for name, count in (("vertices", vertices), ("faces", faces)):
        if not 0 <= count <= layout.MAX_COUNT:
            raise MeshError(f"{count} {name}, outside 0..{layout.MAX_COUNT}")


def _is_optional_id(name: str) -> bool:
    is_id = len(name) == layout.ID_SIZE and name.isascii() and name.isalpha()
    return is_id and name[0].islower()


def _section(name: str, payload: bytes) -> bytes:
    return _with_crc(name.encode("ascii") + write_varint(len(payload)) + payload)


def _parameters(parameters: Parameters, vertices: int) -> bytes:
    for _, message in layout.parameter_faults(parameters, vertices):
        raise MeshError(f"cannot be written: {message}")
    values = {
        "method": layout.METHODS[parameters.method].id,
        "flags": parameters.diffusion * layout.FLAG_DIFFUSION
        | parameters.single * layout.FLAG_SINGLE,
        "anchor_method": layout.ANCHOR_METHODS[parameters.anchor_method],
        "bits": layout.BITS_FROM_STEP if parameters.bits is None else parameters.bits,
        "step": parameters.step,
        "origin_x": parameters.origin[0],
        "origin_y": parameters.origin[1],
        "origin_z": parameters.origin[2],
        "anchor_step": parameters.anchor_step,
        "seed": parameters.seed,
        "anchor_count": parameters.anchor_count,
        "isolated": parameters.isolated,
        "coarse": parameters.coarse,
        "dead_zone": round(parameters.dead_zone * layout.ZONE_UNIT),
        "normal_dead_zone": round(parameters.normal_dead_zone * layout.ZONE_UNIT),
    }
    return _section(layout.PARAMETERS, _fields(layout.PARAMETER_FIELDS, values))


def _meta(meta: Meta) -> bytes:
    for _, message in layout.meta_faults(meta):
        raise MeshError(f"cannot be written: {message}")
    return _section(layout.META, _fields(layout.META_FIELDS, vars(meta)))
