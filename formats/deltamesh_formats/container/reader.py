"""Reader of the `.dmesh` container: bytes from anywhere become a `Container`, or are refused.

Small functions (view, position) -> (value, position), after tomli. Nothing is indexed before its
bytes are known to be there, nothing is allocated by a number that a file announces, payloads are
views of the input, and whatever is wrong raises `FormatError` with the byte where it shows.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, BinaryIO, Final, TypeAlias

from deltamesh_formats.container import layout
from deltamesh_formats.container.container import (
    Container,
    Meta,
    Parameters,
    Section,
    meta_faults,
    parameter_faults,
)
from deltamesh_formats.container.layout import Field
from deltamesh_formats.errors import FormatError, located
from deltamesh_formats.meshfiles.formats import format_of_beginning

# Anything else with a contiguous buffer, such as an mmap, goes in as a memoryview.
Buffer: TypeAlias = bytes | bytearray | memoryview

# At least as many bytes as the header and the payload of `meta` can have.
_HEADER_MOST: Final = 64
_META_MOST: Final = 1 << 12

_METHODS = {method.id: name for name, method in layout.METHODS.items()}
_ANCHOR_METHODS = {code: name for name, code in layout.ANCHOR_METHODS.items()}


def read_container(data: Buffer) -> Container:
    """Read a `.dmesh` file and check all that can be checked without decoding it.

    Parameters
    ----------
    data : bytes-like, contiguous
        The whole file. The payloads of the result are views of it, not copies.

    Raises
    ------
    FormatError
        For anything but a whole, undamaged file of this version; `offset` says where.

    Notes
    -----
    SPEC.md, sections 2 to 4.
    """
    return _read(data, partial=False)


def read_prefix(data: Buffer) -> Container:
    """Read the beginning of a `.dmesh` file, cut anywhere, or a whole one.

    Parameters
    ----------
    data : bytes-like, contiguous
        Payloads of the result are views of it. A section that is cut counts as absent.

    Raises
    ------
    FormatError
        For anything but the beginning of an undamaged file of this version, and for one that ends
        before its parameters do.

    Notes
    -----
    SPEC.md, section 6. Where the length of a section is damaged, it may seem to be cut.
    """
    return _read(data, partial=True)


def _read(data: Buffer, *, partial: bool) -> Container:
    view = memoryview(data).cast("B").toreadonly()
    header, position = _read_header(view)
    vertices, triangles = header["vertices"], header["triangles"]
    sections, end = _read_sections(view, position, partial=partial)
    is_whole, cut = layout.CHECK in sections, ""
    if end < len(view):
        if is_whole:
            raise FormatError(f"{len(view) - end} bytes follow the last section", end)
        cut = _id_at(view, end)
    if not sections:
        raise FormatError(f"truncated: section {layout.PARAMETERS} is cut", len(view))
    with payload_of(_first(sections)) as payload:
        parameters = read_parameters(payload, vertices)
    _check_order(sections, parameters.method)
    meta = None
    if layout.META in sections:
        with payload_of(sections[layout.META]) as payload:
            meta = read_meta(payload)
    digest = b""
    if is_whole:
        with payload_of(sections[layout.CHECK]) as payload:
            digest = read_table(payload, layout.CHECK_FIELDS)[0]["digest"]
    counts = header["version"], vertices, triangles
    return Container(*counts, parameters, meta, sections, digest, cut)


def progress_of(data: Buffer, position: int) -> tuple[int, bool]:
    """Return where the last whole section of a prefix ends, and whether the next one has its id.

    Parameters
    ----------
    data : bytes-like
    position : int
        Where a section ends, by an earlier call with fewer bytes; 0 at first. No byte before that
        is read again.

    Returns
    -------
    int, bool
        0 and False before a section is whole.

    Raises
    ------
    FormatError
    """
    at = position
    if not position:
        if len(data) < _HEADER_MOST:  # as many bytes as any file has
            return 0, False
        at = _read_header(memoryview(bytes(data[:_HEADER_MOST])))[1]
    name = ""
    while name != layout.CHECK and (end := _end_of_section(data, at)) is not None:
        name, position, at = _id_at(data, at), end, end
    return position, position > 0 and len(data) >= position + layout.ID_SIZE


def read_counts(data: Buffer) -> tuple[int, int]:
    """Return how many vertices and triangles a file has, by its header alone.

    Raises
    ------
    FormatError
    """
    header, _ = _read_header(memoryview(data).cast("B").toreadonly())
    return header["vertices"], header["triangles"]


def read_source_format(stream: BinaryIO) -> str:
    """Return the format of the source that a file stores, "" for none, reading little else.

    Payloads are passed over, and no checksum but that of the header is verified: decoding does so.

    Parameters
    ----------
    stream : binary file object
        At the beginning of the file; it can seek.

    Raises
    ------
    FormatError
    """
    _, position = _read_header(memoryview(stream.read(_HEADER_MOST)))
    for _ in range(layout.MAX_SECTIONS):
        stream.seek(position)
        frame = stream.read(layout.ID_SIZE + layout.VARINT_MAX_BYTES)
        name = bytes(take(frame, 0, layout.ID_SIZE)).decode("ascii", "replace")
        length, start = read_varint(frame, layout.ID_SIZE)
        if name == layout.META:
            stream.seek(position + start)
            return read_meta(stream.read(min(length, _META_MOST))).source
        if name == layout.CHECK:
            break
        position += start + length + layout.CRC_SIZE
    return ""


def read_varint(view: Buffer, position: int) -> tuple[int, int]:
    """Read an unsigned LEB128 number in its shortest form; return it and the position after it."""
    value = 0
    for i in range(layout.VARINT_MAX_BYTES):
        byte = take(view, position + i, 1)[0]
        value |= (byte & 0x7F) << (7 * i)
        if byte < 0x80:
            if byte == 0 and i > 0:
                raise FormatError("a varint that is longer than it needs to be", position)
            return value, position + i + 1
    raise FormatError(f"a varint of more than {layout.VARINT_MAX_BYTES} bytes", position)


def take(view: Buffer, position: int, size: int) -> Buffer:
    """Return `size` bytes from `position` on, or refuse at the byte where they run out."""
    if size > len(view) - position:
        left = max(len(view) - position, 0)
        raise FormatError(f"truncated: {size} bytes are needed, {left} are left", len(view))
    return view[position : position + size]


def _read_string(view: Buffer, position: int) -> tuple[str, int]:
    start = position + 1
    end = start + take(view, position, 1)[0]
    try:
        return bytes(take(view, start, end - start)).decode(), end
    except UnicodeDecodeError as error:
        raise FormatError("a string that is not UTF-8", start + error.start) from None


def _read_field(view: Buffer, position: int, kind: str) -> tuple[Any, int]:
    if kind == "varint":
        return read_varint(view, position)
    if kind == "string":
        return _read_string(view, position)
    code = layout.STRUCT_CODES[kind]
    return code.unpack(take(view, position, code.size))[0], position + code.size


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
        values[name], position = _read_field(view, position, kind)
    return values, offsets, position


def read_table(payload: Buffer, fields: tuple[Field, ...]) -> tuple[dict[str, Any], dict[str, int]]:
    """Return the values and the offsets of a payload that is a byte table and nothing else."""
    values, offsets, end = read_fields(payload, 0, fields)
    if end < len(payload):
        raise FormatError(f"{len(payload) - end} bytes follow the last field", end)
    return values, offsets


def _read_header(view: memoryview) -> tuple[dict[str, Any], int]:
    _check_magic(view)
    # Another version may order what follows differently, so this comes before the checksum.
    version = _read_field(view, len(layout.MAGIC), "u16")[0]
    if not version:
        raise FormatError("there is no container version 0", len(layout.MAGIC))
    if version != layout.VERSION:
        one = "a newer" if version > layout.VERSION else "an older"
        message = f"container version {version} needs {one} deltamesh"
        raise FormatError(f"{message}, this one reads {layout.VERSION}", len(layout.MAGIC))
    values, offsets, position = read_fields(view, 0, layout.HEADER_FIELDS)
    _check_crc(view, 0, offsets["crc"], "the header")
    if values["reserved"]:
        raise FormatError("reserved bits are set: it needs a newer deltamesh", offsets["reserved"])
    for name in ("vertices", "triangles"):
        if values[name] > layout.MAX_COUNT:
            message = f"{values[name]} {name}, more than {layout.MAX_COUNT}"
            raise FormatError(message, offsets[name])
    return values, position


def _check_magic(view: memoryview) -> None:
    head = bytes(view[: len(layout.MAGIC)])
    if head == layout.MAGIC:
        return
    if not head:
        raise FormatError("the input is empty", 0)
    if layout.MAGIC.startswith(head):
        raise FormatError("truncated: the file ends within its signature", len(head))
    other = format_of_beginning(head)
    if other is not None:
        raise FormatError(f"not a .dmesh file but a mesh file ({other.title})", 0)
    if b"DMS" in head:
        raise FormatError("a .dmesh file with a damaged signature: was it sent as text?", 0)
    raise FormatError("not a .dmesh file", 0)


def _check_crc(view: memoryview, start: int, end: int, name: str) -> None:
    """Compare the CRC-32 (as in zlib, PNG) of view[start:end] with the four bytes after it."""
    stored, _ = _read_field(view, end, "u32")
    if stored != zlib.crc32(view[start:end]):
        raise FormatError(f"{name} is damaged: its checksum does not match", start)


def _read_sections(
    view: memoryview, position: int, *, partial: bool
) -> tuple[dict[str, Section], int]:
    """Read sections up to and with `CHEK`; return them and the position after it.

    Those of a prefix end before the one that is cut.
    """
    sections: dict[str, Section] = {}
    while layout.CHECK not in sections:
        if partial and _end_of_section(view, position) is None:
            break
        if position == len(view):
            raise FormatError(f"truncated: section {layout.CHECK} is missing", position)
        if len(sections) == layout.MAX_SECTIONS:
            raise FormatError(f"more than {layout.MAX_SECTIONS} sections", position)
        section = _read_section(view, position)
        if section.id in sections:
            raise FormatError(f"section {section.id} comes a second time", position)
        sections[section.id] = section
        position = section.end
    return sections, position


def _id_at(view: Buffer, offset: int) -> str:
    """Return the id of the section at an offset; "" if the bytes end before or within it."""
    raw = bytes(view[offset : offset + layout.ID_SIZE])
    if raw and not raw.isalpha():
        raise FormatError(f"a section cannot be called {raw!r}", offset)
    return raw.decode("ascii") if len(raw) == layout.ID_SIZE else ""


def _end_of_section(view: Buffer, offset: int) -> int | None:
    """Return where the section at an offset ends; None if the bytes end before.

    Raises
    ------
    FormatError
        If no section begins so.
    """
    if not _id_at(view, offset):
        return None
    at = offset + layout.ID_SIZE
    length = bytes(view[at : at + layout.VARINT_MAX_BYTES])
    if len(length) < layout.VARINT_MAX_BYTES and all(byte & 0x80 for byte in length):
        return None
    size, start = read_varint(view, at)
    end = start + size + layout.CRC_SIZE
    return end if end <= len(view) else None


def _read_section(view: memoryview, offset: int) -> Section:
    take(view, offset, layout.ID_SIZE)
    name = _id_at(view, offset)
    length, start = read_varint(view, offset + layout.ID_SIZE)
    left = len(view) - start - layout.CRC_SIZE
    if length > left:
        message = f"truncated: section {name} at byte {offset} has {length} bytes, {max(left, 0)}"
        raise FormatError(f"{message} are left", len(view))
    _check_crc(view, offset, start + length, f"section {name}")
    if name not in layout.KNOWN and name[0].isupper():
        raise FormatError(f"section {name} is unknown: it needs a newer deltamesh", offset)
    payload = view[start : start + length]
    return Section(name, offset, payload)


def _first(sections: dict[str, Section]) -> Section:
    first = next(iter(sections.values()))
    if first.id != layout.PARAMETERS:
        raise FormatError(f"section {layout.PARAMETERS} is missing", first.offset)
    return first


def _check_order(sections: dict[str, Section], method: str) -> None:
    """Refuse a section that is missing or not in its place; SPEC.md 3.2 has the order."""
    ids, required = list(sections), layout.required(method, sections)
    # `CHEK` ends the ids and is not among the required, so a shorter list meets it here.
    for expected, found in zip(required, ids, strict=False):
        if found != expected:
            message = f"section {expected} is missing, {found} is in its place"
            raise FormatError(message, sections[found].offset)
    for i, name in enumerate(ids[len(required) :]):
        if name == layout.CHECK:
            continue
        if name[0].isupper() or (name == layout.META and i > 0):
            message = f"section {name} has no place here in a {method} file"
            raise FormatError(message, sections[name].offset)


def read_parameters(payload: Buffer, vertices: int) -> Parameters:
    """Return what the payload of `PARM` holds, in a file of so many vertices.

    Raises
    ------
    FormatError
    """
    fields: tuple[Field, ...] = layout.PARAMETER_FIELDS
    first = read_fields(payload, 0, fields)[0]
    if first["anchor_method"] == layout.ANCHOR_METHODS[layout.RANDOM]:
        fields += layout.SEED_FIELDS
    values, offsets = read_table(payload, fields)
    for field, names in (("method", _METHODS), ("anchor_method", _ANCHOR_METHODS)):
        if values[field] not in names:
            message = f"{field.replace('_', ' ')} {values[field]} is unknown"
            raise FormatError(f"{message}: it needs a newer deltamesh", offsets[field])
    bits = values["bits"]
    parameters = Parameters(
        method=_METHODS[values["method"]],
        diffusion=bool(values["flags"] & layout.FLAG_DIFFUSION),
        anchor_method=_ANCHOR_METHODS[values["anchor_method"]],
        bits=None if bits == layout.BITS_FROM_STEP else bits,
        step=values["step"],
        origin=(values["origin_x"], values["origin_y"], values["origin_z"]),
        anchor_step=values["anchor_step"],
        seed=values.get("seed", 0),
        anchor_count=values["anchor_count"],
        isolated=values["isolated"],
        coarse=values["coarse"],
        dead_zone=values["dead_zone"] / layout.ZONE_UNIT,
        normal_dead_zone=values["normal_dead_zone"] / layout.ZONE_UNIT,
        single=bool(values["flags"] & layout.FLAG_SINGLE),
        interpolated=bool(values["flags"] & layout.FLAG_INTERPOLATED),
    )
    for field, message in parameter_faults(parameters, vertices):
        raise FormatError(message, offsets[field])
    return parameters


def read_meta(payload: Buffer) -> Meta:
    """Return what the payload of `meta` holds.

    Raises
    ------
    FormatError
    """
    fields: tuple[Field, ...] = layout.META_FIELDS
    _, _, end = read_fields(payload, 0, fields)
    has_losses = end < len(payload)
    if has_losses:
        fields += layout.META_LOSS_FIELDS
        if read_fields(payload, 0, fields)[0]["parts"] > 1:
            fields += layout.META_PART_FIELDS
    values, offsets = read_table(payload, fields)
    meta = Meta(**values)
    for field, message in meta_faults(meta):
        raise FormatError(message, offsets[field])
    if has_losses != meta.has_losses:
        raise FormatError("no faces are lost or turned, and there is one part", offsets["lost"])
    return meta


@contextmanager
def payload_of(section: Section) -> Iterator[memoryview]:
    """Give the payload of a section; a `FormatError` in it gets its place in the file."""
    with located(section.start, f"{section.id}: "):
        yield memoryview(section.payload)
