"""Header of a file, both ways: its signature, version and counts; SPEC.md 2."""

from __future__ import annotations

from typing import Any

from deltamesh_formats.container import layout
from deltamesh_formats.container.fields import (
    check_crc,
    read_field,
    read_fields,
    with_crc,
    write_fields,
)
from deltamesh_formats.errors import FormatError, MeshError
from deltamesh_formats.meshfiles.formats import format_of_beginning


def read_header(view: memoryview) -> tuple[dict[str, Any], int]:
    """Return the fields of a header, and where it ends.

    Raises
    ------
    FormatError
    """
    _check_magic(view)
    # Another version may order what follows differently, so this comes before the checksum.
    version = read_field(view, len(layout.MAGIC), "u16")[0]
    if not version:
        raise FormatError("there is no container version 0", len(layout.MAGIC))
    if version != layout.VERSION:
        one = "a newer" if version > layout.VERSION else "an older"
        message = f"container version {version} needs {one} deltamesh"
        raise FormatError(f"{message}, this one reads {layout.VERSION}", len(layout.MAGIC))
    values, offsets, position = read_fields(view, 0, layout.HEADER_FIELDS)
    check_crc(view, 0, offsets["crc"], "the header")
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
    return with_crc(write_fields(layout.HEADER_FIELDS[:-1], values))
