"""Header of a PLY: its format, its elements and their properties, in the order of the file."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Final

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles import text
from deltamesh_formats.meshfiles.ply.properties import FORMATS, TYPES

_BEGINNING: Final = re.compile(rb"ply[ \t]*[\r\n]")
_END: Final = re.compile(rb"(?<=[\r\n])[ \t]*end_header[ \t]*(\r\n|\n|\r|\Z)")
_LINE_END: Final = re.compile(rb"\r\n|\n|\r")
# A count with more digits is beyond any file.
_COUNT: Final = re.compile(r"\d{1,18}")


@dataclass(frozen=True)
class Property:
    """Property of a record: a number, or a list of numbers after their count.

    Attributes
    ----------
    name : str
    type : str
        Type of the numbers: a code of numpy without byte order.
    count_type : str or None
        Type of the count; None for a single number.
    """

    name: str
    type: str
    count_type: str | None = None


@dataclass(frozen=True)
class Element:
    """Element of a PLY: a table of records."""

    name: str
    count: int
    properties: list[Property] = field(default_factory=list)


@dataclass(frozen=True)
class Header:
    """Header, and where the body begins.

    Attributes
    ----------
    order : str
        "<" or ">", the byte order; "" for text.
    body : int
        First byte of the body in the file.
    """

    order: str
    elements: list[Element]
    comments: list[str]
    obj_info: list[str]
    body: int


def read_header(data: bytes) -> Header:
    """Read the header of a PLY.

    Raises
    ------
    MeshError
        For a header that is not valid; the line is named.
    """
    if not _BEGINNING.match(data):
        raise MeshError("it does not begin with 'ply' on a line of its own")
    end = _END.search(data)
    if end is None:
        raise MeshError("its header has no end: is it cut short?")
    line_ends = set(_LINE_END.findall(data, 0, end.start()))
    header = Header("", [], [], [], end.end())
    order = None
    for i, line in enumerate(data[: end.start()].splitlines()):
        words = line.split()
        if i == 0 or not words:
            continue
        key, rest = text.as_text(words[0]), [text.as_text(word) for word in words[1:]]
        try:
            if key == "format":
                order = FORMATS[rest[0]]
            elif key == "element":
                header.elements.append(_element(rest))
            elif key == "property":
                _add_property(header.elements[-1], _property(rest), i + 1)
            else:
                _remark(header, line, key)
        except MeshError:
            raise
        except (LookupError, ValueError):
            raise MeshError(
                f"line {i + 1}: not a line of a PLY header: {text.quoted(line)}"
            ) from None
    if order is None:
        raise MeshError("its header has no format: ascii, binary_little_endian, binary_big_endian")
    body = end.end() if order == "" else _first_byte(end, line_ends)
    return Header(order, header.elements, header.comments, header.obj_info, body)


def _first_byte(end: re.Match[bytes], line_ends: set[bytes]) -> int:
    """Return where a binary body begins: its first byte may be that of a line feed, too.

    Parameters
    ----------
    end : match of `_END`
    line_ends : set of bytes
        The ends of the lines above.

    Raises
    ------
    MeshError
        If it is not clear whether a line feed behind a carriage return ends the header.
    """
    if end[1] != b"\r\n" or b"\r" not in line_ends:
        return end.end()
    if line_ends == {b"\r"}:
        return end.end() - 1
    raise MeshError(
        "its header has lines that end in a carriage return, and others: it is not clear"
        " whether the line feed below 'end_header' is in the header or in the body"
    )


def _add_property(element: Element, prop: Property, line: int) -> None:
    """Add a property; of two that share a name, nobody can say which one is right."""
    if any(prop.name == other.name for other in element.properties):
        name = text.quoted(prop.name.encode(*text.ENCODING))
        raise MeshError(f"line {line}: {element.name} has the property {name} twice")
    element.properties.append(prop)


def _element(words: list[str]) -> Element:
    name, count = words
    if not _COUNT.fullmatch(count):
        raise ValueError(count)
    return Element(name, int(count))


def _property(words: list[str]) -> Property:
    if words[0] != "list":
        kind, name = words
        return Property(name, TYPES[kind])
    _, count, kind, name = words
    if TYPES[count][0] == "f":
        raise ValueError(count)
    return Property(name, TYPES[kind], TYPES[count])


def _remark(header: Header, line: bytes, key: str) -> None:
    """Keep a comment; above the first element also one without its keyword."""
    said = text.as_text(line.strip())
    if key in ("comment", "obj_info"):
        kept = header.comments if key == "comment" else header.obj_info
        kept.append(said[len(key) + 1 :])
    elif not header.elements:
        header.comments.append(said)
    else:
        raise ValueError(key)
