"""A file to all of its mesh but the positions: the mirror of `structure_encoding`."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.halfedges import ends
from deltamesh._kernels.mesh import cutting
from deltamesh._limits import Counts
from deltamesh._shape.connectivity import decode_connectivity
from deltamesh._shape.corners import copied_points, decode_copies
from deltamesh._shape.merging import decode_polygons
from deltamesh._shape.stitching import complex_faces, decode_stitching, stitched_counts, trivial
from deltamesh._shape.structure import Structure
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.reader import payload_of
from deltamesh_formats.errors import FormatError

_Ints = NDArray[np.int64]

# The sections that are told by the half-edges of the manifold.
_NEED_MANIFOLD: Final = frozenset({"STCH", "COPY", "POLY", "ATTR"})


def announced(container: Container) -> Counts:
    """Return what a file announces.

    Raises
    ------
    FormatError
        For counts that contradict each other.
    """
    sections, isolated = container.sections, container.parameters.isolated
    points, faces = container.vertices, container.triangles
    if "COPY" in sections:
        with payload_of(sections["COPY"]) as payload:
            points = copied_points(payload, container.vertices, isolated)
    vertices = points - isolated
    if "STCH" in sections:
        with payload_of(sections["STCH"]) as payload:
            vertices, faces = stitched_counts(payload, points - isolated, container.triangles)
    return Counts(points, isolated, vertices, faces)


def decode_structure(container: Container, counts: Counts) -> Structure:
    """Return all but the positions: the mirror of `encode_structure`.

    Raises
    ------
    FormatError
    """
    sections, used = container.sections, counts.points - counts.isolated
    with payload_of(sections["CONN"]) as payload:
        faces = decode_connectivity(payload, counts.vertices, counts.faces)
    points, stitching = np.arange(counts.points), trivial(counts.vertices, counts.faces)
    structure = Structure(faces, stitching, used, counts.isolated, faces, points)
    if not _NEED_MANIFOLD & sections.keys():
        return structure
    if not _is_manifold(faces, structure.opposite, counts.vertices):
        raise FormatError("the connectivity is no manifold", sections["CONN"].offset)
    if "STCH" in sections:
        with payload_of(sections["STCH"]) as payload:
            stitching = decode_stitching(
                payload, faces, structure.opposite, used, counts.points, container.triangles
            )
        final = complex_faces(faces, stitching)
        structure = Structure(faces, stitching, used, counts.isolated, final, points)
    if "COPY" in sections:
        with payload_of(sections["COPY"]) as payload:
            copies = decode_copies(payload, structure.corners, container.vertices)
        structure = replace(structure, faces=copies.faces, points=copies.points)
    if "POLY" in sections:
        with payload_of(sections["POLY"]) as payload:
            glued = decode_polygons(payload, structure.faces, structure.partners)
        structure = replace(structure, glued=glued)
    return structure


def _is_manifold(faces: _Ints, opposite: _Ints, n: int) -> bool:
    """Tell whether faces that meet agree in winding, and each vertex has one fan of faces."""
    start, end = ends(faces)
    inner = np.flatnonzero(opposite >= 0)
    if (start[opposite[inner]] != end[inner]).any() or (end[opposite[inner]] != start[inner]).any():
        return False
    return bool(cutting.label_fans(opposite, np.empty(len(opposite), dtype=np.int64)) == n)
