"""A mesh in another order of its vertices and faces, and how the one comes from the other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from deltamesh.correspondence import canonical
from deltamesh.mesh import Mesh

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


def reordered(mesh: Mesh, order: Order) -> Mesh:
    """Return a mesh in the other order."""
    corners = (order.turns[:, None] + np.arange(3)) % 3
    turned = np.take_along_axis(mesh.faces[order.faces], corners, axis=1)
    return Mesh(mesh.vertices[order.vertices], inverse(order.vertices)[turned])


def inverse(permutation: _Ints) -> _Ints:
    """Return the inverse of a permutation (n,)."""
    result = np.empty_like(permutation)
    result[permutation] = np.arange(len(permutation))
    return result
