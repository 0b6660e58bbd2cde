"""Reader of the `.dmesh` container: bytes from anywhere become a `Container`, or are refused.

Nothing is allocated by a number that a file announces, payloads are views of the input, and
whatever is wrong raises `FormatError` with the byte where it shows.
"""

from __future__ import annotations

from typing import BinaryIO, Final

from deltamesh_formats.container import layout
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.fields import (
    CRC_SIZE,
    VARINT_MAX_BYTES,
    Buffer,
    read_table,
    read_varint,
    take,
)
from deltamesh_formats.container.header import read_header
from deltamesh_formats.container.meta import read_meta
from deltamesh_formats.container.parameters import read_parameters
from deltamesh_formats.container.sections import (
    check_order,
    end_of_section,
    first_of,
    id_at,
    payload_of,
    read_sections,
)
from deltamesh_formats.errors import FormatError

# At least as many bytes as the header and the payload of `meta` can have.
_HEADER_MOST: Final = 64
_META_MOST: Final = 1 << 12


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
    header, position = read_header(view)
    vertices, triangles = header["vertices"], header["triangles"]
    sections, end = read_sections(view, position, partial=partial)
    is_whole, cut = layout.CHECK in sections, ""
    if end < len(view):
        if is_whole:
            raise FormatError(f"{len(view) - end} bytes follow the last section", end)
        cut = id_at(view, end)
    if not sections:
        raise FormatError(f"truncated: section {layout.PARAMETERS} is cut", len(view))
    with payload_of(first_of(sections)) as payload:
        parameters = read_parameters(payload, vertices)
    check_order(sections, parameters.method)
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
        at = read_header(memoryview(bytes(data[:_HEADER_MOST])))[1]
    name = ""
    while name != layout.CHECK and (end := end_of_section(data, at)) is not None:
        name, position, at = id_at(data, at), end, end
    return position, position > 0 and len(data) >= position + layout.ID_SIZE


def read_counts(data: Buffer) -> tuple[int, int]:
    """Return how many vertices and triangles a file has, by its header alone.

    Raises
    ------
    FormatError
    """
    header, _ = read_header(memoryview(data).cast("B").toreadonly())
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
    _, position = read_header(memoryview(stream.read(_HEADER_MOST)))
    for _ in range(layout.MAX_SECTIONS):
        stream.seek(position)
        frame = stream.read(layout.ID_SIZE + VARINT_MAX_BYTES)
        name = bytes(take(frame, 0, layout.ID_SIZE)).decode("ascii", "replace")
        length, start = read_varint(frame, layout.ID_SIZE)
        if name == layout.META:
            stream.seek(position + start)
            return read_meta(stream.read(min(length, _META_MOST))).source
        if name == layout.CHECK:
            break
        position += start + length + CRC_SIZE
    return ""
