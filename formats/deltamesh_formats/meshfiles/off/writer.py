"""A mesh to OFF, as text: the mirror of `off_in`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.meshfiles import numbers as numbers_out
from deltamesh_formats.meshfiles import text
from deltamesh_formats.meshfiles.written import Written
from deltamesh_formats.polymesh.descriptions import unkept
from deltamesh_formats.polymesh.mesh import Attribute, Domain, PolyMesh


def write(mesh: PolyMesh) -> Written:
    """Write an OFF: polygons; normals, colours, texture coordinates of vertices; face colours."""
    normal, uv = _of_vertices(mesh, "normal", 3), _of_vertices(mesh, "uv", 2)
    colour, face_colour = _colour(mesh, "vertex"), _colour(mesh, "face")
    keyword = "".join(("ST" if uv else "", "C" if colour else "", "N" if normal else "", "OFF"))
    lines = [keyword, *(f"#{text.one_line(c)}" for c in mesh.metadata.get("comments", ()))]
    lines.append(f"{len(mesh.vertices)} {len(mesh.sizes)} 0")
    rows = [numbers_out.rows(numbers_out.positions(mesh))]
    rows += [numbers_out.rows(a.dense()) for a in (normal,) if a is not None]
    rows += [numbers_out.rows(_shades(a, a.dense())) for a in (colour,) if a is not None]
    rows += [numbers_out.rows(a.dense()) for a in (uv,) if a is not None]
    lines += map(" ".join, zip(*rows, strict=True))
    kept = [a for a in (normal, colour, uv, face_colour) if a is not None]
    body = "\n".join([*lines, _faces(mesh, face_colour)])
    words = unkept(mesh, attributes=kept, polygons=True)
    return Written(body.encode(*text.ENCODING), words)


def _of_vertices(mesh: PolyMesh, role: str, width: int) -> Attribute | None:
    for a in mesh.attributes:
        fits = a.role == role and a.domain == "vertex" and a.width == width
        if fits and a.values.dtype.kind == "f":
            return a
    return None


def _colour(mesh: PolyMesh, domain: Domain) -> Attribute | None:
    for a in mesh.attributes:
        known = a.normalized or a.values.dtype.kind == "f"
        if a.role == "colour" and a.domain == domain and a.width in (3, 4) and known:
            return a
    return None


def _shades(attribute: Attribute, values: NDArray[Any]) -> NDArray[Any]:
    """Return bytes as they are, which OFF has too, and other whole numbers as fractions."""
    if values.dtype == np.uint8:
        return values
    return numbers_out.fractions(values, attribute.normalized)


def _faces(mesh: PolyMesh, colour: Attribute | None) -> str:
    """Return the lines of the faces."""
    templates = np.full(len(mesh.corners), " %d", dtype=object)
    heads = np.array([f"\n{size}" for size in mesh.sizes.tolist()], dtype=object)
    tails = np.full(len(mesh.sizes), "", dtype=object)
    if colour is not None:
        rows = [*(f" {row}" for row in numbers_out.rows(_shades(colour, colour.values))), ""]
        tails = np.array(rows, dtype=object)[colour.rows()]
    starts = mesh.offsets[:-1]
    templates[starts] = heads + templates[starts]
    templates[mesh.offsets[1:] - 1] += tails
    return "".join(templates.tolist())[1:] % tuple(mesh.corners.tolist()) + "\n"
