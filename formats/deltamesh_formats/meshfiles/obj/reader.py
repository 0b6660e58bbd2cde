"""Reader of OBJ (Wavefront, Object Files, version 3.0, appendix B1).

It keeps positions with colours after them (a common extension), texture coordinates and normals
with their own indices, polygons, objects, groups, smoothing groups, and names of materials and of
their libraries. Normals or texture coordinates become attributes of the vertices where there is
one for each vertex, in their order. Their indices are left out, and named, where they are 0 or the
file has no such table: the faces are sound.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.meshfiles import plain_text, text
from deltamesh_formats.meshfiles.obj.comments import comments_of, polypaint, statements
from deltamesh_formats.meshfiles.obj.statements import KEPT, OFF, OTHERS, PARTS
from deltamesh_formats.meshfiles.text import Lines
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh, Role

# Fields of a corner, v/vt/vn, in their order.
_FIELDS: Final = ("vertex", "texture coordinate", "normal")


def read(data: bytes) -> PolyMesh:
    """Read an OBJ.

    Raises
    ------
    MeshError
        For a statement that is not valid; the line is named.
    """
    data = plain_text.plain(data)
    lines = text.split_lines(statements(data))
    words = lines.keywords()
    where = {key: words == text.keyword(key) for key in KEPT}
    where[b"f"] = where[b"f"] | where.pop(b"fo")
    vertices, colours, weighted = _vertices(lines, where[b"v"])
    tables = {
        "texture coordinate": _table(lines, where[b"vt"], "a texture coordinate", 1, 3),
        "normal": _table(lines, where[b"vn"], "a normal", 3, 3),
    }
    faces = _faces(lines, where, [len(vertices), *(len(table) for table in tables.values())])
    attributes, unused = _attributes(tables, faces, len(vertices))
    painted, unfit = polypaint(data, len(vertices), len(colours))
    comments, has_more = comments_of(data)
    lost = ["weights of vertices"] if weighted else []
    lost += [*faces.missing, *unused, *unfit, *_others(lines, words)]
    lost += ["comments below the first statement"] if has_more else []
    return PolyMesh(
        vertices,
        faces.indices[0],
        faces.offsets,
        (*colours, *painted, *attributes),
        tuple(_parts(lines, data, where)),
        _metadata(lines, data, where[b"mtllib"], comments),
        tuple(lost),
    )


class _Faces(NamedTuple):
    """Faces: an array of indices for each field of a corner, from 0, -1 for none; offsets.

    `missing` describes indices of what the file does not have.
    """

    indices: list[Ints]
    offsets: Ints
    missing: list[str]


def _rows(lines: Lines, chosen: Bools) -> tuple[Floats, Ints, Ints]:
    """Return the numbers of some lines, and of each line the place of the first and the count."""
    cut, tokens = text.without_first_tokens(lines, chosen)
    counts = lines.counts[chosen] - 1
    return text.read_numbers(cut, lines, tokens), np.cumsum(counts) - counts, counts


def _check_counts(lines: Lines, chosen: Bools, fits: Bools, what: str) -> None:
    if not fits.all():
        line = np.flatnonzero(chosen)[np.argmin(fits)]
        found = lines.counts[line] - 1
        raise lines.error(int(lines.first[line]), f"{what} of {found} numbers")


def _vertices(lines: Lines, chosen: Bools) -> tuple[Floats, list[Attribute], bool]:
    """Return positions, colours, and whether there are weights: x y z, x y z w, x y z r g b (a)."""
    flat, starts, counts = _rows(lines, chosen)
    _check_counts(lines, chosen, np.isin(counts, (3, 4, 6, 7)), "a vertex")
    if len(counts) and (counts == 3).all():
        return flat.reshape(-1, 3), [], False
    colours = []
    for width in (3, 4):
        has = counts == 3 + width
        if has.any():
            values = flat[starts[has, None] + np.arange(3, 3 + width)]
            index = None if has.all() else np.where(has, np.cumsum(has) - 1, -1)
            colours.append(Attribute("colour", "vertex", values, "colour", index))
    weighted = bool((flat[starts[counts == 4] + 3] != 1).any())
    return flat[starts[:, None] + np.arange(3)].reshape(-1, 3), colours, weighted


def _table(lines: Lines, chosen: Bools, what: str, least: int, most: int) -> Floats:
    """Return the rows of `vt` or `vn`; numbers that a line leaves out are 0, as specified."""
    flat, starts, counts = _rows(lines, chosen)
    _check_counts(lines, chosen, (counts >= least) & (counts <= most), what)
    width = int(counts.max(initial=least))
    found = np.zeros((len(counts), width))
    for i in range(width):
        found[counts > i, i] = flat[starts[counts > i] + i]
    return found


def _faces(lines: Lines, where: Mapping[bytes, Bools], sizes: list[int]) -> _Faces:
    """Return the faces: corners v, v/vt, v//vn or v/vt/vn, which count from 1, or back from -1."""
    chosen = where[b"f"]
    cut, tokens = text.without_first_tokens(lines, chosen)
    slashes = cut == ord("/")
    plain = np.where(slashes, np.uint8(ord(" ")), cut)
    at, _ = text.token_bounds(plain)
    corner, fields = np.arange(len(at)), np.zeros(len(at), dtype=np.int64)
    if slashes.any():
        begins, _ = text.token_bounds(cut)
        corner = np.searchsorted(begins, at, side="right") - 1
        before = np.cumsum(slashes) - slashes
        fields = before[at] - before[begins[corner]]
    _check_fields(lines, tokens, corner, fields)
    given = text.read_numbers(plain, lines, tokens[corner], int)
    face_lines = np.flatnonzero(chosen)
    counts = lines.counts[face_lines] - 1
    line_of_corner = np.repeat(face_lines, counts)
    indices, missing = [], []
    for field, key in enumerate((b"v", b"vt", b"vn")):
        mine = fields == field
        found, of = given[mine], corner[mine]
        if field and len(found):
            is_there = (found != 0) & (sizes[field] > 0)
            if not is_there.all():
                missing.append(f"indices of {_FIELDS[field]}s that the file does not have")
                found, of = found[is_there], of[is_there]
        above = np.searchsorted(np.flatnonzero(where[key]), line_of_corner[of])
        absolute = np.where(found > 0, found - 1, above + found)
        bad = (found == 0) | (absolute < 0) | (absolute >= sizes[field])
        if bad.any():
            i = int(np.argmax(bad))
            raise lines.error(
                int(tokens[of[i]]), _bad_index(_FIELDS[field], int(found[i]), sizes[field])
            )
        rows = np.full(len(line_of_corner), -1, dtype=np.int64)
        rows[of] = absolute
        indices.append(rows)
    return _Faces(indices, np.concatenate(([0], np.cumsum(counts))).astype(np.int64), missing)


def _bad_index(what: str, index: int, count: int) -> str:
    if index == 0:
        return f"a face has the {what} index 0, but OBJ counts from 1"
    return f"a face refers to {what} {index}, of {count}"


def _check_fields(lines: Lines, tokens: Ints, corner: Ints, fields: Ints) -> None:
    """Refuse corners without a vertex or with more than v/vt/vn."""
    bad = fields > 2
    if bad.any():
        token = int(tokens[corner[np.argmax(bad)]])
        raise lines.error(token, f"{text.quoted(lines.token(token))} is not of the form v/vt/vn")
    has = np.zeros(len(tokens), dtype=bool)
    has[corner[fields == 0]] = True
    if not has.all():
        token = int(tokens[np.argmin(has)])
        raise lines.error(token, f"{text.quoted(lines.token(token))} names no vertex")


def _attributes(
    tables: Mapping[str, Floats], faces: _Faces, n: int
) -> tuple[list[Attribute], list[str]]:
    """Return texture coordinates and normals, and descriptions of tables that no face refers to."""
    names: tuple[tuple[str, Role], ...] = (("uv", "uv"), ("normal", "normal"))
    found, unused = [], []
    for (what, table), (name, role), index in zip(
        tables.items(), names, faces.indices[1:], strict=True
    ):
        if len(table) == n and np.array_equal(index, faces.indices[0]):
            found.append(Attribute(name, "vertex", table, role))
        elif (index >= 0).any():
            found.append(Attribute(name, "corner", table, role, index))
        elif len(table):
            unused.append(f"{what}s that no face refers to")
    return found, unused


def _parts(lines: Lines, data: bytes, where: Mapping[bytes, Bools]) -> list[Parts]:
    """Return the parts that o, g, usemtl and s begin; without a name, or off, they begin none."""
    face_lines, found = np.flatnonzero(where[b"f"]), []
    for kind, key in PARTS.items():
        at = np.flatnonzero(where[key])
        numbers: dict[str, int] = {"": -1}
        if kind == "smoothing":
            numbers |= dict.fromkeys(OFF, -1)
        names = [_rest(lines, data, int(line)) for line in at]
        ids = [-1, *(numbers.setdefault(name, len(numbers)) for name in names)]
        of_face = np.array(ids)[np.searchsorted(at, face_lines)]
        used, of_face = np.unique(of_face, return_inverse=True)
        by_number = {number: name for name, number in numbers.items() if number >= 0}
        if used.max(initial=-1) >= 0:
            none = int(used[0] == -1)
            kept = tuple(by_number[i] for i in used[none:].tolist())
            found.append(Parts(kind, kept, of_face.astype(np.int64) - none))
    return found


def _rest(lines: Lines, data: bytes, line: int) -> str:
    """Return the text after the keyword of a line, of any bytes."""
    start = int(lines.token_ends[lines.first[line]])
    end = data.find(b"\n", start)
    return text.as_text(data[start : end if end >= 0 else None].strip())


def _metadata(
    lines: Lines, data: bytes, libraries: Bools, comments: tuple[str, ...]
) -> dict[str, tuple[str, ...]]:
    names = tuple(_rest(lines, data, int(line)) for line in np.flatnonzero(libraries))
    return {key: found for key, found in (("comments", comments), ("mtllib", names)) if found}


def _others(lines: Lines, words: NDArray[np.uint64]) -> list[str]:
    """Return descriptions of the statements that are not kept."""
    strange = ~np.isin(words, [text.keyword(key) for key in KEPT])
    found = []
    for what, keys in OTHERS.items():
        mine = strange & np.isin(words, [text.keyword(key) for key in keys])
        if mine.any():
            found.append(what)
            strange &= ~mine
    if strange.any():
        token = int(lines.first[np.argmax(strange)])
        found.append(f"statements unknown to OBJ ({text.quoted(lines.token(token))})")
    return found
