"""A mesh in another order of its vertices and faces, and how the one comes from the other."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from deltamesh.correspondence import canonical
from deltamesh.polygons import Polygons
from deltamesh_formats.polymesh import Attribute, PolyMesh

_Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Order:
    """Where the elements of a mesh come in another order of it.

    Attributes
    ----------
    vertices : int64 (n,)
        The vertex of the mesh at each place of the other order.
    faces : int64 (m,)
        Likewise, the face.
    turns : int64 (m,)
        The corner of that face, 0 to 2, at which it begins there.
    """

    vertices: NDArray[np.int64]
    faces: NDArray[np.int64]
    turns: NDArray[np.int64]


def arrays(order: Order | None) -> tuple[_Ints, ...]:
    """Return what the digest of a file covers of an order."""
    return () if order is None else (order.vertices, order.faces, order.turns)


def order_of(names: _Ints, faces: _Ints, others: _Ints) -> Order:
    """Return how another order of a mesh comes from it.

    Parameters
    ----------
    names : int64 (n,)
        What the other order calls the vertices of the mesh, all different; they ascend there.
    faces : int64 (m, 3)
        Of the mesh.
    others : int64 (m, 3)
        The same faces by those names, in the other order; they may begin at other corners.
    """
    named = names[faces]
    left, right = canonical(named), canonical(others)
    order = np.empty(len(faces), dtype=np.int64)
    order[np.lexsort(right.T)] = np.lexsort(left.T)
    turns = np.zeros(len(faces), dtype=np.int64)
    for turn in (2, 1, 0):
        turns[(np.roll(named[order], -turn, axis=1) == others).all(axis=1)] = turn
    return Order(np.argsort(names), order, turns)


def reordered(mesh: PolyMesh, polygons: Polygons, order: Order) -> PolyMesh:
    """Return a mesh in the other order of its vertices and triangles.

    Polygons come in the order of their first triangles, and begin where these do.

    Parameters
    ----------
    mesh : PolyMesh
        Of these polygons.
    polygons : Polygons
    order : Order
        Of the triangles.
    """
    place, first = inverse(order.faces), polygons.offsets[:-1]
    of_polygons = np.minimum.reduceat(place[polygons.corners // 3], first)
    faces = np.argsort(of_polygons)
    lowest = order.faces[of_polygons[faces]]
    begin = polygons.of_corners[3 * lowest + order.turns[of_polygons[faces]]] - first[faces]
    sizes = mesh.sizes[faces]
    offsets = np.concatenate(([0], np.cumsum(sizes)))
    within = np.arange(len(mesh.corners)) - np.repeat(offsets[:-1], sizes)
    corners = np.repeat(first[faces], sizes)
    corners += (within + np.repeat(begin, sizes)) % np.repeat(sizes, sizes)
    return rearranged(mesh, order.vertices, faces, corners, offsets)


def rearranged(
    mesh: PolyMesh, vertices: _Ints, faces: _Ints, corners: _Ints, offsets: _Ints
) -> PolyMesh:
    """Return the mesh of these vertices, faces and corners of it, in this order.

    Parameters
    ----------
    mesh : PolyMesh
    vertices, faces, corners : int64 (n,), (p,), (c,)
        Permutations; the corners are those of the faces.
    offsets : int64 (p + 1,)
    """
    rows = {"vertex": vertices, "corner": corners, "face": faces}
    return replace(
        mesh,
        vertices=mesh.vertices[vertices],
        corners=inverse(vertices)[mesh.corners[corners]],
        offsets=offsets,
        attributes=tuple(at(a, rows[a.domain]) for a in mesh.attributes),
        parts=tuple(replace(p, of_face=p.of_face[faces]) for p in mesh.parts),
    )


def at(attribute: Attribute, elements: _Ints) -> Attribute:
    """Return an attribute of these elements, in this order."""
    if attribute.index is None:
        return replace(attribute, values=attribute.values[elements])
    return replace(attribute, index=attribute.index[elements])


def inverse(permutation: _Ints) -> _Ints:
    """Return the inverse of a permutation (n,)."""
    result = np.empty_like(permutation)
    result[permutation] = np.arange(len(permutation))
    return result
