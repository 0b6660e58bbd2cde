"""What attributes and parts belong to: vertices, corners or faces, and which are beside which."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from deltamesh.geometry.laplacian import adjacency
from deltamesh.shape.polygons import Polygons
from deltamesh.shape.topology import parallelograms

_Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Elements:
    """Elements in the order of a file, their neighbours, and the parallelograms among them.

    Attributes
    ----------
    count : int
    indptr, indices : int64 (count + 1,), (2 e,)
        The neighbours of each element, ascending, as of `laplacian.adjacency`.
    first, corners, within : int64 (count + 1,), (p, 3), (count,)
        What predicts each element, as of `topology.parallelograms`; nothing for faces.
    """

    count: int
    indptr: _Ints
    indices: _Ints
    first: _Ints
    corners: _Ints
    within: _Ints


def of_vertices(faces: _Ints, count: int) -> Elements:
    """Return vertices, or classes of corners, as elements.

    Parameters
    ----------
    faces : int64 (m, 3)
        Any triangles; those that share an edge are a parallelogram.
    count : int
        Number of vertices, with those in no face.
    """
    return Elements(count, *adjacency(faces, count), *parallelograms(faces, count))


def of_faces(faces: _Ints, polygons: Polygons) -> Elements:
    """Return polygons as elements; those with an edge in common are neighbours.

    Parameters
    ----------
    faces : int64 (m, 3)
        The triangles of the polygons, over points.
    polygons : Polygons
    """
    count = len(polygons.offsets) - 1
    of_corners = np.repeat(np.arange(count), np.diff(polygons.offsets))
    polygon = of_corners[polygons.of_corners]
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    low, high = np.minimum(start, end), np.maximum(start, end)
    key = low * (int(faces.max(initial=0)) + 1) + high
    # However many faces there are on an edge, each is linked to the next: as many links as faces.
    order = np.argsort(key, kind="stable")
    a, b = order[:-1], order[1:]
    beside = (key[a] == key[b]) & (low[a] != high[a])
    pairs = np.stack([polygon[a[beside]], polygon[b[beside]]], axis=1)
    none = np.zeros((0, 3), dtype=np.int64)
    first, within = np.zeros(count + 1, dtype=np.int64), np.zeros(count, dtype=np.int64)
    return Elements(count, *adjacency(pairs, count), first, none, within)
