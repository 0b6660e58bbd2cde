"""Sections of a file, both ways: ids, lengths, checksums, and the order that a method has them in.

SPEC.md 3.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field

from deltamesh_formats.container import layout
from deltamesh_formats.container.fields import (
    CRC_SIZE,
    VARINT_MAX_BYTES,
    Buffer,
    check_crc,
    read_varint,
    take,
    varint_size,
    with_crc,
    write_varint,
)
from deltamesh_formats.container.method_layouts import KNOWN, required
from deltamesh_formats.errors import FormatError, located


@dataclass(frozen=True)
class Section:
    """Section of a file.

    Attributes
    ----------
    id : str
        Four letters.
    offset : int
        Where the section begins in the file, in bytes.
    payload : bytes or memoryview
    """

    id: str
    offset: int
    payload: bytes | memoryview = field(repr=False)

    @property
    def start(self) -> int:
        """Where the payload begins in the file, in bytes."""
        return self.offset + layout.ID_SIZE + varint_size(len(self.payload))

    @property
    def end(self) -> int:
        """Where the section after this one begins, in bytes."""
        return self.start + len(self.payload) + CRC_SIZE

    @property
    def size(self) -> int:
        """Bytes of the whole section: id, length, payload and checksum."""
        return self.end - self.offset

    def __reduce__(self) -> tuple[type[Section], tuple[str, int, bytes]]:
        """Copy the payload: a view of a file cannot go to another process."""
        return Section, (self.id, self.offset, bytes(self.payload))


@contextmanager
def payload_of(section: Section) -> Iterator[memoryview]:
    """Give the payload of a section; a `FormatError` in it gets its place in the file."""
    with located(section.start, f"{section.id}: "):
        yield memoryview(section.payload)


def laid_out(payloads: Mapping[str, bytes], start: int) -> dict[str, Section]:
    """Return the sections that have these payloads and follow each other from byte `start` on."""
    sections: dict[str, Section] = {}
    for name, payload in payloads.items():
        sections[name] = Section(name, start, payload)
        start = sections[name].end
    return sections


def read_sections(
    view: memoryview, position: int, *, partial: bool
) -> tuple[dict[str, Section], int]:
    """Read sections up to and with `CHEK`; return them and the position after it.

    Those of a prefix end before the one that is cut.
    """
    sections: dict[str, Section] = {}
    while layout.CHECK not in sections:
        if partial and end_of_section(view, position) is None:
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


def _read_section(view: memoryview, offset: int) -> Section:
    take(view, offset, layout.ID_SIZE)
    name = id_at(view, offset)
    length, start = read_varint(view, offset + layout.ID_SIZE)
    left = len(view) - start - CRC_SIZE
    if length > left:
        message = f"truncated: section {name} at byte {offset} has {length} bytes, {max(left, 0)}"
        raise FormatError(f"{message} are left", len(view))
    check_crc(view, offset, start + length, f"section {name}")
    if name not in KNOWN and name[0].isupper():
        raise FormatError(f"section {name} is unknown: it needs a newer deltamesh", offset)
    payload = view[start : start + length]
    return Section(name, offset, payload)


def write_section(section: Section) -> bytes:
    """Return the bytes of a section."""
    length = write_varint(len(section.payload))
    return with_crc(section.id.encode("ascii") + length + section.payload)


def id_at(view: Buffer, offset: int) -> str:
    """Return the id of the section at an offset; "" if the bytes end before or within it."""
    raw = bytes(view[offset : offset + layout.ID_SIZE])
    if raw and not raw.isalpha():
        raise FormatError(f"a section cannot be called {raw!r}", offset)
    return raw.decode("ascii") if len(raw) == layout.ID_SIZE else ""


def end_of_section(view: Buffer, offset: int) -> int | None:
    """Return where the section at an offset ends; None if the bytes end before.

    Raises
    ------
    FormatError
        If no section begins so.
    """
    if not id_at(view, offset):
        return None
    at = offset + layout.ID_SIZE
    length = bytes(view[at : at + VARINT_MAX_BYTES])
    if len(length) < VARINT_MAX_BYTES and all(byte & 0x80 for byte in length):
        return None
    size, start = read_varint(view, at)
    end = start + size + CRC_SIZE
    return end if end <= len(view) else None


def first_of(sections: Mapping[str, Section]) -> Section:
    """Return the first section, which has to be that of the parameters."""
    first = next(iter(sections.values()))
    if first.id != layout.PARAMETERS:
        raise FormatError(f"section {layout.PARAMETERS} is missing", first.offset)
    return first


def check_order(sections: Mapping[str, Section], method: str) -> None:
    """Refuse a section that is missing or not in its place; SPEC.md 3.2 has the order."""
    ids, needed = list(sections), required(method, sections)
    # `CHEK` ends the ids and is not among the required, so a shorter list meets it here.
    for expected, found in zip(needed, ids, strict=False):
        if found != expected:
            message = f"section {expected} is missing, {found} is in its place"
            raise FormatError(message, sections[found].offset)
    for i, name in enumerate(ids[len(needed) :]):
        if name == layout.CHECK:
            continue
        if name[0].isupper() or (name == layout.META and i > 0):
            message = f"section {name} has no place here in a {method} file"
            raise FormatError(message, sections[name].offset)
