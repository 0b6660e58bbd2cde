"""Fields of byte tables, both ways: what SPEC.md 1 says of numbers, strings and checksums.

Readers are small functions (view, position) -> (value, position), after tomli. Nothing is indexed
before its bytes are known to be there, and whatever is wrong raises `FormatError` with the byte
where it shows.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable, Mapping
from typing import Any, Final, NamedTuple, TypeAlias

from deltamesh_formats.errors import FormatError, MeshError

# Anything else with a contiguous buffer, such as an mmap, goes in as a memoryview.
Buffer: TypeAlias = bytes | bytearray | memoryview


class Field(NamedTuple):
    """One field of a byte table: its name and a type of `STRUCT_CODES`, `varint` or `string`."""

    name: str
    type: str


# SPEC.md#1-conventions

# Everything is little-endian and unaligned: "<" turns the padding of `struct` off.
STRUCT_CODES: Final[Mapping[str, struct.Struct]] = {
    "u8": struct.Struct("<B"),
    "u16": struct.Struct("<H"),
    "i16": struct.Struct("<h"),
    "u32": struct.Struct("<I"),
    "u64": struct.Struct("<Q"),
    "f32": struct.Struct("<f"),
    "f64": struct.Struct("<d"),
    "bytes8": struct.Struct("<8s"),
}

# Nine bytes hold 63 bits: a value always fits a signed 64-bit integer.
VARINT_MAX_BYTES: Final = 9
VARINT_MAX: Final = 2 ** (7 * VARINT_MAX_BYTES) - 1

# A `string` has a length byte.
STRING_MAX_BYTES: Final = 255

# A checksum is a CRC-32, as in zlib and PNG.
CRC_SIZE: Final = 4


def struct_of(fields: Iterable[Field]) -> struct.Struct:
    """Return what packs a byte table of fixed size."""
    codes = (STRUCT_CODES[kind].format.removeprefix("<") for _, kind in fields)
    return struct.Struct("<" + "".join(codes))


def take(view: Buffer, position: int, size: int) -> Buffer:
    """Return `size` bytes from `position` on, or refuse at the byte where they run out."""
    if size > len(view) - position:
        left = max(len(view) - position, 0)
        raise FormatError(f"truncated: {size} bytes are needed, {left} are left", len(view))
    return view[position : position + size]


def read_varint(view: Buffer, position: int) -> tuple[int, int]:
    """Read an unsigned LEB128 number in its shortest form; return it and the position after it."""
    value = 0
    for i in range(VARINT_MAX_BYTES):
        byte = take(view, position + i, 1)[0]
        value |= (byte & 0x7F) << (7 * i)
        if byte < 0x80:
            if byte == 0 and i > 0:
                raise FormatError("a varint that is longer than it needs to be", position)
            return value, position + i + 1
    raise FormatError(f"a varint of more than {VARINT_MAX_BYTES} bytes", position)


def write_varint(value: int) -> bytes:
    """Return the shortest unsigned LEB128 form of a number from 0 to 2**63 - 1."""
    if not 0 <= value <= VARINT_MAX:
        raise ValueError(f"{value} is outside the range of a varint")
    out = bytearray()
    while value >= 0x80:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
    return bytes(out)


def varint_size(value: int) -> int:
    """Return how many bytes a varint takes."""
    return max(1, -(-value.bit_length() // 7))


def _read_string(view: Buffer, position: int) -> tuple[str, int]:
    start = position + 1
    end = start + take(view, position, 1)[0]
    try:
        return bytes(take(view, start, end - start)).decode(), end
    except UnicodeDecodeError as error:
        raise FormatError("a string that is not UTF-8", start + error.start) from None


def _write_string(text: str) -> bytes:
    raw = text.encode()
    if len(raw) > STRING_MAX_BYTES:
        raise ValueError(f"more than {STRING_MAX_BYTES} bytes: {text[:20]!r}...")
    return bytes([len(raw)]) + raw


def read_field(view: Buffer, position: int, kind: str) -> tuple[Any, int]:
    """Read a value of a type."""
    if kind == "varint":
        return read_varint(view, position)
    if kind == "string":
        return _read_string(view, position)
    code = STRUCT_CODES[kind]
    return code.unpack(take(view, position, code.size))[0], position + code.size


def _write_field(value: Any, kind: str) -> bytes:
    if kind == "varint":
        return write_varint(value)
    if kind == "string":
        return _write_string(value)
    return STRUCT_CODES[kind].pack(value)


def read_fields(
    view: Buffer, position: int, fields: tuple[Field, ...]
) -> tuple[dict[str, Any], dict[str, int], int]:
    """Return the values of a byte table, the offset of each, and the position after the last.

    Raises
    ------
    FormatError
    """
    values: dict[str, Any] = {}
    offsets: dict[str, int] = {}
    for name, kind in fields:
        offsets[name] = position
        values[name], position = read_field(view, position, kind)
    return values, offsets, position


def write_fields(fields: tuple[Field, ...], values: Mapping[str, Any]) -> bytes:
    """Return the bytes of a byte table."""
    parts = []
    for name, kind in fields:
        try:
            parts.append(_write_field(values[name], kind))
        except (ValueError, OverflowError, struct.error) as error:
            raise MeshError(f"the file cannot hold {name} = {values[name]!r}: {error}") from None
    return b"".join(parts)


def read_table(payload: Buffer, fields: tuple[Field, ...]) -> tuple[dict[str, Any], dict[str, int]]:
    """Return the values and the offsets of a payload that is a byte table and nothing else."""
    values, offsets, end = read_fields(payload, 0, fields)
    if end < len(payload):
        raise FormatError(f"{len(payload) - end} bytes follow the last field", end)
    return values, offsets


def check_crc(view: memoryview, start: int, end: int, name: str) -> None:
    """Compare the CRC-32 of view[start:end] with the four bytes after it."""
    stored, _ = read_field(view, end, "u32")
    if stored != zlib.crc32(view[start:end]):
        raise FormatError(f"{name} is damaged: its checksum does not match", start)


def with_crc(raw: bytes) -> bytes:
    """Return bytes with their CRC-32 after them."""
    return raw + _write_field(zlib.crc32(raw), "u32")
