"""Corners of faces, point by point, and the coding of classes of them (section COPY).

Which copy of a point each corner belongs to, or on which side of a seam it is: only what is equal
at a point counts, not the names of the classes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.coding import wedges as kernels
from deltamesh._kernels.coding.coder import Coder
from deltamesh._shape.stitching import TURN, Stitching
from deltamesh._streams import entropy
from deltamesh_formats.container.reader import read_varint
from deltamesh_formats.container.writer import write_varint
from deltamesh_formats.errors import FormatError

_Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Corners:
    """The corners of a complex in the order in which their classes are coded.

    Attributes
    ----------
    opposite : int64 (3 m,)
        Of the half-edges of the manifold.
    places : int64 (3 f,)
        Where each corner of the complex is among those that follow: first those of the manifold,
        then those of repeated and of degenerate faces.
    points : int64 (3 f,)
        The point of each.
    bounds : int64 (p + 1,)
        Where the visits to each point begin in the arrays below.
    ring, spoke, closing, like, kind : int64 (3 f,)
        See `kernels.corners.code_classes`.
    """

    opposite: _Ints
    places: _Ints
    points: _Ints
    bounds: _Ints
    ring: _Ints
    spoke: _Ints
    closing: _Ints
    like: _Ints
    kind: _Ints


def corners_of(faces: _Ints, opposite: _Ints, stitching: Stitching, count: int) -> Corners:
    """Return the corners of a complex.

    Parameters
    ----------
    faces : int64 (m, 3)
        Of the manifold, in coding order; `opposite` (3 m,) as of `topology.pair_halfedges`.
    stitching : Stitching
    count : int
        Number p of points.
    """
    s, m = stitching, len(faces)
    own = np.arange(3 * m).reshape(-1, 3)
    places = np.where(s.turned[:, None], own[:, TURN], own)
    repeats = places[s.repeated]
    repeats = np.where(s.against[:, None], repeats[:, TURN], repeats)
    points = np.concatenate([s.points[faces], s.points[faces].ravel()[repeats]])
    points = np.concatenate([points, s.degenerate[:, [0, 0, 1]]]).ravel()

    ring, spoke, closing = (np.empty(3 * m, dtype=np.int64) for _ in range(3))
    by_point = np.argsort(s.points, kind="stable")
    kernels.fill_rings(opposite, faces.ravel(), by_point, ring, spoke, closing)
    extra = np.arange(3 * m, len(points))
    none = np.full(len(extra), -1, dtype=np.int64)
    ring, spoke, closing = (
        np.concatenate([a, b]) for a, b in ((ring, extra), (spoke, none), (closing, none))
    )
    kind = np.where(spoke >= 0, kernels.ACROSS, kernels.FAN)
    kind[extra] = kernels.DEGENERATE
    kind[extra[: repeats.size]] = kernels.REPEAT

    order = np.argsort(points[ring], kind="stable")
    ring, spoke, closing, kind = ring[order], spoke[order], closing[order], kind[order]
    bounds = np.concatenate(([0], np.cumsum(np.bincount(points, minlength=count))))
    like = np.concatenate((ring[:0], [-1], ring[:-1])) if len(ring) else ring
    like[bounds[:-1][np.diff(bounds) > 0]] = -1
    again = kind == kernels.REPEAT
    like[again] = repeats.ravel()[ring[again] - 3 * m]
    places = np.concatenate([places.ravel(), extra])
    return Corners(opposite, places, points, bounds, ring, spoke, closing, like, kind)


def code_corner_classes(coder: Coder, corners: Corners, classes: _Ints) -> _Ints:
    """Code classes of corners.

    Parameters
    ----------
    coder : Coder
        With the slots and mixers of `kernels.corners`.
    corners : Corners
    classes : int64 (3 f,)
        Of each corner of the complex, >= 0, when encoding; empty when decoding.

    Returns
    -------
    int64 (3 f,)
        Classes 0, 1, ... with the same that is equal, ascending with the points, without gaps.
    """
    placed = np.zeros(len(corners.ring), dtype=np.int64)
    labels = int(classes.max(initial=-1)) + 1
    if labels:
        placed[corners.places] = classes
    kernels.code_classes(
        coder,
        corners.opposite,
        corners.bounds,
        corners.ring,
        corners.spoke,
        corners.closing,
        corners.like,
        corners.kind,
        placed,
        labels,
    )
    return placed[corners.places]


@dataclass(frozen=True)
class Copies:
    """The vertices at each point.

    Attributes
    ----------
    faces : int64 (f, 3)
        Of the complex, over vertices.
    points : int64 (n,)
        Of the vertices, ascending. At a point come first those in faces, then the others.
    """

    faces: _Ints
    points: _Ints


def encode_copies(corners: Corners, classes: _Ints, loose: _Ints) -> tuple[bytes, _Ints]:
    """Return the payload of COPY, and the classes as they are decoded.

    Parameters
    ----------
    corners : Corners
    classes : int64 (3 f,)
        The vertex of each corner, in any numbering.
    loose : int64 (p,)
        Vertices at each point that are in no face, without the one of a point that has no others.
    """
    total = int(loose.sum())
    elements = len(classes) + len(loose) + total
    coder = entropy.encoder(elements, kernels.SLOTS, kernels.MIXERS)
    classes = code_corner_classes(coder, corners, classes)
    if total:
        kernels.code_loose(coder, loose.copy(), total)
    counts = write_varint(len(loose)) + write_varint(total)
    return counts + entropy.finish(coder), classes


def copied_points(payload: memoryview, vertices: int, isolated: int) -> int:
    """Return the number of points.

    Raises
    ------
    FormatError
    """
    count, at = read_varint(payload, 0)
    loose, _ = read_varint(payload, at)
    if not isolated <= count < vertices or loose > vertices - count:
        raise FormatError("the counts of the copies contradict those of the header", 0)
    return count


def decode_copies(payload: memoryview, corners: Corners, vertices: int) -> Copies:
    """Return the vertices at each point: the mirror of `encode_copies`.

    Raises
    ------
    FormatError
        If no encoder has written the payload; the offset counts from its beginning.
    """
    count, at = read_varint(payload, 0)
    total, at = read_varint(payload, at)
    coder = entropy.decoder(payload[at:], kernels.SLOTS, kernels.MIXERS)
    classes = code_corner_classes(coder, corners, np.zeros(0, dtype=np.int64))
    loose = np.zeros(count, dtype=np.int64)
    if total and not kernels.code_loose(coder, loose, total):
        raise FormatError("the copies have another number of vertices in no face", at)
    entropy.check_end(coder, at)
    copies = copies_of(corners, classes, loose)
    if len(copies.points) != vertices:
        raise FormatError("the copies have another number of vertices than the header", at)
    return copies


def copies_of(corners: Corners, classes: _Ints, loose: _Ints) -> Copies:
    """Return the vertices at each point, from classes as `code_corner_classes` returns them."""
    points = corners.points[corners.places]
    owner = np.zeros(int(classes.max(initial=-1)) + 1, dtype=np.int64)
    owner[classes] = points
    in_faces = np.bincount(owner, minlength=len(loose))
    count = np.maximum(in_faces, 1) + loose
    first = np.cumsum(count) - count
    shift = first - (np.cumsum(in_faces) - in_faces)
    faces = (classes + shift[points]).reshape(-1, 3)
    return Copies(faces, np.repeat(np.arange(len(loose)), count))
