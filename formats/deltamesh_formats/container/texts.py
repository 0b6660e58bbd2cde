"""Text of a `.dmesh` file: names of parts, metadata, descriptions of losses; SPEC.md 5.15.

It can be read without decoding anything else, and without numpy: `deltamesh info` does. Text comes
from users' files and may hold anything, control characters too: whoever prints it escapes them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from deltamesh_formats.container.container import Container
from deltamesh_formats.container.fields import Buffer, read_varint, take, write_varint
from deltamesh_formats.container.layout import PARTS
from deltamesh_formats.container.packed import packed, unpacked, unpacked_size
from deltamesh_formats.container.payload_layout import (
    DIVISION_KIND,
    DIVISION_MOVED,
    DIVISION_PARTLY,
    KINDS,
    MAX_TEXT,
)
from deltamesh_formats.container.sections import payload_of
from deltamesh_formats.errors import FormatError, MeshError

if TYPE_CHECKING:
    from deltamesh_formats.polymesh.kinds import Kind

_KINDS: Final = {code: kind for kind, code in KINDS.items()}
# Any text of Python has one form: bytes of the source that were no UTF-8 are surrogates in it.
_ENCODING: Final = ("utf-8", "surrogatepass")


@dataclass(frozen=True)
class Division:
    """Division of the polygons into parts of one kind, without the polygons.

    Attributes
    ----------
    kind : {"object", "mesh", "group", "material", "smoothing"}
    names : tuple of str
        One a part.
    partly : bool
        Whether some polygons are in no part.
    moved : bool
        Whether the parts have transforms.
    """

    kind: Kind
    names: tuple[str, ...]
    partly: bool
    moved: bool


@dataclass(frozen=True)
class Texts:
    """All text of a file.

    Attributes
    ----------
    divisions : tuple of Division, at most one of each kind
    metadata : mapping of str to tuple of str
    lost : tuple of str
        Descriptions of what the source had and the file has not.
    """

    divisions: tuple[Division, ...]
    metadata: Mapping[str, tuple[str, ...]]
    lost: tuple[str, ...]

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to write."""
        return not (self.divisions or self.metadata or self.lost)


def texts_of(container: Container) -> Texts:
    """Return the text of a file; without the section, none.

    Raises
    ------
    FormatError
    """
    if PARTS not in container.sections:
        return Texts((), {}, ())
    with payload_of(container.sections[PARTS]) as payload:
        return read_texts(payload)[0]


def text_size(container: Container) -> int:
    """Return how many bytes of text a file says that it has.

    Raises
    ------
    FormatError
    """
    if PARTS not in container.sections:
        return 0
    with payload_of(container.sections[PARTS]) as payload:
        return unpacked_size(payload, 0)


def raw_texts(texts: Texts) -> bytes:
    """Return the bytes of a text before they are packed."""
    parts = [write_varint(len(texts.divisions))]
    for one in texts.divisions:
        flags = KINDS[one.kind] | one.partly * DIVISION_PARTLY
        flags |= one.moved * DIVISION_MOVED
        parts += [bytes([flags]), _strings(one.names)]
    parts.append(write_varint(len(texts.metadata)))
    for key, lines in texts.metadata.items():
        parts += [_string(key), _strings(lines)]
    parts.append(_strings(texts.lost))
    return b"".join(parts)


def write_texts(texts: Texts) -> bytes:
    """Return the block of a text.

    Raises
    ------
    MeshError
        For more text than a file can hold.
    """
    raw = raw_texts(texts)
    if len(raw) > MAX_TEXT:
        raise MeshError(f"{len(raw)} bytes of names and metadata, more than {MAX_TEXT}")
    return packed(raw)


def read_texts(view: Buffer) -> tuple[Texts, int]:
    """Return the text at the beginning of a payload, and the position after it.

    Raises
    ------
    FormatError
        The offset is that of the block where the fault is within what it holds.
    """
    raw, end = unpacked(view, 0, MAX_TEXT)
    try:
        texts, at = _read(raw)
    except FormatError as error:
        raise FormatError(f"in the text, {error.reason}", 0) from None
    if at < len(raw):
        raise FormatError(f"{len(raw) - at} bytes follow the end of the text", 0)
    if texts.is_empty:
        raise FormatError("no parts, metadata or losses in the text", 0)
    return texts, end


def _read(raw: bytes) -> tuple[Texts, int]:
    count, at = read_varint(raw, 0)
    divisions: dict[Kind, Division] = {}
    for _ in range(count):
        one, at = _read_division(raw, at)
        if one.kind in divisions:
            raise FormatError(f"parts of kind {one.kind} come a second time", at)
        divisions[one.kind] = one
    count, at = read_varint(raw, at)
    metadata: dict[str, tuple[str, ...]] = {}
    for _ in range(count):
        key, at = _read_string(raw, at)
        if key in metadata:
            raise FormatError(f"metadata key {key!r} comes a second time", at)
        metadata[key], at = _read_strings(raw, at)
    lost, at = _read_strings(raw, at)
    return Texts(tuple(divisions.values()), metadata, lost), at


def _read_division(raw: bytes, at: int) -> tuple[Division, int]:
    flags = take(raw, at, 1)[0]
    kind = flags & DIVISION_KIND
    if kind not in _KINDS:
        raise FormatError(f"unknown kind of parts {kind}", at)
    if flags >= 2 * DIVISION_MOVED:
        raise FormatError(f"parts of kind {_KINDS[kind]}: reserved bits are set", at)
    names, end = _read_strings(raw, at + 1)
    partly, moved = (
        bool(flags & DIVISION_PARTLY),
        bool(flags & DIVISION_MOVED),
    )
    return Division(_KINDS[kind], names, partly, moved), end


def _string(text: str) -> bytes:
    raw = text.encode(*_ENCODING)
    return write_varint(len(raw)) + raw


def _strings(texts: Iterable[str]) -> bytes:
    parts = list(map(_string, texts))
    return b"".join([write_varint(len(parts)), *parts])


def _read_string(raw: bytes, at: int) -> tuple[str, int]:
    size, start = read_varint(raw, at)
    try:
        return bytes(take(raw, start, size)).decode(*_ENCODING), start + size
    except UnicodeDecodeError:
        raise FormatError("a string that is not UTF-8", at) from None


def _read_strings(raw: bytes, at: int) -> tuple[tuple[str, ...], int]:
    count, at = read_varint(raw, at)
    found = []
    for _ in range(count):  # each takes a byte or more: it ends where the bytes do
        text, at = _read_string(raw, at)
        found.append(text)
    return tuple(found), at
