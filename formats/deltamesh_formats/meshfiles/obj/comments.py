"""Comments and continued lines of OBJ, and the colours that ZBrush writes as comments."""

from __future__ import annotations

import re
from typing import Final

import numpy as np

from deltamesh_formats.meshfiles import text
from deltamesh_formats.meshfiles.obj.statements import PARTS
from deltamesh_formats.polymesh.mesh import Attribute

# "#" begins a comment after white space; names such as "part#1" are whole.
_COMMENT: Final = re.compile(rb"#(?<![^ \t\r\n]#)[^\n]*")
_HEADER: Final = re.compile(rb"(?:[ \t\r]*(?:#[^\n]*)?\n)*")
_CONTINUATION: Final = re.compile(rb"\\[ \t\r]*\n")
# Names may end in a backslash, as folders do: they continue on no line.
_NAME: Final = rb"[ \t]*(?:" + b"|".join([b"mtllib", *PARTS.values()]) + rb")[ \t]"
_NAME_LINE: Final = re.compile(_NAME)
_CONTINUED: Final = re.compile(rb"(?m)^" + _NAME + rb"[^\n]*$|" + _CONTINUATION.pattern)
# Two digits each of the mask, red, green and blue of a vertex, and so on for the next ones.
_POLYPAINT: Final = re.compile(rb"(?m)^[ \t]*+#MRGB[ \t]++(\S*+)[ \t\r]*+$")
_UNMASKED: Final = 255


def statements(data: bytes) -> bytes:
    """Return a text with blanks for comments, and for the line ends of lines that continue."""
    # Comments first: a path at the end of one continues nothing.
    data = text.blanked(_COMMENT, data) if b"#" in data else data
    if not _CONTINUATION.search(data):
        return data
    return _CONTINUED.sub(_joined, data)


def _joined(found: re.Match[bytes]) -> bytes:
    return found[0] if _NAME_LINE.match(found[0]) else b" " * len(found[0])


def comments_of(data: bytes) -> tuple[tuple[str, ...], bool]:
    """Return the comments above the first statement, and whether there are others below it."""
    head = _HEADER.match(data)
    end = head.end() if head else 0
    above = [line.strip() for line in data[:end].split(b"\n")]
    kept = tuple(text.as_text(line[1:]) for line in above if line and not _is_polypaint(line))
    below = (found.start() for found in _COMMENT.finditer(data, end))
    return kept, any(not _is_of_name(data, at) and not _is_polypaint(data, at) for at in below)


def _is_of_name(data: bytes, at: int) -> bool:
    """Return whether what begins at a byte is a part of a name, such as that of a group "#1"."""
    line = data.rfind(b"\n", 0, at) + 1
    return bool(_NAME_LINE.match(data, line, at))


def _is_polypaint(data: bytes, at: int = 0) -> bool:
    return data.startswith(b"#MRGB", at)


def polypaint(data: bytes, n: int, colours: int) -> tuple[list[Attribute], list[str]]:
    """Return the colours and masks of the vertices that ZBrush writes as comments, #MRGB.

    Parameters
    ----------
    data : bytes
    n : int
        Count of the vertices.
    colours : int
        Sets of colours that the vertices have already.

    Returns
    -------
    attributes : list of Attribute
        uint8 (n, 3) colours and, where a vertex is masked, uint8 (n, 1) masks.
    lost : list of str
        A description of comments of that name that are not eight digits for each vertex.
    """
    if b"#MRGB" not in data:
        return [], []
    try:
        raw = bytes.fromhex(b"".join(_POLYPAINT.findall(data)).decode("ascii"))
    except ValueError:
        return [], ["colours in comments (#MRGB) that are not hexadecimal"]
    if len(raw) != 4 * n:
        return [], [f"colours in comments (#MRGB) of {len(raw) / 4:g} vertices, of {n}"]
    values = np.frombuffer(raw, dtype=np.uint8).reshape(n, 4)
    name = f"colour{colours or ''}"
    found = [Attribute(name, "vertex", values[:, 1:].copy(), "colour", normalized=True)]
    if (values[:, 0] != _UNMASKED).any():
        found.append(Attribute("mask", "vertex", values[:, :1].copy(), normalized=True))
    return found, []
