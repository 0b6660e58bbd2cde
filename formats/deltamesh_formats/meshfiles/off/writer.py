"""Writer of OFF, as text."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.meshfiles import text
from deltamesh_formats.meshfiles.file_format import Written
from deltamesh_formats.meshfiles.number_text import rounded, row_texts
from deltamesh_formats.meshfiles.off import OFF
from deltamesh_formats.polymesh.colours import as_fractions, is_rgb
from deltamesh_formats.polymesh.mesh import Attribute, Domain, PolyMesh


def write(mesh: PolyMesh) -> Written:
    """Write an OFF, with normals, colours and texture coordinates of vertices, and face colours."""
    normal, uv = _of_vertices(mesh, "normal", 3), _of_vertices(mesh, "uv", 2)
    colour, face_colour = _colour(mesh, "vertex"), _colour(mesh, "face")
    keyword = "".join(("ST" if uv else "", "C" if colour else "", "N" if normal else "", "OFF"))
    lines = [keyword, *(f"#{text.one_line(c)}" for c in mesh.metadata.get("comments", ()))]
    lines.append(f"{len(mesh.vertices)} {len(mesh.sizes)} 0")
    rows = [row_texts(rounded(mesh.vertices, mesh.margin))]
    rows += [row_texts(rounded(a.dense(), a.margin)) for a in (normal,) if a is not None]
    rows += [row_texts(_shades(a, a.dense()), points=True) for a in (colour,) if a is not None]
    rows += [row_texts(rounded(a.dense(), a.margin)) for a in (uv,) if a is not None]
    lines += map(" ".join, zip(*rows, strict=True))
    kept = [a for a in (normal, colour, uv, face_colour) if a is not None]
    body = "\n".join([*lines, _faces(mesh, face_colour)])
    return Written(body.encode(*text.ENCODING), OFF.losses(mesh, kept))


def _of_vertices(mesh: PolyMesh, role: str, width: int) -> Attribute | None:
    for a in mesh.attributes:
        fits = a.role == role and a.domain == "vertex" and a.width == width
        if fits and a.values.dtype.kind == "f":
            return a
    return None


def _colour(mesh: PolyMesh, domain: Domain) -> Attribute | None:
    return next((a for a in mesh.attributes if a.domain == domain and is_rgb(a)), None)


def _shades(attribute: Attribute, values: NDArray[Any]) -> NDArray[Any]:
    """Return bytes as they are, since OFF has these too, and other integers as fractions."""
    if values.dtype == np.uint8:
        return values
    return rounded(as_fractions(values, normalized=attribute.normalized), attribute.margin)


def _faces(mesh: PolyMesh, colour: Attribute | None) -> str:
    """Return the lines of the faces."""
    templates = np.full(len(mesh.corners), " %d", dtype=object)
    heads = np.array([f"\n{size}" for size in mesh.sizes.tolist()], dtype=object)
    tails = np.full(len(mesh.sizes), "", dtype=object)
    if colour is not None:
        shades = row_texts(_shades(colour, colour.values), points=True)
        rows = [*(f" {row}" for row in shades), ""]
        tails = np.array(rows, dtype=object)[colour.rows()]
    starts = mesh.offsets[:-1]
    templates[starts] = heads + templates[starts]
    templates[mesh.offsets[1:] - 1] += tails
    return "".join(templates.tolist())[1:] % tuple(mesh.corners.tolist()) + "\n"
