"""The vertices of a GLB: a vertex there has one row of each attribute, and belongs to one mesh.

So a vertex is repeated where its corners differ in an attribute, or belong to different objects.
Vertices that have the same attributes, of one object, are a group: what its primitives share.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.polymesh import Attribute, PolyMesh

Indices = NDArray[np.int64]


@dataclass(frozen=True)
class Groups:
    """The mesh over vertices of its own.

    Attributes
    ----------
    vertex : int64 (v,)
        The vertex of the mesh that each is, group after group, otherwise in the mesh's order.
    rows : list of int64 (v,)
        The row of each attribute, -1 for none.
    starts : int64 (g + 1,)
        Where the vertices of each group begin.
    objects : int64 (g,)
        The object of each group, -1 for none.
    faces : int64 (t, 3)
        Triangles over these vertices.
    polygon : int64 (t,)
    """

    vertex: Indices
    rows: list[Indices]
    starts: Indices
    objects: Indices
    faces: Indices
    polygon: Indices


def grouped(mesh: PolyMesh, attributes: list[Attribute], objects: Indices) -> Groups:
    """Divide the vertices of a mesh into groups.

    Parameters
    ----------
    mesh : PolyMesh
    attributes : list of Attribute
        Of vertices or corners.
    objects : int64 (p,)
        Of each face, -1 for none.
    """
    cut = mesh.triangles()
    simple = len(np.unique(objects)) == 1
    if simple and all(a.domain == "vertex" and a.index is None for a in attributes):
        every = np.arange(len(mesh.vertices), dtype=np.int64)
        starts, rows = np.array([0, len(every)]), [every] * len(attributes)
        return Groups(every, rows, starts, objects[:1], cut.faces, cut.polygon)
    isolated = np.setdiff1d(np.arange(len(mesh.vertices)), mesh.corners)
    # Corners of triangles, then the vertices without any; these go with a neighbour in the order,
    # and have the attributes that it has.
    vertex = np.concatenate([cut.faces.ravel(), isolated])
    beside = _beside(cut.faces.ravel(), isolated)
    object_of = np.repeat(objects[cut.polygon], 3)
    object_of = np.concatenate([object_of, object_of[beside]])
    rows, has = [], []
    for attribute in attributes:
        at = cut.faces if attribute.domain == "vertex" else cut.corners
        found = attribute.rows()[at]
        # A triangle has the attributes that all its corners have.
        some = np.repeat((found >= 0).all(axis=1), 3)
        own = attribute.rows()[isolated] if attribute.domain == "vertex" else -1
        alone = np.where(some[beside], np.where(own >= 0, own, found.ravel()[beside]), -1)
        rows.append(np.where(np.append(some, some[beside]), np.append(found, alone), -1))
        has.append(rows[-1] >= 0)
    group = _numbered(object_of, np.zeros(len(vertex), dtype=np.int64))
    for some in has:
        group = _numbered(group, ~some)  # those that have it come first
    key = _numbered(group, vertex)
    for row in rows:
        key = _numbered(key, row)
    _, first = np.unique(key, return_index=True)
    sizes = np.bincount(group[first])
    starts = np.concatenate(([0], np.cumsum(sizes))).astype(np.int64)
    _, first_of_group = np.unique(group, return_index=True)
    return Groups(
        vertex[first],
        [row[first] for row in rows],
        starts,
        object_of[first_of_group],
        key[: cut.faces.size].reshape(-1, 3),
        cut.polygon,
    )


def _beside(corners: Indices, isolated: Indices) -> Indices:
    """Return, for each vertex without faces, a corner of the last vertex before that has some."""
    vertices, first = np.unique(corners, return_index=True)
    before = np.searchsorted(vertices, isolated) - 1
    found: Indices = first[np.maximum(before, 0)]
    return found


def _numbered(major: Indices, minor: NDArray[np.int64] | NDArray[np.bool_]) -> Indices:
    """Return the number of each pair among the different pairs in their order."""
    least = int(minor.min(initial=0))
    spread = int(minor.max(initial=0)) - least + 1
    low = int(major.min(initial=0))
    pairs = (major - low) * spread + (minor.astype(np.int64) - least)
    found: Indices = np.unique(pairs, return_inverse=True)[1].astype(np.int64)
    return found
