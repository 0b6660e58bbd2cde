"""Variants of ASCII STL, as various programs write it, made uniform.

Some write "end loop", words behind "endloop", facets without a normal, or lines of comments and
colours between the facets. Every line keeps its number.
"""

from __future__ import annotations

import re
from typing import Final

from deltamesh_formats.meshfiles import text

_FLAGS: Final = re.MULTILINE | re.IGNORECASE
_END_APART: Final = re.compile(rb"^([ \t]*end)[ \t]+(?=(?:loop|facet)\b)", _FLAGS)
# What follows is another statement on the same line, or words that mean nothing.
_BEHIND_END: Final = re.compile(
    rb"^([ \t]*(?:endloop|endfacet|outer[ \t]+loop)\b)(?!\s*(?:endfacet|facet|vertex)\b)[^\n]*",
    _FLAGS,
)
_BARE_FACET: Final = re.compile(rb"^([ \t]*facet)[ \t\r]*$(?!\s*normal)", _FLAGS)
_BARE_NORMAL: Final = re.compile(rb"^([ \t]*facet[ \t]+normal)[ \t\r]*$(?!\s*[-+.\d])", _FLAGS)
_COMMENT: Final = re.compile(rb"^[ \t]*(?:#|//|;)[^\n]*", _FLAGS)
_BETWEEN_FACETS: Final = re.compile(
    rb"(?:\A|^[ \t]*endfacet\b[^\n]*\n)(?:(?![ \t]*facet\b)[^\n]*\n)*", _FLAGS
)
# A line that has no word of a facet, and no number, at its beginning.
_STRANGE: Final = re.compile(
    rb"^[ \t]*(?!(?:end)?solid|(?:facet|normal|outer|loop|vertex|end|endloop|endfacet)\b)"
    rb"[^\s\d.+-][^\n]*",
    _FLAGS,
)


def uniform(data: bytes) -> tuple[bytes, tuple[str, ...]]:
    """Return an ASCII STL as the format defines it, and descriptions of what is left out.

    Lines that begin or end solids stay as they are.
    """
    if not data.endswith(b"\n"):
        data += b"\n"
    data = _END_APART.sub(rb"\1", data)
    data = _BEHIND_END.sub(rb"\1", data)
    data = _BARE_FACET.sub(rb"\1 normal 0 0 0", data)
    data = _BARE_NORMAL.sub(rb"\1 0 0 0", data)
    left_out: list[bytes] = []

    def note(found: re.Match[bytes]) -> bytes:
        left_out.append(found[0].strip())
        return b""

    data = _COMMENT.sub(note, data)
    data = _BETWEEN_FACETS.sub(lambda found: _STRANGE.sub(note, found[0]), data)
    lost = (f"lines that are no part of a facet ({text.quoted(left_out[0])})",) if left_out else ()
    return data, lost
