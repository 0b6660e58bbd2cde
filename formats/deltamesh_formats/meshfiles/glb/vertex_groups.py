"""Vertices of a GLB, each with one row of each attribute, in groups that primitives share.

A vertex is repeated where its corners differ in an attribute, or belong to different objects.
Vertices of one object that have the same attributes are a group.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from deltamesh_formats.array_types import Bools, Ints
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh
from deltamesh_formats.polymesh.permutations import inverse


@dataclass(frozen=True)
class Groups:
    """Mesh over the vertices of a GLB.

    Attributes
    ----------
    vertex : int64 (v,)
        Vertex of the mesh that each repeats, group after group, and in its order within one.
    rows : list of int64 (v,)
        Row of each attribute, -1 for none.
    starts : int64 (g + 1,)
        First vertex of each group, and the end of the last.
    objects : int64 (g,)
        Object of each group, -1 for none.
    faces : int64 (t, 3)
        Triangles over these vertices.
    polygon : int64 (t,)
        Polygon of the mesh that each is a part of.
    lost : tuple of str
        Descriptions of attributes that some elements have and their group has not.
    """

    vertex: Ints
    rows: list[Ints]
    starts: Ints
    objects: Ints
    faces: Ints
    polygon: Ints
    lost: tuple[str, ...] = ()


def grouped(mesh: PolyMesh, attributes: list[Attribute], objects: Ints) -> Groups:
    """Divide the vertices of a mesh into groups.

    Parameters
    ----------
    mesh : PolyMesh
    attributes : list of Attribute
        Of vertices or corners.
    objects : int64 (p,)
        Of each face, -1 for none.
    """
    cut = mesh.triangulation()
    simple = len(np.unique(objects)) == 1
    if simple and all(a.domain == "vertex" and a.index is None for a in attributes):
        every = np.arange(len(mesh.vertices), dtype=np.int64)
        starts, rows = np.array([0, len(every)]), [every] * len(attributes)
        return Groups(every, rows, starts, objects[:1], cut.faces, cut.polygon)
    isolated = np.setdiff1d(np.arange(len(mesh.vertices)), mesh.corners)
    found = [a.rows()[cut.faces if a.domain == "vertex" else cut.corners] for a in attributes]
    # A triangle has the attributes that all its corners have.
    mixed = any(((rows >= 0).any(axis=1) & (rows < 0).any(axis=1)).any() for rows in found)
    common = [np.repeat((rows >= 0).all(axis=1), 3) for rows in found]
    nothing = np.full(len(isolated), -1, dtype=np.int64)
    own = [a.rows()[isolated] if a.domain == "vertex" else nothing for a in attributes]
    beside, strays = _beside(cut.faces.ravel(), common, isolated, [rows >= 0 for rows in own])
    # Corners of triangles, then the vertices without any.
    vertex = np.concatenate([cut.faces.ravel(), isolated])
    object_of = np.repeat(objects[cut.polygon], 3)
    object_of = np.concatenate([object_of, object_of[beside]])
    rows = []
    for some, of_corner, alone in zip(common, found, own, strict=True):
        filled = np.where(alone >= 0, alone, of_corner.ravel()[beside])
        has = np.append(some, some[beside])
        rows.append(np.where(has, np.append(of_corner, filled), -1))
    group = _numbered(object_of, np.zeros(len(vertex), dtype=np.int64))
    for row in rows:
        group = _numbered(group, row < 0)
    group = _in_order(group, object_of, vertex)
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
        (("attributes that not all corners of a face have",) if mixed else ())
        + (("attributes of vertices of no face",) if strays else ()),
    )


def _beside(
    corners: Ints,
    common: list[Bools],
    isolated: Ints,
    own: list[Bools],
) -> tuple[Ints, bool]:
    """Return a corner for each isolated vertex, whose group it joins, and whether some do not fit.

    It is a corner at the last vertex before that has a face and the same attributes.

    Parameters
    ----------
    corners : int64 (c,)
        Vertex of each corner of a triangle.
    common, own : list of bool (c,), list of bool (isolated,)
        For each attribute, whether the corners and the isolated vertices have it.
    isolated : int64
    """
    pattern = np.zeros(len(corners) + len(isolated), dtype=np.int64)
    for some, has in zip(common, own, strict=True):
        pattern = _numbered(pattern, np.append(some, has))
    of_corner, of_vertex = pattern[: len(corners)], pattern[len(corners) :]
    found, strays = np.zeros(len(isolated), dtype=np.int64), False
    for each in np.unique(of_vertex).tolist():
        fitting = np.flatnonzero(of_corner == each)
        if not len(fitting):
            fitting, strays = np.arange(len(corners)), True
        vertices, first = np.unique(corners[fitting], return_index=True)
        mine = of_vertex == each
        before = np.searchsorted(vertices, isolated[mine]) - 1
        found[mine] = fitting[first[np.maximum(before, 0)]]
    return found, strays


def _in_order(group: Ints, object_of: Ints, vertex: Ints) -> Ints:
    """Renumber groups by their objects, and those of an object by their first vertices.

    So a mesh that has been read from a GLB, block after block, is written in the same order.
    """
    first, objects = (np.full(int(group.max()) + 1, len(vertex)) for _ in range(2))
    np.minimum.at(first, group, vertex)
    objects[group] = object_of
    return inverse(np.lexsort([first, objects]))[group]


def _numbered(major: Ints, minor: Ints | Bools) -> Ints:
    """Return the rank of each pair among the distinct pairs."""
    least = int(minor.min(initial=0))
    spread = int(minor.max(initial=0)) - least + 1
    low = int(major.min(initial=0))
    pairs = (major - low) * spread + (minor.astype(np.int64) - least)
    found: Ints = np.unique(pairs, return_inverse=True)[1].astype(np.int64)
    return found
