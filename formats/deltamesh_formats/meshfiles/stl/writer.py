"""Writer of STL: binary, or text where there are objects, whose names solids have."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Floats
from deltamesh_formats.meshfiles import text
from deltamesh_formats.meshfiles.file_format import Written
from deltamesh_formats.meshfiles.float32 import (
    rounding_error,
    rounding_losses,
    single_positions,
)
from deltamesh_formats.meshfiles.number_text import number_texts, rounded
from deltamesh_formats.meshfiles.stl import STL
from deltamesh_formats.meshfiles.stl.reader import ATTRIBUTE, FACET
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh

_HEADER_SIZE: Final = 80
# Of the normals in a text, which no program but a viewer needs: they follow from the positions.
_NORMAL_MARGIN: Final = 1e-6
_FACET: Final = (
    "  facet normal {} {} {}\n    outer loop\n"
    + 3 * "      vertex {} {} {}\n"
    + "    endloop\n  endfacet\n"
).replace("{}", "%s")


def write(mesh: PolyMesh) -> Written:
    """Write an STL; a binary one holds float32 positions."""
    objects, extra = _named(mesh), []
    if len(np.unique(mesh.corners)) < len(mesh.vertices):
        extra.append("vertices of no face")
    if objects is not None:
        data = "".join(_solids(mesh, objects)).encode(*text.ENCODING)
        return Written(data, (*STL.losses(mesh, []), *extra))
    positions = single_positions(mesh.vertices, STL.title)
    extra += rounding_losses("positions", rounding_error(positions, mesh.vertices), mesh.margin)
    data, kept = _binary(mesh, positions)
    return Written(data, (*STL.losses(mesh, kept), *extra))


def _named(mesh: PolyMesh) -> Parts | None:
    """Return the objects; None if there are none, or but one without a name."""
    objects = mesh.parts_of("object")
    if objects is None or (objects.names == ("",) and (objects.of_face == 0).all()):
        return None
    return objects


def _normals(triangles: Floats) -> NDArray[np.float32]:
    """Return the unit normals of triangles, (m, 3, 3); zeros for those without area."""
    with np.errstate(all="ignore"):
        sides = triangles[:, 1:] - triangles[:, :1]
        sides /= np.abs(sides).max(axis=(1, 2), keepdims=True)
        normals = np.cross(sides[:, 0], sides[:, 1])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return np.nan_to_num(normals, nan=0.0, posinf=0.0, neginf=0.0).astype(np.float32)


def _binary(mesh: PolyMesh, positions: NDArray[np.float32]) -> tuple[bytes, list[Attribute]]:
    cut = mesh.triangulation()
    facets = np.zeros(len(cut.faces), dtype=FACET)
    facets["vertices"] = positions[cut.faces]
    facets["normal"] = _normals(mesh.vertices[cut.faces])
    kept = []
    for a in mesh.attributes:
        if a.name == ATTRIBUTE and a.domain == "face" and a.values.dtype == np.uint16:
            facets["attribute"] = a.dense()[cut.polygon, 0]
            kept.append(a)
            break
    header = (*mesh.metadata.get("header", ()), "")[0].encode(*text.ENCODING)[:_HEADER_SIZE]
    count = np.array([len(facets)], dtype="<u4")
    return header.ljust(_HEADER_SIZE, b"\0") + count.tobytes() + facets.tobytes(), kept


def _solids(mesh: PolyMesh, objects: Parts) -> Iterator[str]:
    """Yield the text of a solid for the faces without an object, and of one for each object."""
    cut = mesh.triangulation()
    rows = number_texts(rounded(mesh.vertices, mesh.margin))
    points = np.array(rows, dtype=object).reshape(-1, 3)[cut.faces].reshape(-1, 9)
    normals = number_texts(rounded(_normals(mesh.vertices[cut.faces]), _NORMAL_MARGIN))
    facets = np.concatenate([np.array(normals, dtype=object).reshape(-1, 3), points], axis=1)
    of_facet = objects.of_face[cut.polygon]
    facets = facets[np.argsort(of_facet, kind="stable")]
    ends = np.cumsum(np.bincount(of_facet + 1, minlength=len(objects.names) + 1)).tolist()
    for name, begin, end in zip(("", *objects.names), (0, *ends), ends, strict=False):
        mine = facets[begin:end]
        if len(mine):
            solid = f"solid {text.one_line(name)}".rstrip()
            yield f"{solid}\n"
            yield len(mine) * _FACET % tuple(mine.ravel().tolist())
            yield f"end{solid}\n"
