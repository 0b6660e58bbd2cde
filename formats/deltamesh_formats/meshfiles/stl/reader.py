"""Reader of binary STL, and of text STL with one or several solids.

An STL repeats the position of each corner. Vertices at one position become one, in the order in
which they first appear. Normals are dropped, since they follow from the positions; those that do
not are named as lost. The two bytes of each binary facet, in which some programs put colours,
become the attribute "attribute_bytes". Bytes after the last facet are named as lost.
"""

from __future__ import annotations

import re
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles import plain_text, text
from deltamesh_formats.meshfiles.stl.variants import uniform
from deltamesh_formats.meshfiles.text import Lines
from deltamesh_formats.meshfiles.welding import welded
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh

_HEADER: Final = 84
FACET: Final = np.dtype([("normal", "<f4", 3), ("vertices", "<f4", (3, 3)), ("attribute", "<u2")])
ATTRIBUTE: Final = "attribute_bytes"
# Cosine of the largest angle between two normals of a facet that are taken for the same, and the
# area of a facet, over its squared sides, up to which it has no normal.
_ALIKE: Final = 0.9
_SLIVER: Final = 1e-3
_TEXT: Final = re.compile(rb"^[ \t]*(?:(?:end[ \t]*)?solid|facet\b)", re.MULTILINE | re.IGNORECASE)
# The name follows "solid"; some programs put no blank before it.
_SOLID: Final = re.compile(rb"^[ \t]*(end[ \t]*)?solid([^\n]*)$", re.MULTILINE | re.IGNORECASE)
# Tokens of a facet; "#" stands for a number.
_FACET: Final = (
    b"facet normal # # # outer loop" + 3 * b" vertex # # #" + b" endloop endfacet"
).split()
_KEYWORDS: Final = np.array([token != b"#" for token in _FACET])


def read(data: bytes) -> PolyMesh:
    """Read an STL. A file whose length fits its count of facets is binary, however it begins.

    Raises
    ------
    MeshError
        For a file that is neither, with the line at fault of a text.
    """
    facets = int.from_bytes(data[_HEADER - 4 : _HEADER], "little")
    expected = _HEADER + FACET.itemsize * facets
    if len(data) >= _HEADER and len(data) == expected:
        return _read_binary(data)
    as_text = _text(data)
    if as_text is not None:
        return _read_ascii(as_text)
    more, rest = divmod(max(len(data) - _HEADER, 0), FACET.itemsize)
    if not facets and more and not rest:
        # A program wrote its header before it knew the count, and never replaced it.
        return _read_binary(data, "the count of facets in the header, 0")
    if 0 < facets < more and not rest:
        raise MeshError(f"its header counts {facets} facets, but it has the length of {more}")
    if facets and len(data) > expected:
        lost = f"{len(data) - expected} bytes after the last facet"
        return _read_binary(data[:expected], lost)
    message = f"neither an ASCII STL nor a binary one, whose header of {facets} facets would mean"
    raise MeshError(f"{message} {expected} bytes: it has {len(data)}")


def _text(data: bytes) -> bytes | None:
    """Return the text of an ASCII STL, None for other bytes."""
    try:
        found = plain_text.plain(data)
    except MeshError:
        return None
    return None if b"\0" in found or not _TEXT.search(found) else found


def _read_binary(data: bytes, *lost: str) -> PolyMesh:
    facets = np.frombuffer(data, dtype=FACET, offset=_HEADER)
    attributes: tuple[Attribute, ...] = ()
    if facets["attribute"].any():
        raw = facets["attribute"].astype(np.uint16)[:, None]
        attributes = (Attribute(ATTRIBUTE, "face", raw),)
    header = text.as_text(data[: _HEADER - 4].rstrip(b"\0 "))
    vertices, corners = welded(facets["vertices"].reshape(-1, 3).astype(np.float64))
    return PolyMesh(
        vertices,
        corners,
        3 * np.arange(len(facets) + 1, dtype=np.int64),
        attributes,
        metadata={"header": (header,)} if header else {},
        lost=(*lost, *_other_normals(facets["normal"], facets["vertices"])),
        precision="float32",
    )


def _read_ascii(data: bytes) -> PolyMesh:
    lost: tuple[str, ...] = ()
    try:
        solids, lines, facets = _facets(data)
    except MeshError:
        data, lost = uniform(data)
        solids, lines, facets = _facets(data)
    if facets and solids and not solids[-1][1]:
        lost += ("the end of the last solid: it may be cut short",)
    tokens = np.flatnonzero(~np.tile(_KEYWORDS, facets))
    buffer = lines.buffer.copy()
    text.blank_tokens(buffer, lines, np.flatnonzero(np.tile(_KEYWORDS, facets)))
    values = text.read_numbers(buffer, lines, tokens).reshape(-1, 12)
    vertices, corners = welded(values[:, 3:].reshape(-1, 3))
    begun = [found for found in solids if not found[1]]
    names = [text.as_text(found[2].strip()) for found in begun]
    facet_starts = lines.token_starts[:: len(_FACET)]
    of_face = np.searchsorted([found.start() for found in begun], facet_starts) - 1
    return PolyMesh(
        vertices,
        corners,
        3 * np.arange(facets + 1, dtype=np.int64),
        parts=_objects(names, of_face),
        lost=(*lost, *_other_normals(values[:, :3], values[:, 3:].reshape(-1, 3, 3))),
    )


def _facets(data: bytes) -> tuple[list[re.Match[bytes]], Lines, int]:
    """Return the lines that begin or end solids, the other ones, and the number of facets."""
    lines = text.split_lines(text.blanked(_SOLID, data))
    return list(_SOLID.finditer(data)), lines, _check_facets(lines)


def _other_normals(normals: NDArray[Any], triangles: NDArray[Any]) -> tuple[str, ...]:
    """Describe the loss if normals, (m, 3), differ from those of the triangles, (m, 3, 3).

    Zero normals and slivers are left out of the comparison.
    """
    with np.errstate(all="ignore"):
        V = triangles.astype(np.float64)
        sides = V[:, 1:] - V[:, :1]
        area = np.cross(sides[:, 0], sides[:, 1])
        size, length = np.linalg.norm(area, axis=1), np.linalg.norm(normals, axis=1)
        solid = size > _SLIVER * (sides**2).sum(axis=(1, 2))
        cosine = (normals * area).sum(axis=1) / (size * length)
    other = solid & (length > 0) & (cosine < _ALIKE)
    return ("normals that are not those of their facets",) if other.any() else ()


def _objects(names: list[str], of_face: Ints) -> tuple[Parts, ...]:
    """Return the solids that have facets as objects, unless there is but one without a name.

    Facets above the first solid, -1, are in none.
    """
    used, of_face = np.unique(of_face, return_inverse=True)
    none = int(len(used) > 0 and used[0] == -1)
    kept = tuple(names[i] for i in used[none:].tolist())
    if not kept or (kept == ("",) and not none):
        return ()
    return (Parts("object", kept, of_face.astype(np.int64) - none),)


def _check_facets(lines: Lines) -> int:
    """Return the number of facets.

    Raises
    ------
    MeshError
        For the first token that is not the one of a facet in its place.
    """
    count = len(lines.token_starts)
    expected = np.array([text.keyword(token) for token in _FACET])
    where = np.arange(count) % len(_FACET)
    keywords = np.flatnonzero(_KEYWORDS[where])
    lower = np.where((lines.buffer >= 65) & (lines.buffer <= 90), lines.buffer + 32, lines.buffer)
    found = text.keywords(lower, lines.token_starts, lines.token_ends, keywords)
    bad = found != expected[where[keywords]]
    if bad.any():
        token = int(keywords[np.argmax(bad)])
        keyword = _FACET[where[token]].decode()
        raise lines.error(token, f"{text.quoted(lines.token(token))} where '{keyword}' belongs")
    if count % len(_FACET):
        raise MeshError("its last facet has no end: is it cut short?")
    return count // len(_FACET)
