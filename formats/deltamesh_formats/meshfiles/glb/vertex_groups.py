"""Vertices of a GLB, each with one row of each attribute, in groups that primitives share.

A vertex is repeated where its corners differ in an attribute, or belong to different objects.
Vertices of one object that have the same attributes are a group. What is kept of an attribute is as
long as the list of corners that have it, since a scene may have thousands of attributes, each on a
few of its vertices.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from deltamesh_formats.array_types import Bools, Ints
from deltamesh_formats.caching import cached_property
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh
from deltamesh_formats.polymesh.permutations import inverse, ranges


@dataclass(frozen=True)
class Groups:
    """Mesh over the vertices of a GLB.

    Attributes
    ----------
    vertex : int64 (v,)
        Vertex of the mesh that each repeats, group after group, and in its order within one.
    starts : int64 (g + 1,)
        First vertex of each group, and the end of the last.
    rows : list of dict of int64
        For each group the numbers of its attributes, and the row of each of its vertices in them.
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
    starts: Ints
    rows: list[dict[int, Ints]]
    objects: Ints
    faces: Ints
    polygon: Ints
    lost: tuple[str, ...] = ()


def grouped(mesh: PolyMesh, attributes: Sequence[Attribute], objects: Ints) -> Groups:
    """Divide the vertices of a mesh into groups.

    Parameters
    ----------
    mesh : PolyMesh
    attributes : sequence of Attribute
        Of vertices or corners.
    objects : int64 (p,)
        Of each face, -1 for none.
    """
    cut = mesh.triangulation()
    simple = len(np.unique(objects)) == 1
    if simple and all(a.domain == "vertex" and a.index is None for a in attributes):
        every = np.arange(len(mesh.vertices), dtype=np.int64)
        all_rows = [dict.fromkeys(range(len(attributes)), every)]
        ends = np.array([0, len(every)])
        return Groups(every, ends, all_rows, objects[:1], cut.faces, cut.polygon)
    # Places are the corners of triangles, then the vertices without any. A triangle has the
    # attributes that all its corners have.
    isolated = np.flatnonzero(np.bincount(mesh.corners, minlength=len(mesh.vertices)) == 0)
    corners, nothing = cut.faces.size, np.full(len(isolated), -1)
    vertex = np.concatenate([cut.faces.ravel(), isolated])
    owners = {"vertex": cut.faces.ravel(), "corner": cut.corners.ravel()}
    corners_of = {
        "vertex": _CornersOf(owners["vertex"], len(mesh.vertices)),
        "corner": _CornersOf(owners["corner"], len(mesh.corners)),
    }
    kinds, having, mixed = np.zeros(len(vertex), dtype=np.int64), [], False
    least = 0
    for attribute in reversed(attributes):
        has = np.flatnonzero(attribute.rows() >= 0)
        places, is_mixed = corners_of[attribute.domain].of_whole_triangles(has)
        having.append(places)
        mixed |= is_mixed
        alone = np.flatnonzero(_own(attribute, isolated, nothing) >= 0)
        least = _split_off(kinds, least, np.append(places, corners + alone))
    having.reverse()
    beside, strays = _beside(vertex, kinds, corners)
    object_of = np.repeat(objects[cut.polygon], 3)
    group = _numbered(object_of, kinds[:corners])
    group, object_of = np.append(group, group[beside]), np.append(object_of, object_of[beside])
    group = _in_order(group, object_of, vertex)
    rows: list[dict[int, Ints]] = [{} for _ in range(int(group.max()) + 1)]
    for number, (attribute, some) in enumerate(zip(attributes, having, strict=True)):
        for each, mine in _divided(group[some]):
            rows[each][number] = _rows(attribute, owners[attribute.domain][some[mine]])
    repeated: list[Ints] = []
    starts, faces = [0], np.empty(corners, dtype=np.int64)
    for each, mine in _divided(group):
        of_faces, alone = np.split(mine, [np.searchsorted(mine, corners)])
        same = np.searchsorted(of_faces, beside[alone - corners])
        key = _numbered(np.zeros(len(mine), dtype=np.int64), vertex[mine])
        for number, row in rows[each].items():
            own = _own(attributes[number], vertex[alone], row[same])
            rows[each][number] = np.append(row, own)
            key = _numbered(key, rows[each][number])
        _, first = np.unique(key, return_index=True)
        repeated.append(vertex[mine[first]])
        rows[each] = {number: row[first] for number, row in rows[each].items()}
        faces[of_faces] = starts[-1] + key[: len(of_faces)]
        starts.append(starts[-1] + len(first))
    _, first_of_group = np.unique(group, return_index=True)
    return Groups(
        np.concatenate(repeated),
        np.array(starts),
        rows,
        object_of[first_of_group],
        faces.reshape(-1, 3),
        cut.polygon,
        (("attributes that not all corners of a face have",) if mixed else ())
        + (("attributes of vertices of no face",) if strays else ()),
    )


class _CornersOf:
    """Corners of triangles by their owners, which are vertices or corners of polygons."""

    def __init__(self, owner: Ints, count: int) -> None:
        self.owner, self.count = owner, count

    @cached_property
    def every(self) -> Ints:
        """All corners."""
        return np.arange(len(self.owner))

    @cached_property
    def sorted(self) -> tuple[Ints, Ints, Ints]:
        """Corners in the order of their owners; the first one of each owner, and their count."""
        counts = np.bincount(self.owner, minlength=self.count)
        return np.argsort(self.owner, kind="stable"), np.cumsum(counts) - counts, counts

    def of_whole_triangles(self, owners: Ints) -> tuple[Ints, bool]:
        """Return the corners of triangles that these own alone, and whether they share others."""
        if len(owners) == self.count:
            return self.every, False
        order, first, counts = self.sorted
        corners = order[ranges(first[owners], counts[owners])]
        triangles, owned = np.unique(corners // 3, return_counts=True)
        whole = (3 * triangles[owned == 3, None] + np.arange(3)).ravel()
        return whole, bool((owned < 3).any())


def _rows(attribute: Attribute, owners: Ints) -> Ints:
    return owners if attribute.index is None else attribute.index[owners]


def _own(attribute: Attribute, vertices: Ints, others: Ints) -> Ints:
    """Return the rows of vertices without a face, and other ones where they have none."""
    if attribute.domain != "vertex":
        return others
    rows = _rows(attribute, vertices)
    return np.where(rows >= 0, rows, others)


def _split_off(kinds: Ints, least: int, some: Ints) -> int:
    """Give places that have one more attribute kinds of their own, below the least one.

    When the first attribute comes last, kinds are sorted by it, then by the second one, and so on.

    Returns
    -------
    int
        The least kind now.
    """
    distinct, new = np.unique(kinds[some], return_inverse=True)
    kinds[some] = least - len(distinct) + new
    return least - len(distinct)


def _divided(numbers: Ints) -> Iterator[tuple[int, Ints]]:
    """Yield each number that is there, and its places in order."""
    order = np.argsort(numbers, kind="stable")
    distinct, first = np.unique(numbers[order], return_index=True)
    return zip(distinct.tolist(), np.split(order, first[1:]), strict=False)


def _beside(vertex: Ints, kinds: Ints, corners: int) -> tuple[Ints, bool]:
    """Return a corner for each isolated vertex, whose group it joins, and whether some do not fit.

    It is a corner at the last vertex before that has a face and the same attributes.

    Parameters
    ----------
    vertex, kinds : int64 (p,)
        Vertices of the places, and numbers for the attributes that they have.
    corners : int
        Count of the places that are corners of triangles; the others are isolated vertices.
    """
    spread = int(vertex.max(initial=0)) + 1
    pairs = kinds * spread + vertex
    found, first = np.unique(pairs[:corners], return_index=True)
    before = np.maximum(np.searchsorted(found, pairs[corners:]) - 1, 0)
    after = np.minimum(before + 1, len(found) - 1)
    fits, fits_after = (found[at] // spread == kinds[corners:] for at in (before, after))
    beside = first[np.where(fits, before, after)]
    strays = ~(fits | fits_after)
    if strays.any():
        beside[strays] = _beside(vertex, np.zeros_like(kinds), corners)[0][strays]
    return beside, bool(strays.any())


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
