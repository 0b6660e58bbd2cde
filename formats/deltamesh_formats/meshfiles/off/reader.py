"""Reader of OFF: text, with normals, colours and texture coordinates, and binary.

The format is that of Geomview (Phillips and others, Geomview Manual, section 4.2.5). A record of a
text usually is a line, and the numbers after the indices of a face are its colour. Where lines are
not records, all numbers are read as one row, which is unambiguous without colours of faces.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles import plain_text, text
from deltamesh_formats.meshfiles.off.binary import read_binary
from deltamesh_formats.meshfiles.text import Lines
from deltamesh_formats.polymesh.mesh import Attribute, Domain, PolyMesh, Role

# "#" begins a comment, but for the one in "1.#IND", which is a number.
_COMMENT: Final = re.compile(rb"#(?!(?<=1\.#)" + text.MSVC_LETTERS.removeprefix(b"#") + rb")[^\n]*")
# Counts may follow without a blank, as in the data set ModelNet40.
_KEYWORD: Final = re.compile(rb"(?:\s|#[^\r\n]*+)*+(((?:ST|C|N)*+)(4?n?)OFF)(?=[\s\d#]|\Z)")
_BINARY: Final = re.compile(rb"[ \t]*BINARY[ \t]*\r?\n")
_COUNT: Final = re.compile(rb"\d{1,18}")


@dataclass(frozen=True)
class _Columns:
    """Columns after x, y, z in the record of a vertex, by the keyword: NOFF, COFF, STOFF..."""

    normal: bool
    colour: bool
    uv: bool

    def widths(self, colour: int) -> list[tuple[Role, int]]:
        """Return roles and their widths in the order of the record; `colour` is that of colours."""
        given: list[tuple[Role, int, bool]] = [
            ("normal", 3, self.normal),
            ("colour", colour, self.colour),
            ("uv", 2, self.uv),
        ]
        return [(role, width) for role, width, has in given if has]


def read(data: bytes) -> PolyMesh:
    """Read an OFF.

    Raises
    ------
    MeshError
        For a file that is not valid, with the line at fault where there is one.
    """
    data = plain_text.utf8(data)
    keyword = _KEYWORD.match(data)
    if keyword is None:
        raise MeshError("it does not begin with 'OFF' (or COFF, NOFF, STOFF)")
    if keyword[3]:
        raise MeshError("its vertices do not have three coordinates (4OFF, nOFF)")
    letters = keyword[2].replace(b"ST", b"T")
    columns = _Columns(b"N" in letters, b"C" in letters, b"T" in letters)
    binary = _BINARY.match(data, keyword.end())
    if binary:
        return read_binary(data[binary.end() :], columns.widths(4))
    data = plain_text.plain(data)
    begin, end = keyword.span(1)
    numbers = data[:begin] + b" " * (end - begin) + data[end:]
    found_comments = [found.start() for found in _COMMENT.finditer(numbers)]
    lines = text.split_lines(text.blanked(_COMMENT, numbers) if found_comments else numbers)
    n, m, at = _counts(lines)
    first = int(lines.token_starts[at]) if at < len(lines.token_starts) else len(data)
    tokens = np.arange(at, len(lines.token_starts))
    values = text.read_numbers(lines.buffer[first:], lines, tokens)
    body = _Body(lines, values, at)
    found = _by_lines(body, n, m, columns) or _as_one_row(body, n, m, columns)
    if found is None:
        message = "its records do not fit its counts of vertices and faces: is it cut short?"
        raise MeshError(message)
    comments = tuple(
        text.as_text(line.strip()[1:])
        for line in data[:first].split(b"\n")
        if line.lstrip().startswith(b"#")
    )
    vertices, corners, offsets, attributes, lost = found
    if len(found_comments) > len(comments):
        lost += ("comments among the numbers",)
    metadata = {"comments": comments} if comments else {}
    return PolyMesh(vertices, corners, offsets, attributes, metadata=metadata, lost=lost)


def _counts(lines: Lines) -> tuple[int, int, int]:
    """Return the counts of vertices and faces, and the first token after the counts."""
    found = [lines.token(i) for i in range(min(3, len(lines.token_starts)))]
    line = int(np.searchsorted(lines.first, 1, side="right"))
    if len(found) == 3 and lines.first[line - 1] == 0 and lines.first[line] == 2:
        found.pop()  # a line of two counts: that of edges, which nobody uses, is left out
    if len(found) < 2 or not all(_COUNT.fullmatch(count) for count in found):
        raise MeshError("it has no counts of vertices, faces and edges: is it cut short?")
    return int(found[0]), int(found[1]), len(found)


@dataclass(frozen=True)
class _Body:
    """The numbers after the counts; `at` is the token of the first."""

    lines: Lines
    values: Floats
    at: int

    def whole(self, at: Ints) -> Bools:
        """Return which of the numbers at some positions are written as whole ones, bool."""
        marks = np.isin(self.lines.buffer, np.frombuffer(b".eEdDnN", dtype=np.uint8))
        before = np.concatenate(([0], np.cumsum(marks)))
        tokens = self.at + at
        fraction = before[self.lines.token_ends[tokens]] > before[self.lines.token_starts[tokens]]
        return ~fraction

    def indices(self, at: Ints) -> Ints:
        """Return the numbers at some positions as vertex indices; others are refused."""
        found = self.values[at]
        with np.errstate(invalid="ignore"):
            indices = found.astype(np.int64)
        bad = indices != found
        if bad.any():
            token = self.at + int(at[np.argmax(bad)])
            what = text.quoted(self.lines.token(token))
            raise self.lines.error(token, f"{what} is not a vertex index")
        return indices


_Found = tuple[Floats, Ints, Ints, tuple[Attribute, ...], tuple[str, ...]]


def _by_lines(body: _Body, n: int, m: int, columns: _Columns) -> _Found | None:
    """Read a record from each line, or return None if lines are not records."""
    begins = body.lines.first[np.searchsorted(body.lines.first, body.at) :] - body.at
    if len(begins) < n + m + 1 or (len(begins) and begins[0]):
        return None
    counts = np.diff(begins)[: n + m]
    starts, faces = begins[:n], begins[n : n + m]
    given = body.values[faces]
    if n and (counts[:n] != counts[0]).any():
        return None
    if not ((given >= 0) & (given == np.floor(given)) & (given < counts[n:])).all():
        return None
    record = int(counts[0]) if n else 3
    colour = 4 if record >= 3 + sum(width for _, width in columns.widths(4)) else 3
    widths = columns.widths(colour)
    used = 3 + sum(width for _, width in widths)
    if record < used:
        return None
    vertices, attributes = _vertices(body, starts, widths)
    lost = [f"{record - used} more numbers of each vertex"] if record > used else []
    if len(begins) > n + m + 1:
        lost.append(f"{len(begins) - n - m - 1} lines after the last face")
    sizes = given.astype(np.int64)
    corners, offsets = _corners(body, faces, sizes)
    colours, others = _face_colours(body, faces + 1 + sizes, counts[n:] - 1 - sizes)
    lost += ["numbers after faces that are not colours"] if others else []
    return vertices, corners, offsets, (*attributes, *colours), tuple(lost)


def _as_one_row(body: _Body, n: int, m: int, columns: _Columns) -> _Found | None:
    """Read records of any lines, or return None unless they end where the numbers do."""
    for colour in (4, 3):
        widths = columns.widths(colour)
        record = 3 + sum(width for _, width in widths)
        if n * record + m > len(body.values):
            continue
        at, sizes = n * record, body.values.tolist()
        faces: list[int] = []
        while len(faces) < m and at < len(sizes) and sizes[at] >= 0:
            faces.append(at)
            at += 1 + int(min(sizes[at], len(sizes)))
        if len(faces) == m and at == len(sizes):
            starts = np.arange(n) * record
            vertices, attributes = _vertices(body, starts, widths)
            begins = np.array(faces, dtype=np.int64)
            corners, offsets = _corners(body, begins, body.indices(begins))
            return vertices, corners, offsets, tuple(attributes), ()
    return None


def _vertices(
    body: _Body, starts: Ints, widths: list[tuple[Role, int]]
) -> tuple[Floats, list[Attribute]]:
    attributes, at = [], 3
    for role, width in widths:
        positions = starts[:, None] + np.arange(at, at + width)
        if role == "colour":
            attributes.append(_colour(body, positions, "vertex", None))
        else:
            attributes.append(Attribute(role, "vertex", body.values[positions], role))
        at += width
    return body.values[starts[:, None] + np.arange(3)].reshape(-1, 3), attributes


def _corners(body: _Body, faces: Ints, sizes: Ints) -> tuple[Ints, Ints]:
    offsets = np.concatenate(([0], np.cumsum(sizes))).astype(np.int64)
    shift = np.repeat(faces + 1 - offsets[:-1], sizes)
    return body.indices(np.arange(offsets[-1]) + shift), offsets


def _face_colours(body: _Body, starts: Ints, counts: Ints) -> tuple[list[Attribute], bool]:
    """Return colours, an attribute for each count of numbers, and whether others are left."""
    found = []
    for width in (1, 3, 4):
        has = counts == width
        if has.any():
            index = None if has.all() else np.where(has, np.cumsum(has) - 1, -1)
            positions = starts[has, None] + np.arange(width)
            found.append(_colour(body, positions, "face", index))
    return found, not np.isin(counts, (0, 1, 3, 4)).all()


def _colour(body: _Body, positions: Ints, domain: Domain, index: Ints | None) -> Attribute:
    """Return colours: whole numbers up to 255, or fractions; one number is an index in a map."""
    values: NDArray[Any] = body.values[positions]
    whole = bool(body.whole(positions.ravel()).all())
    if positions.shape[1] == 1:
        if whole:
            values = values.astype(np.int64)
        return Attribute("colour_index", domain, values, "other", index)
    bytes_ = whole and bool(((values >= 0) & (values <= 255)).all())
    if bytes_:
        values = values.astype(np.uint8)
    return Attribute("colour", domain, values, "colour", index, normalized=bytes_)
