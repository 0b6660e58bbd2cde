"""Coding what was cut, turned and set aside to make a manifold of a complex (section STCH)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.adjacency import adjacency
from deltamesh._graph.halfedges import ends
from deltamesh._kernels.coding import stitching as kernels
from deltamesh._kernels.coding.coder import Coder
from deltamesh._streams import entropy
from deltamesh_formats.container.reader import read_varint
from deltamesh_formats.container.writer import write_varint
from deltamesh_formats.errors import FormatError

_Ints = NDArray[np.int64]
_Bools = NDArray[np.bool_]

# The corners of a face whose winding is turned.
TURN = np.array([0, 2, 1])


@dataclass(frozen=True)
class Stitching:
    """How a manifold becomes a complex; the points are numbered as its vertices meet them.

    Attributes
    ----------
    points : int64 (n,)
        The point of each vertex of the manifold.
    turned : bool (m,)
        The faces of the manifold that the complex has with their second and third corners
        exchanged.
    repeated : int64 (r,)
        Faces of the manifold that the complex has once more, ascending.
    against : bool (r,)
        Whether with the winding opposite to that of the first; False before True.
    degenerate : int64 (d, 2)
        The points a and b of faces (a, a, b), in ascending order.
    """

    points: _Ints
    turned: _Bools
    repeated: _Ints
    against: _Bools
    degenerate: _Ints

    @property
    def is_trivial(self) -> bool:
        """Whether the complex is the manifold itself."""
        one_each = len(self.points) == 0 or int(self.points[-1]) == len(self.points) - 1
        extras = len(self.repeated) + len(self.degenerate)
        return one_each and not self.turned.any() and not extras


def trivial(vertex_count: int, face_count: int) -> Stitching:
    """Return the stitching of a manifold that is the complex itself."""
    none = np.zeros(0, dtype=np.int64)
    turned = np.zeros(face_count, dtype=bool)
    return Stitching(np.arange(vertex_count), turned, none, turned[:0], none.reshape(0, 2))


def complex_faces(faces: _Ints, stitching: Stitching) -> _Ints:
    """Return the faces of the complex over points: those of the manifold, repeats, degenerates.

    Parameters
    ----------
    faces : int64 (m, 3)
        Of the manifold, in coding order.
    """
    s = stitching
    if s.is_trivial:
        return faces
    coded = s.points[faces]
    coded = np.where(s.turned[:, None], coded[:, TURN], coded)
    again = coded[s.repeated]
    again = np.where(s.against[:, None], again[:, TURN], again)
    return np.concatenate([coded, again, s.degenerate[:, [0, 0, 1]]])


def encode_stitching(faces: _Ints, opposite: _Ints, stitching: Stitching, count: int) -> bytes:
    """Return the payload of STCH.

    Parameters
    ----------
    faces : int64 (m, 3)
        Of the manifold, in coding order.
    opposite : int64 (3 m,)
        As of `topology.pair_halfedges`.
    stitching : Stitching
    count : int
        Number of points, with those that no face of the manifold has; these come last.
    """
    s = stitching
    n, m = len(s.points), len(faces)
    numbers = (n, m, int(s.turned.any()), len(s.repeated))
    extras = len(s.repeated) + len(s.degenerate)
    coder = entropy.encoder(n + m + extras, kernels.SLOTS, kernels.MIXERS)
    points = _code_points(coder, faces, opposite, s.points.copy())
    if s.turned.any():
        kernels.code_turned(coder, opposite, s.turned.copy())
    if len(s.repeated):
        repeats = np.bincount(2 * s.repeated + s.against, minlength=2 * m).reshape(-1, 2)
        kernels.code_repeats(coder, opposite, repeats, len(s.repeated))
    if len(s.degenerate):
        graph = adjacency(s.points[faces], points)
        kernels.code_degenerate(coder, *graph, s.degenerate.copy(), count)
    return b"".join(map(write_varint, numbers)) + entropy.finish(coder)


def stitched_counts(payload: memoryview, vertices: int, faces: int) -> tuple[int, int]:
    """Return the numbers of vertices and of faces of the manifold.

    Parameters
    ----------
    vertices, faces : int
        Numbers of points in faces of the manifold, and of faces of the complex.

    Raises
    ------
    FormatError
    """
    n, at = read_varint(payload, 0)
    m, _ = read_varint(payload, at)
    if m > faces or n > 3 * m or n < vertices:
        raise FormatError("the counts of the stitching contradict those of the header", 0)
    return n, m


def decode_stitching(
    payload: memoryview, faces: _Ints, opposite: _Ints, used: int, count: int, face_count: int
) -> Stitching:
    """Return the stitching: the mirror of `encode_stitching`.

    Parameters
    ----------
    used, count : int
        Number of points in faces of the manifold, and of all points.
    face_count : int
        Number of faces of the complex.

    Raises
    ------
    FormatError
        If no encoder has written the payload; the offset counts from its beginning.
    """
    n, at = read_varint(payload, 0)
    m, at = read_varint(payload, at)
    turns, at = read_varint(payload, at)
    r, at = read_varint(payload, at)
    if turns > 1 or r > face_count - m:
        raise FormatError("the counts of the stitching contradict those of the header", 0)
    coder = entropy.decoder(payload[at:], kernels.SLOTS, kernels.MIXERS)
    points = np.zeros(n, dtype=np.int64)
    turned = np.zeros(m, dtype=bool)
    repeats = np.zeros((m, 2), dtype=np.int64)
    degenerate = np.zeros((face_count - m - r, 2), dtype=np.int64)
    if _code_points(coder, faces, opposite, points) != used:
        raise FormatError("the stitching has another number of points than the header", at)
    if turns:
        kernels.code_turned(coder, opposite, turned)
        if not turned.any():
            raise FormatError("turned faces are announced, but there are none", at)
    if r and not kernels.code_repeats(coder, opposite, repeats, r):
        raise FormatError("the stitching has another number of repeated faces", at)
    if len(degenerate):
        graph = adjacency(points[faces], used)
        if not kernels.code_degenerate(coder, *graph, degenerate, count):
            raise FormatError("a degenerate face with a point that is none", at)
    entropy.check_end(coder, at)
    repeated, against = np.divmod(np.repeat(np.arange(2 * m), repeats.ravel()), 2)
    stitching = Stitching(points, turned, repeated, against.astype(bool), degenerate)
    if stitching.is_trivial:
        raise FormatError("a stitching of nothing", at)
    return stitching


def _code_points(coder: Coder, faces: _Ints, opposite: _Ints, points: _Ints) -> int:
    """Code the points of the vertices, filled in when decoding; return how many, -1: corrupt."""
    boundary = np.zeros(len(points), dtype=bool)
    border = opposite < 0
    for end in ends(faces):
        boundary[end[border]] = True
    graph = adjacency(faces, len(points))
    return int(kernels.code_stitches(coder, *graph, boundary, points))
