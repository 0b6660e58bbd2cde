"""Corners of a complex, point by point, and the coding of wedges: classes of corners at a point.

A wedge holds the corners of one of several vertices at a point, or those on one side of a seam of
an attribute. Which corners share a wedge counts, not the names of the wedges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from deltamesh._kernels.coding import wedges as kernels
from deltamesh._kernels.coding.coder import Coder
from deltamesh._shape.manifold import REVERSED, Stitches
from deltamesh_formats.array_types import Ints


@dataclass(frozen=True)
class Corners:
    """The corners of a complex in the order in which their wedges are coded.

    Attributes
    ----------
    opposite : int64 (3 m,)
        Of the half-edges of the manifold.
    rank : int64 (3 f,)
        The index of each corner of the complex among those of the fields below: first those of the
        manifold, then those of repeated and of degenerate faces.
    points : int64 (3 f,)
        The point of each.
    bounds : int64 (p + 1,)
        Where the visits to each point begin in the arrays below.
    ring, spoke, closing, like, kind : int64 (3 f,)
        See `kernels.code_wedges`.
    """

    opposite: Ints
    rank: Ints
    points: Ints
    bounds: Ints
    ring: Ints
    spoke: Ints
    closing: Ints
    like: Ints
    kind: Ints


def corners_of(faces: Ints, opposite: Ints, stitches: Stitches, count: int) -> Corners:
    """Return the corners of a complex.

    Parameters
    ----------
    faces : int64 (m, 3)
        Of the manifold, in coding order.
    opposite : int64 (3 m,)
        Of its half-edges, -1 on the boundary.
    stitches : Stitches
    count : int
        Number p of points.
    """
    s, m = stitches, len(faces)
    own = np.arange(3 * m).reshape(-1, 3)
    rank = np.where(s.reversed[:, None], own[:, REVERSED], own)
    repeats = rank[s.repeated]
    repeats = np.where(s.against[:, None], repeats[:, REVERSED], repeats)
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
    rank = np.concatenate([rank.ravel(), extra])
    return Corners(opposite, rank, points, bounds, ring, spoke, closing, like, kind)


def code_wedges(coder: Coder, corners: Corners, wedges: Ints) -> Ints:
    """Code wedges.

    Parameters
    ----------
    coder : Coder
        With the model of the kernels of wedges.
    corners : Corners
    wedges : int64 (3 f,)
        The wedge of each corner of the complex, >= 0, in any numbering, when encoding; empty when
        decoding.

    Returns
    -------
    int64 (3 f,)
        The wedge of each corner, numbered 0, 1, ... without gaps, ascending with the points.
    """
    ranked = np.zeros(len(corners.ring), dtype=np.int64)
    labels = int(wedges.max(initial=-1)) + 1
    if labels:
        ranked[corners.rank] = wedges
    kernels.code_wedges(
        coder,
        corners.opposite,
        corners.bounds,
        corners.ring,
        corners.spoke,
        corners.closing,
        corners.like,
        corners.kind,
        ranked,
        labels,
    )
    return ranked[corners.rank]
