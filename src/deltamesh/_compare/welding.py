"""Welding of a mesh as the encoder does it: each position once, and no vertex without a face."""

from __future__ import annotations

import numpy as np

from deltamesh._graph.halfedges import weld
from deltamesh._mesh import TriangleMesh


def welded(mesh: TriangleMesh, exact: bool = False) -> TriangleMesh:
    """Return the mesh with each position once; `exact` tells 0.0 from -0.0."""
    keep, to = weld(mesh.vertices, exact=exact)
    return TriangleMesh(mesh.vertices[keep], to[mesh.faces])


def without_isolated(mesh: TriangleMesh) -> TriangleMesh:
    """Return the mesh without the vertices that belong to no face."""
    used, faces = np.unique(mesh.faces, return_inverse=True)
    return TriangleMesh(mesh.vertices[used], faces.reshape(mesh.faces.shape))
