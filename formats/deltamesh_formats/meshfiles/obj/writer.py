"""Writer of Wavefront OBJ."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from deltamesh_formats.array_types import Ints
from deltamesh_formats.meshfiles import text
from deltamesh_formats.meshfiles.file_format import Written
from deltamesh_formats.meshfiles.number_text import rounded, row_texts
from deltamesh_formats.meshfiles.obj import OBJ
from deltamesh_formats.meshfiles.obj.statements import OFF, PARTS
from deltamesh_formats.polymesh.colours import as_fractions, is_rgb
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh
from deltamesh_formats.polymesh.names import distinct_names

# Templates of a corner with its vertex alone, and with vt, vn, or both.
_CORNERS: Final = np.array(["%d", "%d/%d", "%d//%d", "%d/%d/%d"], dtype=object)


def write(mesh: PolyMesh) -> Written:
    """Write an OBJ, with names, polygons, and a set of colours, texture coordinates and normals."""
    colour = next((a for a in mesh.attributes if a.domain == "vertex" and is_rgb(a)), None)
    uv, normal = _table(mesh, "uv", (1, 2, 3)), _table(mesh, "normal", (3,))
    parts = [p for p in mesh.parts if p.kind in PARTS]
    lines = [f"#{text.one_line(line)}" for line in mesh.metadata.get("comments", ())]
    lines += [f"mtllib {text.one_line(name)}" for name in mesh.metadata.get("mtllib", ())]
    lines += [f"v {row}" for row in _vertex_rows(mesh, colour)]
    for keyword, table in (("vt", uv), ("vn", normal)):
        if table is not None:
            lines += [f"{keyword} {row}" for row in row_texts(rounded(table.values, table.margin))]
    lines += _faces(mesh, [_of_corners(mesh, table) for table in (uv, normal)], parts)
    kept = [attribute for attribute in (colour, uv, normal) if attribute is not None]
    data = "\n".join([*lines, ""]).encode(*text.ENCODING)
    return Written(data, OBJ.losses(mesh, kept))


def _table(mesh: PolyMesh, role: str, widths: tuple[int, ...]) -> Attribute | None:
    for a in mesh.attributes:
        fits = a.role == role and a.domain != "face" and a.width in widths
        if fits and a.values.dtype.kind == "f":
            return a
    return None


def _vertex_rows(mesh: PolyMesh, colour: Attribute | None) -> list[str]:
    rows = row_texts(rounded(mesh.vertices, mesh.margin))
    if colour is None:
        return rows
    values = as_fractions(colour.values, normalized=colour.normalized)
    texts = row_texts(rounded(values, colour.margin))
    colours = [*(f" {row}" for row in texts), ""]  # -1, none, is the last
    return [row + colours[i] for row, i in zip(rows, colour.rows().tolist(), strict=True)]


def _of_corners(mesh: PolyMesh, attribute: Attribute | None) -> Ints:
    """Return the row of the attribute's table for each corner, int64 (c,), -1 for none."""
    if attribute is None:
        return np.full(len(mesh.corners), -1, dtype=np.int64)
    rows = attribute.rows()
    return rows if attribute.domain == "corner" else rows[mesh.corners]


def _faces(mesh: PolyMesh, tables: list[Ints], parts: list[Parts]) -> Iterator[str]:
    """Yield the lines of the faces, and the statements of parts where these change."""
    fields = np.stack([mesh.corners, *tables], axis=1) + 1
    has = fields > 0
    templates = _CORNERS[has[:, 1] + 2 * has[:, 2]]
    templates[mesh.offsets[:-1]] = "\nf " + templates[mesh.offsets[:-1]]
    ids = np.stack([np.zeros(len(mesh.sizes), dtype=np.int64), *(p.of_face for p in parts)])
    changes = np.flatnonzero((np.diff(ids, axis=1, prepend=-1) != 0).any(axis=0))
    names = [_statements(p) for p in parts]
    current = [-1] * len(parts)
    for begin, end in zip(changes.tolist(), [*changes[1:].tolist(), len(mesh.sizes)], strict=True):
        for i, (part, statements) in enumerate(zip(parts, names, strict=True)):
            number = int(part.of_face[begin])
            if number != current[i]:
                yield statements[number]
                current[i] = number
        some = slice(int(mesh.offsets[begin]), int(mesh.offsets[end]))
        numbers = fields[some][has[some]].tolist()
        yield " ".join(templates[some].tolist()).replace(" \n", "\n")[1:] % tuple(numbers)


def _statements(parts: Parts) -> list[str]:
    """Return the statement of each part, and last, so that -1 finds it, the one for no part."""
    keyword = PARTS[parts.kind].decode()
    none = OFF[0] if parts.kind == "smoothing" else ""
    reserved = ("", *OFF) if parts.kind == "smoothing" else ("",)
    stripped = (name.strip() for name in parts.names)
    names = distinct_names(stripped, reserved=reserved, stem=parts.kind)
    return [*(text.one_line(f"{keyword} {name}") for name in names), f"{keyword} {none}".rstrip()]
