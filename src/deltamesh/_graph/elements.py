"""Elements that values belong to (vertices, wedges, polygons), and their neighbours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from deltamesh._graph.adjacency import adjacency
from deltamesh._graph.halfedges import ends
from deltamesh._graph.parallelograms import parallelograms
from deltamesh_formats.array_types import Bools, Ints, Shorts


@dataclass(frozen=True)
class Elements:
    """Elements in the order of a file, their neighbours, and the parallelograms among them.

    Attributes
    ----------
    count : int
    indptr, indices : int32 (count + 1,), (2 e,)
        The neighbours of each element, ascending; see `adjacency.adjacency`.
    first, corners, within : int32 (count + 1,), (p, 3), (count,)
        The parallelograms that predict each element; see `parallelograms.parallelograms`.
        Polygons have none.
    """

    count: int
    indptr: Shorts
    indices: Shorts
    first: Shorts
    corners: Shorts
    within: Shorts


def of_vertices(faces: Ints, count: int, opposite: Ints | None = None) -> Elements:
    """Return vertices, or wedges, as elements.

    Parameters
    ----------
    faces : int64 (m, 3)
        Any triangles; two that share an edge form a parallelogram.
    count : int
        Number of vertices, isolated ones included.
    opposite : int64 (3 m,), optional
        As `halfedges.pair_halfedges` returns it, where it is known.
    """
    predictors = parallelograms(faces, count, opposite=opposite)
    return Elements(count, *adjacency(faces, count), *predictors)


def of_polygons(faces: Ints, offsets: Ints, of_corners: Ints) -> Elements:
    """Return polygons as elements; two with an edge in common are neighbours.

    Parameters
    ----------
    faces : int64 (m, 3)
        The triangles of the polygons, over points.
    offsets : int64 (p + 1,)
        Where the corners of each polygon begin.
    of_corners : int64 (3 m,)
        The corner of a polygon at which each corner of a triangle is.
    """
    count = len(offsets) - 1
    polygon = np.repeat(np.arange(count), np.diff(offsets))[of_corners]
    start, end = ends(faces)
    low, high = np.minimum(start, end), np.maximum(start, end)
    key = low * (int(faces.max(initial=0)) + 1) + high
    # However many faces there are on an edge, each is linked to the next: as many links as faces.
    order = np.argsort(key, kind="stable")
    a, b = order[:-1], order[1:]
    beside = (key[a] == key[b]) & (low[a] != high[a])
    pairs = np.stack([polygon[a[beside]], polygon[b[beside]]], axis=1)
    return of_graph(*adjacency(pairs, count))


def of_wedges(wedges: Ints) -> Elements:
    """Return wedges as elements, from the wedge of each corner of triangles, int64 (3 m,)."""
    return of_vertices(wedges.reshape(-1, 3), int(wedges.max(initial=-1)) + 1)


def of_graph(indptr: Shorts, indices: Shorts) -> Elements:
    """Return elements with the neighbours of `adjacency.adjacency`, and no parallelograms."""
    count = len(indptr) - 1
    none = np.zeros(count + 1, dtype=np.int32)
    return Elements(count, indptr, indices, none, np.zeros((0, 3), dtype=np.int32), none[:count])


def alone(count: int) -> Elements:
    """Return elements without neighbours: only the element before predicts each."""
    none = np.zeros(count + 1, dtype=np.int32)
    return of_graph(none, none[:0])


def among(elements: Elements, keep: Bools) -> Elements:
    """Return only the elements to `keep`, in their order, with the neighbours among these."""
    if keep.all():
        return elements
    e, number = elements, np.cumsum(keep, dtype=np.int32) - 1
    owner = np.repeat(np.arange(e.count), np.diff(e.indptr))
    near = keep[owner] & keep[e.indices]
    apex = np.repeat(np.arange(e.count), np.diff(e.first))
    whole = keep[apex] & keep[e.corners].all(axis=1)
    count = int(keep.sum())
    return Elements(
        count,
        _starts(number[owner[near]], count),
        number[e.indices[near]],
        _starts(number[apex[whole]], count),
        number[e.corners[whole]],
        np.zeros(count, dtype=np.int32),
    )


def _starts(owners: Shorts, count: int) -> Shorts:
    return np.concatenate(([0], np.cumsum(np.bincount(owners, minlength=count)))).astype(np.int32)
