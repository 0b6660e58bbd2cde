"""Section STCH: the cuts, reversed and repeated faces that make a manifold of a complex.

The payload is the numbers of vertices and faces of the manifold, whether faces are reversed, and
the number of repeated faces, then a range coded stream (`deltamesh._kernels.coding.stitching`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from deltamesh._graph.adjacency import adjacency
from deltamesh._graph.halfedges import ends
from deltamesh._kernels.coding import stitching as kernels
from deltamesh._kernels.coding.coder import Coder
from deltamesh._shape.draft import ShapeDraft
from deltamesh._shape.manifold import Manifold, Stitches
from deltamesh._shape.structure import Structure, structure_of
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh_formats.array_types import Ints
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.fields import read_varint, write_varint
from deltamesh_formats.errors import FormatError


def applies(draft: ShapeDraft) -> bool:
    """Return whether the complex is another than its manifold."""
    return not draft.stitches.is_trivial


def encode(draft: ShapeDraft) -> tuple[bytes, ShapeDraft]:
    """Return the payload of STCH, and the draft with the stitched complex.

    The mirror is `decode`.
    """
    built = replace(draft.structure.complex, stitches=draft.stitches)
    payload = _encode(built.manifold, built.stitches, built.point_count)
    return payload, replace(draft, structure=structure_of(built))


def _encode(manifold: Manifold, stitches: Stitches, point_count: int) -> bytes:
    s, m = stitches, len(manifold.faces)
    numbers = (manifold.vertex_count, m, int(s.reversed.any()), len(s.repeated))
    elements = manifold.vertex_count + m + len(s.repeated) + len(s.degenerate)

    def run(coder: Coder) -> None:
        used = _code_points(coder, manifold, s.points.copy())
        if s.reversed.any():
            kernels.code_reversed(coder, manifold.opposite, s.reversed.copy())
        if len(s.repeated):
            repeats = np.bincount(2 * s.repeated + s.against, minlength=2 * m).reshape(-1, 2)
            kernels.code_repeats(coder, manifold.opposite, repeats, len(s.repeated))
        if len(s.degenerate):
            graph = adjacency(s.points[manifold.faces], used)
            kernels.code_degenerate(coder, *graph, s.degenerate.copy(), point_count)

    return b"".join(map(write_varint, numbers)) + encode_with(kernels.MODEL, elements, run)


def read_manifold_counts(payload: memoryview, used: int, faces: int) -> tuple[int, int]:
    """Return the numbers of vertices and of faces of the manifold that a payload announces.

    Parameters
    ----------
    used, faces : int
        Numbers of points in faces of the manifold, and of faces of the complex.

    Raises
    ------
    FormatError
        For counts that contradict these numbers.
    """
    n, at = read_varint(payload, 0)
    m, _ = read_varint(payload, at)
    if m > faces or n > 3 * m or n < used:
        raise FormatError("the counts of the manifold contradict those of the header", 0)
    return n, m


def decode(payload: memoryview, container: Container, structure: Structure) -> Structure:
    """Return the structure of the stitched complex: the mirror of `encode`.

    Raises
    ------
    FormatError
        If no encoder has written the payload; the offset counts from its beginning.
    """
    built = structure.complex
    stitches = _decode(payload, built.manifold, built.used, built.point_count, container.triangles)
    return structure_of(replace(built, stitches=stitches))


def _decode(
    payload: memoryview, manifold: Manifold, used: int, point_count: int, face_count: int
) -> Stitches:
    """Return the stitches; face_count is that of the complex."""
    n, at = read_varint(payload, 0)
    m, at = read_varint(payload, at)
    any_reversed, at = read_varint(payload, at)
    r, at = read_varint(payload, at)
    if any_reversed > 1 or r > face_count - m:
        raise FormatError("the counts of faces contradict those of the header", 0)
    points = np.zeros(n, dtype=np.int64)
    reversed_ = np.zeros(m, dtype=bool)
    repeats = np.zeros((m, 2), dtype=np.int64)
    degenerate = np.zeros((face_count - m - r, 2), dtype=np.int64)

    def run(coder: Coder) -> None:
        if _code_points(coder, manifold, points) != used:
            raise FormatError("stitches: another number of points than in the header", at)
        if any_reversed:
            kernels.code_reversed(coder, manifold.opposite, reversed_)
            if not reversed_.any():
                raise FormatError("reversed faces: announced, but there are none", at)
        if r and not kernels.code_repeats(coder, manifold.opposite, repeats, r):
            raise FormatError("repeated faces: another number than announced", at)
        if len(degenerate):
            graph = adjacency(points[manifold.faces], used)
            if not kernels.code_degenerate(coder, *graph, degenerate, point_count):
                raise FormatError("degenerate faces: a point out of range or out of order", at)

    decode_with(kernels.MODEL, payload[at:], run, at)
    repeated, against = np.divmod(np.repeat(np.arange(2 * m), repeats.ravel()), 2)
    stitches = Stitches(points, reversed_, repeated, against.astype(bool), degenerate)
    if stitches.is_trivial:
        raise FormatError("stitches: a manifold that needs none", at)
    return stitches


def _code_points(coder: Coder, manifold: Manifold, points: Ints) -> int:
    """Code the points of the vertices, filled in when decoding; return how many, -1: corrupt."""
    boundary = np.zeros(len(points), dtype=bool)
    border = manifold.opposite < 0
    for end in ends(manifold.faces):
        boundary[end[border]] = True
    graph = adjacency(manifold.faces, len(points))
    return int(kernels.code_stitches(coder, *graph, boundary, points))
