"""Orders of the vertices and polygons of a mesh, and meshes in another order."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from deltamesh._shape.polygons import Polygons
from deltamesh._shape.provenance import Provenance
from deltamesh_formats.array_types import Ints
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh
from deltamesh_formats.polymesh.permutations import inverse


@dataclass(frozen=True)
class Order:
    """Another order of the elements of a mesh.

    Attributes
    ----------
    vertices : int64 (n,)
        The vertex of the mesh at each place of the other order.
    polygons : int64 (p,)
        The polygon of the mesh at each place.
    rotations : int64 (p,)
        The corner at which that polygon begins in the other order.
    """

    vertices: Ints
    polygons: Ints
    rotations: Ints

    @property
    def arrays(self) -> tuple[Ints, ...]:
        """The arrays that the digest of a file covers."""
        return self.vertices, self.polygons, self.rotations


def order_of(polygons: Polygons, provenance: Provenance, starts: Ints) -> Order:
    """Return the order of the input, as another order of a file.

    Parameters
    ----------
    polygons : Polygons
        Of the file.
    provenance : Provenance
        Of the elements of the file, which may be fewer than those of the input.
    starts : int64
        The first corner of each polygon of the input.
    """
    p = provenance
    order = np.argsort(p.polygons)
    is_first = p.corners == np.repeat(starts[p.polygons], np.diff(polygons.offsets))
    rotations = np.flatnonzero(is_first) - polygons.offsets[:-1]
    return Order(np.argsort(p.vertices), order, rotations[order])


def reordered(mesh: PolyMesh, order: Order) -> PolyMesh:
    """Return a mesh in another order of its vertices and polygons."""
    corners, offsets = permuted_corners(mesh.offsets, order.polygons, order.rotations)
    return permuted(mesh, order.vertices, order.polygons, corners, offsets)


def permuted_corners(offsets: Ints, polygons: Ints, rotations: Ints) -> tuple[Ints, Ints]:
    """Return the corners of polygons in another order, and the offsets of the polygons.

    Parameters
    ----------
    offsets : int64 (p + 1,)
        The first corner of each polygon, and the end.
    polygons, rotations : int64 (p,)
        The polygons in their order, and the corner at which each begins.
    """
    sizes = np.diff(offsets)[polygons]
    ends = np.concatenate(([0], np.cumsum(sizes)))
    within = np.arange(ends[-1]) - np.repeat(ends[:-1] - rotations, sizes)
    return np.repeat(offsets[polygons], sizes) + within % np.repeat(sizes, sizes), ends


def permuted(
    mesh: PolyMesh, vertices: Ints, polygons: Ints, corners: Ints, offsets: Ints
) -> PolyMesh:
    """Return a mesh with its vertices, polygons and corners permuted.

    Parameters
    ----------
    mesh : PolyMesh
    vertices, polygons, corners : int64 (n,), (p,), (c,)
        The element of the mesh at each place; the corners are those of the polygons.
    offsets : int64 (p + 1,)
        The first of the permuted corners of each polygon, and the end.
    """
    rows = {"vertex": vertices, "corner": corners, "face": polygons}
    return replace(
        mesh,
        vertices=mesh.vertices[vertices],
        corners=inverse(vertices)[mesh.corners[corners]],
        offsets=offsets,
        attributes=tuple(permuted_attribute(a, rows[a.domain]) for a in mesh.attributes),
        parts=tuple(replace(p, of_face=p.of_face[polygons]) for p in mesh.parts),
    )


def permuted_attribute(attribute: Attribute, elements: Ints) -> Attribute:
    """Return an attribute with the values of these elements, in this order."""
    if attribute.index is None:
        return replace(attribute, values=attribute.values[elements])
    return replace(attribute, index=attribute.index[elements])
