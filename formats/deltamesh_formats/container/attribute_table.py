"""Table of attributes at the beginning of ATTR: their names, types and codings; SPEC.md 5.14.

Plain bytes, so that programs can list attributes without decoding any. `read_table` and
`write_table` are mirrors.
"""

from __future__ import annotations

import struct
from dataclasses import replace
from typing import Any, Final

import numpy as np

from deltamesh_formats.container import layout
from deltamesh_formats.container.attribute_entry import Entry, fault_of, fault_of_owners
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.fields import (
    STRUCT_CODES,
    read_varint,
    struct_of,
    take,
    write_varint,
)
from deltamesh_formats.container.payload_layout import (
    CODING_AT,
    CODINGS,
    DOMAINS,
    FIRST_NONE,
    INTEGER_FIELDS,
    MIXED,
    NORMALIZED,
    PALETTE,
    PARTLY,
    ROLE_AT,
    ROLES,
    TYPE_AT,
    TYPES,
    Coding,
)
from deltamesh_formats.container.sections import payload_of
from deltamesh_formats.errors import FormatError

_DOMAINS: Final = {code: name for name, code in DOMAINS.items()}
_ROLES: Final = {code: name for name, code in ROLES.items()}
_CODINGS: Final = {code: name for name, code in CODINGS.items()}
_TYPES: Final = {code: np.dtype(name) for name, code in TYPES.items()}
# Surrogates stand for bytes of a name that was no UTF-8; they are encoded as other code points are.
_NAMES: Final = "surrogatepass"

# Masks of what a byte has left after shifting.
_DOMAIN: Final = (1 << ROLE_AT) - 1
_ROLE: Final = (1 << TYPE_AT - ROLE_AT) - 1
_CODING: Final = 3
_INTEGER: Final = struct_of(INTEGER_FIELDS)
_F64: Final = STRUCT_CODES["f64"]


def write_table(entries: tuple[Entry, ...]) -> bytes:
    """Return the bytes of a table."""
    return write_varint(len(entries)) + b"".join(map(_written, entries))


def _written(e: Entry) -> bytes:
    name = e.name.encode(errors=_NAMES)
    what = DOMAINS[e.domain] | ROLES[e.role] << ROLE_AT
    what |= TYPES[e.dtype.name] << TYPE_AT
    flags = CODINGS[e.coding] << CODING_AT
    flags |= NORMALIZED * e.normalized | MIXED * e.mixed
    flags |= PARTLY * e.partly | FIRST_NONE * e.first_none
    flags |= PALETTE * (e.palette is not None)
    parts = [write_varint(len(name)), name, bytes([what, flags]), write_varint(e.width)]
    if e.domain == "corner":
        parts.append(write_varint(e.wedges))
    if e.palette is not None:
        parts.append(write_varint(e.palette))
    if e.coding == "integer":
        parts.append(_INTEGER.pack(int(e.origin[0]) % (1 << 64), e.bits, e.limbs))
    elif e.coding != "exact":
        parts += [bytes([e.bits]), _F64.pack(e.error)]
    if e.coding == "grid":
        parts += map(_F64.pack, (e.density, *e.origin))
    return b"".join([*parts, *map(write_varint, e.sizes)])


def entries_of(container: Container) -> tuple[Entry, ...]:
    """Return the attributes of a file, by its table; nothing is decoded.

    Raises
    ------
    FormatError
    """
    section = container.sections.get(layout.ATTRIBUTES)
    if section is None:
        return ()
    with payload_of(section) as payload:
        return read_table(payload)[0]


def read_table(payload: bytes | memoryview) -> tuple[tuple[Entry, ...], int]:
    """Return the entries of a table, and where the streams begin.

    Raises
    ------
    FormatError
        With an offset from the beginning of the payload.
    """
    count, at = read_varint(payload, 0)
    entries: list[Entry] = []
    if not count:
        raise FormatError("a table of 0 attributes", 0)
    for _ in range(count):
        entry, at = _read(payload, at, entries)
        entries.append(entry)
    total = sum(entry.size for entry in entries)
    if total != len(payload) - at:
        left = len(payload) - at
        raise FormatError(f"streams of {total} bytes in all, where {left} are left", at)
    return tuple(entries), at


def _read(payload: bytes | memoryview, at: int, before: list[Entry]) -> tuple[Entry, int]:
    start, number = at, len(before)
    name, at = _read_name(payload, at, number)
    what, flags = take(payload, at, 2)
    domain, role = what & _DOMAIN, what >> ROLE_AT & _ROLE
    kind, coding = what >> TYPE_AT, flags >> CODING_AT & _CODING
    for field, code, known in (("domain", domain, _DOMAINS), ("type", kind, _TYPES)):
        if code not in known:
            raise FormatError(f"attribute {number}: unknown {field} {code}", at)
    if flags >= 2 * FIRST_NONE:
        raise FormatError(f"attribute {number}: reserved bits of flags are set", at)
    width, at = read_varint(payload, at + 2)
    fields: dict[str, Any] = {}
    if _DOMAINS[domain] == "corner":
        fields["wedges"], at = read_varint(payload, at)
    if flags & PALETTE:
        fields["palette"], at = read_varint(payload, at)
    coded, at = _read_coding(payload, at, _CODINGS[coding], width)
    entry = Entry(
        name,
        _DOMAINS[domain],
        _ROLES[role],
        _TYPES[kind],
        width,
        bool(flags & NORMALIZED),
        _CODINGS[coding],
        partly=bool(flags & PARTLY),
        first_none=bool(flags & FIRST_NONE),
        mixed=bool(flags & MIXED),
        **fields,
        **coded,
    )
    fault = fault_of(entry) or fault_of_owners(entry, before)
    if fault:
        raise FormatError(f"attribute {number}: {fault}", start)
    if entry.streams > len(payload) - at:
        raise FormatError(f"truncated: attribute {number}: sizes of its streams", len(payload))
    sizes = []
    for _ in range(entry.streams):
        size, at = read_varint(payload, at)
        sizes.append(size)
    return replace(entry, sizes=tuple(sizes)), at


def _read_name(payload: bytes | memoryview, at: int, number: int) -> tuple[str, int]:
    length, start = read_varint(payload, at)
    try:
        name = bytes(take(payload, start, length)).decode(errors=_NAMES)
    except UnicodeDecodeError as error:
        message = f"attribute {number}: its name is not UTF-8"
        raise FormatError(message, start + error.start) from None
    return name, start + length


def _read_coding(
    payload: bytes | memoryview, at: int, coding: Coding, width: int
) -> tuple[dict[str, Any], int]:
    """Return the fields that only some codings have."""
    if coding == "integer":
        origin, bits, limbs = _INTEGER.unpack(take(payload, at, _INTEGER.size))
        return {"origin": (origin,), "bits": bits, "limbs": limbs}, at + _INTEGER.size
    if coding == "exact":
        return {}, at
    bits = take(payload, at, 1)[0]
    (error,), at = _floats(payload, at + 1, 1)
    if coding == "octahedral":
        return {"bits": bits, "error": error}, at
    (density, *origins), at = _floats(payload, at, 1 + width)
    return {"bits": bits, "error": error, "density": density, "origin": tuple(origins)}, at


def _floats(payload: bytes | memoryview, at: int, count: int) -> tuple[tuple[float, ...], int]:
    if count > (len(payload) - at) // 8:
        raise FormatError("truncated: the numbers of an attribute", len(payload))
    return struct.unpack_from(f"<{count}d", payload, at), at + 8 * count
