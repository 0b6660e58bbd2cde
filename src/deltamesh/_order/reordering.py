"""A mesh in another order of its vertices and faces, and how the one comes from the other."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.permutations import inverse
from deltamesh._shape.polygons import Polygons
from deltamesh._shape.provenance import Provenance
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh

_Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Order:
    """Where the elements of a mesh come in another order of it.

    Attributes
    ----------
    vertices : int64 (n,)
        The vertex of the mesh at each place of the other order.
    faces : int64 (p,)
        Likewise, the polygon.
    turns : int64 (p,)
        The corner of that polygon at which it begins there.
    """

    vertices: NDArray[np.int64]
    faces: NDArray[np.int64]
    turns: NDArray[np.int64]


def arrays(order: Order | None) -> tuple[_Ints, ...]:
    """Return what the digest of a file covers of an order."""
    return () if order is None else (order.vertices, order.faces, order.turns)


def order_of(polygons: Polygons, provenance: Provenance, starts: _Ints) -> Order:
    """Return how the order of the input comes from that of a file.

    Parameters
    ----------
    polygons : Polygons
        Of the file.
    provenance : Provenance
        Of what is in the file, which may be less than what is in the input.
    starts : int64
        Where the corners of each polygon of the input begin.
    """
    order = np.argsort(provenance.polygons)
    is_first = provenance.corners == np.repeat(
        starts[provenance.polygons], np.diff(polygons.offsets)
    )
    begin = np.flatnonzero(is_first) - polygons.offsets[:-1]
    return Order(np.argsort(provenance.vertices), order, begin[order])


def reordered(mesh: PolyMesh, order: Order) -> PolyMesh:
    """Return a mesh in the other order of its vertices and polygons."""
    corners, offsets = rows_of(mesh.offsets, order.faces, order.turns)
    return rearranged(mesh, order.vertices, order.faces, corners, offsets)


def rows_of(offsets: _Ints, faces: _Ints, begin: _Ints) -> tuple[_Ints, _Ints]:
    """Return the corners of polygons in another order, each from another one on, and offsets.

    Parameters
    ----------
    offsets : int64 (p + 1,)
        Where the corners of each polygon begin.
    faces, begin : int64 (p,)
        The polygons, and which of its corners each begins with.
    """
    sizes = np.diff(offsets)[faces]
    ends = np.concatenate(([0], np.cumsum(sizes)))
    within = np.arange(ends[-1]) - np.repeat(ends[:-1] - begin, sizes)
    return np.repeat(offsets[faces], sizes) + within % np.repeat(sizes, sizes), ends


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
