"""Rows of a text PLY that do not fit its header, for messages.

The numbers of a text are read as one row, whatever the lines. Where that fails, the first line with
more or fewer numbers than its record should have is what its author wants to know.
"""

from __future__ import annotations

from collections.abc import Sequence

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.ply.body import Ascii
from deltamesh_formats.meshfiles.ply.header import Element


def misfit(body: Ascii, elements: Sequence[Element]) -> MeshError | None:
    """Return an error about the first line that does not fit its record, None if all fit.

    A last line that is too short is cut short, and what is no count is another fault: both are
    known without this.
    """
    firsts, counts = body.lines.first.tolist(), body.lines.counts.tolist()
    line = 0
    for element in elements:
        for record in range(element.count if element.properties else 0):
            if line == len(counts):
                return None
            first, found = firsts[line], counts[line]
            expected = _expected(body, first, found, element)
            line += 1
            if expected is None or (line == len(counts) and found < expected):
                return None
            if found != expected:
                message = f"{element.name} {record} has {found} numbers, not {expected}"
                return body.error(first, f"{message} as the header says")
    return None


def _expected(body: Ascii, first: int, found: int, element: Element) -> int | None:
    """Return the numbers that a record has, as its header and the counts of its lists say.

    None if one of the counts is none.
    """
    expected = 0
    for prop in element.properties:
        if prop.count_type is not None and expected < found:
            count = float(body.cells[first + expected])
            if not (count.is_integer() and count >= 0):
                return None
            expected += int(count)
        expected += 1
    return expected
