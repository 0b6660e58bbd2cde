"""Conversion of attributes of corners to vertices, for libraries that have only the latter.

A seam is where corners at a vertex differ, as texture coordinates do where a chart ends.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Ints
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh


def at_vertices(mesh: PolyMesh, attribute: Attribute) -> NDArray[Any] | None:
    """Return an attribute of corners as one of vertices, (n, width); None if it has seams.

    An isolated vertex has `Attribute.filler`. Numbers are compared bit by bit.
    """
    values = attribute.dense()
    first = _first_corners(mesh)
    bits = _bits(values)
    if (bits != bits[first[mesh.corners]]).any():
        return None
    return replace(attribute, domain="vertex", values=values, index=first).dense()


def split_at_seams(mesh: PolyMesh, attribute: Attribute) -> PolyMesh:
    """Return a mesh with the vertices at the seams of an attribute of corners repeated.

    The attribute becomes one of vertices. A vertex keeps the value of its first corner; vertices
    for other values follow after all vertices, in the order of their corners. Faces and all other
    attributes are as they were.

    Parameters
    ----------
    mesh : PolyMesh
    attribute : Attribute
        Attribute of its corners.
    """
    n, c = len(mesh.vertices), len(mesh.corners)
    values = attribute.dense()
    kind = np.unique(_bits(values), axis=0, return_inverse=True)[1].reshape(-1)
    pairs = mesh.corners * (int(kind.max(initial=0)) + 1) + kind
    # The pairs of vertex and value, and the first corner of each.
    _, corner, pair = np.unique(pairs, return_index=True, return_inverse=True)
    further = np.sort(corner[corner != _first_corners(mesh)[mesh.corners[corner]]])
    vertex_of = np.empty(c, dtype=np.int64)
    vertex_of[corner] = mesh.corners[corner]
    vertex_of[further] = n + np.arange(len(further))
    source = np.concatenate([np.arange(n), mesh.corners[further]])
    index = np.full(len(source), -1)
    index[vertex_of[corner]] = corner
    own = replace(attribute, domain="vertex", values=values, index=index)
    attributes = (
        replace(own, values=own.dense(), index=None) if a is attribute else _repeated(a, source)
        for a in mesh.attributes
    )
    return replace(
        mesh,
        vertices=mesh.vertices[source],
        corners=vertex_of[corner][pair.reshape(-1)],
        attributes=tuple(attributes),
    )


def _repeated(attribute: Attribute, source: Ints) -> Attribute:
    if attribute.domain != "vertex":
        return attribute
    if attribute.index is None:
        return replace(attribute, values=attribute.values[source])
    return replace(attribute, index=attribute.index[source])


def _first_corners(mesh: PolyMesh) -> Ints:
    """Return the first corner at each vertex, int64 (n,), -1 for none."""
    first = np.full(len(mesh.vertices), -1)
    first[mesh.corners[::-1]] = np.arange(len(mesh.corners))[::-1]
    return first


def _bits(values: NDArray[Any]) -> NDArray[Any]:
    return np.ascontiguousarray(values).view(f"u{values.dtype.itemsize}")
