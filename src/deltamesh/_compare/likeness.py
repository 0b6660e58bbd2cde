"""Likeness of two meshes: the elements that correspond, and the differences of attributes.

Vertices may be in another order, several at one position in one mesh and once in the other, in no
face here and gone there. What is compared is what a viewer sees: positions, and attributes at the
corners of polygons, whether the files keep them with vertices or with corners.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from deltamesh._compare import correspondence
from deltamesh._graph.halfedges import weld
from deltamesh._vectors import angles
from deltamesh_formats.array_types import Ints
from deltamesh_formats.polymesh.kinds import Kind
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh
from deltamesh_formats.polymesh.permutations import inverse
from deltamesh_formats.polymesh.texture_origin import is_top_left, with_origin

# Corners of polygons (c,) of one mesh, and the same of another.
Pairs: TypeAlias = tuple[Ints, Ints]

# Larger polygons begin at their lowest vertex, the first of equals: all rotations would be
# quadratic, and a polygon that visits its lowest vertex twice is rare.
_ALL_ROTATIONS = 64


@dataclass(frozen=True)
class Sites:
    """A mesh over positions that may stand for several of its vertices.

    Attributes
    ----------
    mesh : PolyMesh
        Without attributes.
    of_vertices : int64 (n,)
        The site of each vertex, -1 for none.
    """

    mesh: PolyMesh
    of_vertices: Ints


@dataclass(frozen=True)
class Correspondence:
    """Two meshes whose vertices correspond: site i of `a` is site `sites[i]` of `b`."""

    a: Sites
    b: Sites
    sites: Ints


@dataclass(frozen=True)
class Difference:
    """What became of an attribute.

    Attributes
    ----------
    attribute : Attribute
        Of the first mesh.
    largest : float or None
        The largest difference of a number of it, of normals the largest angle in degrees; None if
        the other mesh has none of that name and width, or lacks it at some element.
    """

    attribute: Attribute
    largest: float | None


def corresponding(a: PolyMesh, b: PolyMesh, exact: bool = False) -> Correspondence | None:
    """Return which vertices of two meshes are which, None if their connectivity differs.

    Parameters
    ----------
    a, b : PolyMesh
    exact : bool
        Tell -0.0 from 0.0, as a lossless file does.
    """
    first, second = _welded(a, exact), _welded(b, exact)
    found = _at_equal_positions(first.mesh, second.mesh, exact)
    if found is not None:
        return Correspondence(first, second, found)
    for first, second in _pairs(a, b, exact):
        found = correspondence.match_polygons(first.mesh, second.mesh)
        if found is not None:
            return Correspondence(first, second, found)
    return None


def _at_equal_positions(a: PolyMesh, b: PolyMesh, exact: bool) -> Ints | None:
    """Return which vertex of `b` each one of `a` is, by its position, which no other has.

    None if positions or polygons differ. Where they do not, nothing has to be searched for, however
    symmetric the connectivity is.
    """
    # To the last bit; but for exact meshes there is one zero.
    V, W = ((m.vertices if exact else m.vertices + 0.0).view(np.int64) for m in (a, b))
    if V.shape != W.shape:
        return None
    left, right = np.lexsort(V.T), np.lexsort(W.T)
    if not np.array_equal(V[left], W[right]):
        return None
    found = right[inverse(left)]
    others = inverse(found)[b.corners]
    return None if _corner_pairs(a.offsets, a.corners, b.offsets, others) is None else found


def matched_corners(a: PolyMesh, b: PolyMesh, found: Correspondence) -> Pairs | None:
    """Return which corners of the polygons of two meshes are which, None if polygons differ."""
    to_a = inverse(found.sites)[found.b.of_vertices[b.corners]]
    return _corner_pairs(a.offsets, found.a.of_vertices[a.corners], b.offsets, to_a)


def differences(a: PolyMesh, b: PolyMesh, pairs: Pairs) -> tuple[Difference, ...]:
    """Return how far each attribute of `a` is from that of `b`."""
    b = with_origin(b, top_left=is_top_left(a))
    return tuple(_difference(a, b, attribute, *pairs) for attribute in a.attributes)


def other_parts(a: PolyMesh, b: PolyMesh, pairs: Pairs) -> tuple[Kind, ...]:
    """Return the kinds of parts of `a` that `b` has not, or other faces in them, or other names."""
    return tuple(p.kind for p in a.parts if not _same_parts(p, b.parts_of(p.kind), a, b, pairs))


def _same_parts(p: Parts, q: Parts | None, a: PolyMesh, b: PolyMesh, pairs: Pairs) -> bool:
    if q is None or sorted(p.names) != sorted(q.names):
        return False
    one = np.repeat(p.of_face, a.sizes)[pairs[0]]
    two = np.repeat(q.of_face, b.sizes)[pairs[1]]
    parts = np.unique(np.stack([one, two]), axis=1)
    # Each part has one counterpart, of the same name.
    if len(np.unique(parts[0])) < parts.shape[1] or len(np.unique(parts[1])) < parts.shape[1]:
        return False
    names, others = ("", *p.names), ("", *q.names)
    return all((i < 0) == (j < 0) and names[i + 1] == others[j + 1] for i, j in parts.T.tolist())


def _pairs(a: PolyMesh, b: PolyMesh, exact: bool) -> Iterator[tuple[Sites, Sites]]:
    """Yield what may correspond: with each position once, as they are, without isolated points.

    Coarse steps may put several vertices of a decoded mesh into one place.
    """
    first, second = _welded(a, exact), _welded(b, exact)
    yield first, second
    if len(first.mesh.vertices) < len(a.vertices) or len(second.mesh.vertices) < len(b.vertices):
        yield _as_it_is(a), _as_it_is(b)
        yield first, _as_it_is(b)
        yield _as_it_is(a), second
    yield _in_faces(first), _in_faces(second)
    yield _in_faces(first), _in_faces(_as_it_is(b))


def _as_it_is(mesh: PolyMesh) -> Sites:
    bare = PolyMesh(mesh.vertices, mesh.corners, mesh.offsets)
    return Sites(bare, np.arange(len(mesh.vertices)))


def _welded(mesh: PolyMesh, exact: bool) -> Sites:
    keep, to = weld(mesh.vertices, exact=exact)
    return Sites(PolyMesh(mesh.vertices[keep], to[mesh.corners], mesh.offsets), to)


def _in_faces(sites: Sites) -> Sites:
    used, corners = np.unique(sites.mesh.corners, return_inverse=True)
    number = np.full(len(sites.mesh.vertices), -1, dtype=np.int64)
    number[used] = np.arange(len(used))
    bare = replace(sites.mesh, vertices=sites.mesh.vertices[used], corners=corners)
    return Sites(bare, number[sites.of_vertices])


def _corner_pairs(offsets: Ints, corners: Ints, other_offsets: Ints, others: Ints) -> Pairs | None:
    """Return the corners of equal polygons of two meshes, int64 (c,) each, None if some differ."""
    sizes, other_sizes = np.diff(offsets), np.diff(other_offsets)
    if not np.array_equal(np.sort(sizes), np.sort(other_sizes)):
        return None
    found: list[Pairs] = []
    for size in np.unique(sizes).tolist():
        left = _canonical(offsets[:-1][sizes == size, None] + np.arange(size), corners)
        right = _canonical(other_offsets[:-1][other_sizes == size, None] + np.arange(size), others)
        left = left[np.lexsort(corners[left].T)]
        right = right[np.lexsort(others[right].T)]
        if not np.array_equal(corners[left], others[right]):
            return None
        found.append((left.ravel(), right.ravel()))
    return np.concatenate([x for x, _ in found]), np.concatenate([y for _, y in found])


def _canonical(at: Ints, corners: Ints) -> Ints:
    """Return polygons (q, size) of corners, each begun where its vertices are least in order."""
    size = at.shape[1]
    first = np.argmin(corners[at], axis=1)[:, None]
    best = begun = np.take_along_axis(at, (first + np.arange(size)) % size, axis=1)
    if size > _ALL_ROTATIONS:
        return best
    for shift in range(1, size):
        turned = np.roll(begun, -shift, axis=1)
        unlike = corners[turned] != corners[best]
        column = np.argmax(unlike, axis=1)[:, None]
        one = np.take_along_axis(corners[turned], column, axis=1)
        other = np.take_along_axis(corners[best], column, axis=1)
        best = np.where(one < other, turned, best)
    return best


def _difference(
    a: PolyMesh, b: PolyMesh, attribute: Attribute, corners: Ints, others: Ints
) -> Difference:
    fitting = [
        x
        for x in b.attributes
        if (x.name, x.role, x.width) == (attribute.name, attribute.role, attribute.width)
        and (x.domain == "face") == (attribute.domain == "face")
    ]
    if not fitting:
        return Difference(attribute, None)
    one = rows_of(a, attribute)[corners]
    rows = [rows_of(b, x)[others] for x in fitting]
    # A file may have several of one name: the one of the same elements, then of the same type.
    gaps = [int(np.count_nonzero((one < 0) != (two < 0))) for two in rows]
    best = min(range(len(fitting)), key=lambda i: (gaps[i], *_unlikeness(attribute, fitting[i])))
    if gaps[best]:
        return Difference(attribute, None)
    other, two = fitting[best], rows[best]
    one, two = one[one >= 0], two[two >= 0]
    return Difference(attribute, _largest(attribute.values[one], other.values[two], attribute.role))


def _unlikeness(attribute: Attribute, other: Attribute) -> tuple[bool, ...]:
    """Return what tells an attribute from another of its name, that which matters most first."""
    one, two = attribute.values.dtype, other.values.dtype
    return (
        attribute.domain != other.domain,
        one.kind != two.kind,
        one != two,
        attribute.normalized != other.normalized,
    )


def rows_of(mesh: PolyMesh, attribute: Attribute) -> Ints:
    """Return the row of an attribute that each corner of the polygons has, -1 for none."""
    rows = attribute.rows()
    if attribute.domain == "vertex":
        return rows[mesh.corners]
    return rows if attribute.domain == "corner" else np.repeat(rows, mesh.sizes)


def _largest(values: NDArray[Any], others: NDArray[Any], role: str) -> float:
    """Return the largest difference; equal numbers that are not finite differ by nothing."""
    same = (values == others) | ((values != values) & (others != others))
    if same.all():
        return 0.0
    if role == "normal":
        return float(np.nanmax(angles(values.astype(float), others.astype(float))))
    if "c" in (values.dtype.kind, others.dtype.kind):
        away = np.abs(values.astype(complex) - others.astype(complex))
    else:
        away = np.abs(values.astype(np.longdouble) - others.astype(np.longdouble))
    return float(away[~same].max())
