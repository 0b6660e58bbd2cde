"""Section COPY: the vertices at each point of a complex, where a point is split into several.

The payload is the number of points, the number of isolated vertices beside the first of each
point, then a range coded stream: the wedges, one for each vertex in faces, and how many isolated
vertices each point has (`deltamesh._kernels.coding.wedges`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from deltamesh._kernels.coding import wedges as kernels
from deltamesh._kernels.coding.coder import Coder
from deltamesh._shape.draft import ShapeDraft
from deltamesh._shape.provenance import TriangleProvenance
from deltamesh._shape.structure import Structure
from deltamesh._shape.wedges import Corners, code_wedges
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh_formats.array_types import Ints
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.fields import read_varint, write_varint
from deltamesh_formats.errors import FormatError


@dataclass(frozen=True)
class SplitVertices:
    """The vertices at each point.

    Attributes
    ----------
    faces : int64 (f, 3)
        Of the complex, over vertices.
    points : int64 (n,)
        Of the vertices, ascending. At a point come first those in faces, then the others.
    """

    faces: Ints
    points: Ints


def applies(draft: ShapeDraft) -> bool:
    """Return whether several input vertices are at one point."""
    return int(np.count_nonzero(draft.input.kept)) > draft.structure.complex.point_count


def encode(draft: ShapeDraft) -> tuple[bytes, ShapeDraft]:
    """Return the payload of COPY, and the draft with its vertices; the mirror is `decode`."""
    source, structure = draft.input, draft.structure
    built, provenance = structure.complex, draft.triangle_provenance
    points = draft.points
    corners = built.corners
    vertex = source.triangles.faces.ravel()[provenance.corners.ravel()]
    isolated = np.flatnonzero(source.kept & ~source.in_face)
    further = np.bincount(points[isolated], minlength=built.point_count)
    further -= np.bincount(corners.points, minlength=built.point_count) == 0
    payload, wedges = _encode(corners, vertex, further)
    split = split_vertices(corners, wedges, further)
    vertices = np.full(len(split.points), -1, dtype=np.int64)
    vertices[split.faces.ravel()] = vertex
    vertices[vertices < 0] = isolated[np.argsort(points[isolated], kind="stable")]
    return payload, replace(
        draft,
        structure=replace(structure, faces=split.faces, points=split.points),
        triangle_provenance=TriangleProvenance(provenance.points, vertices, provenance.corners),
    )


def _encode(corners: Corners, wedges: Ints, further: Ints) -> tuple[bytes, Ints]:
    """Return the payload, and the wedges as they are decoded.

    wedges : int64 (3 f,), the vertex of each corner, in any numbering.
    further : int64 (p,), isolated vertices at each point, without the only vertex of a point.
    """
    total = int(further.sum())
    elements = len(wedges) + len(further) + total
    coded = np.empty_like(wedges)

    def run(coder: Coder) -> None:
        coded[:] = code_wedges(coder, corners, wedges)
        if total:
            kernels.code_isolated(coder, further.copy(), total)

    counts = write_varint(len(further)) + write_varint(total)
    return counts + encode_with(kernels.MODEL, elements, run), coded


def read_point_count(payload: memoryview, vertices: int, isolated: int) -> int:
    """Return the number of points that a payload announces.

    Raises
    ------
    FormatError
        For counts that contradict the numbers of vertices and isolated points of the file.
    """
    count, at = read_varint(payload, 0)
    further, _ = read_varint(payload, at)
    if not isolated <= count < vertices or further > vertices - count:
        raise FormatError("the counts of points contradict those of the header", 0)
    return count


def decode(payload: memoryview, container: Container, structure: Structure) -> Structure:
    """Return the structure with its vertices: the mirror of `encode`.

    Raises
    ------
    FormatError
        If no encoder has written the payload; the offset counts from its beginning.
    """
    corners = structure.complex.corners
    count, at = read_varint(payload, 0)
    total, at = read_varint(payload, at)
    further = np.zeros(count, dtype=np.int64)

    def run(coder: Coder) -> Ints:
        wedges = code_wedges(coder, corners, np.zeros(0, dtype=np.int64))
        if total and not kernels.code_isolated(coder, further, total):
            raise FormatError(
                "split vertices: another number of isolated vertices than announced", at
            )
        return wedges

    wedges = decode_with(kernels.MODEL, payload[at:], run, at)
    split = split_vertices(corners, wedges, further)
    if len(split.points) != container.vertices:
        raise FormatError("split vertices: another number of vertices than in the header", at)
    return replace(structure, faces=split.faces, points=split.points)


def split_vertices(corners: Corners, wedges: Ints, further: Ints) -> SplitVertices:
    """Return the vertices at each point.

    Parameters
    ----------
    corners : Corners
    wedges : int64 (3 f,)
        As `wedges.code_wedges` returns them.
    further : int64 (p,)
        Number of isolated vertices at each point, without the only vertex of a point.
    """
    points = corners.points[corners.rank]
    owner = np.zeros(int(wedges.max(initial=-1)) + 1, dtype=np.int64)
    owner[wedges] = points
    in_faces = np.bincount(owner, minlength=len(further))
    count = np.maximum(in_faces, 1) + further
    first = np.cumsum(count) - count
    shift = first - (np.cumsum(in_faces) - in_faces)
    faces = (wedges + shift[points]).reshape(-1, 3)
    return SplitVertices(faces, np.repeat(np.arange(len(further)), count))
