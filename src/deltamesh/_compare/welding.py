"""A mesh as an encoder sees it: each position once, and no vertex without a face."""

from __future__ import annotations

import numpy as np

from deltamesh._graph.halfedges import weld
from deltamesh._mesh import Mesh


def welded(mesh: Mesh, exact: bool = False) -> Mesh:
    """Return the mesh with each position once; `exact` tells 0.0 from -0.0."""
    keep, to = weld(mesh.vertices, exact=exact)
    return Mesh(mesh.vertices[keep], to[mesh.faces])


def without_isolated(mesh: Mesh) -> Mesh:
    """Return the mesh without the vertices that belong to no face."""
    used, faces = np.unique(mesh.faces, return_inverse=True)
    return Mesh(mesh.vertices[used], faces.reshape(mesh.faces.shape))
