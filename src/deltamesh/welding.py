"""A mesh as an encoder sees it: each position once, and no vertex without a face."""

from __future__ import annotations

from typing import TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from deltamesh.mesh import Mesh
from deltamesh.topology import weld
from deltamesh_formats.polymesh import PolyMesh

_Ints = NDArray[np.int64]

# What is in a mesh beside its vertices and faces is left out.
AnyMesh = TypeVar("AnyMesh", Mesh, PolyMesh)


def welded(mesh: AnyMesh, exact: bool = False) -> AnyMesh:
    """Return the mesh with each position once; `exact` tells 0.0 from -0.0."""
    keep, to = weld(mesh.vertices, exact=exact)
    return _of_vertices(mesh, keep, to)


def without_isolated(mesh: AnyMesh) -> AnyMesh:
    """Return the mesh without the vertices that belong to no face."""
    used = np.unique(mesh.corners if isinstance(mesh, PolyMesh) else mesh.faces)
    to = np.empty(len(mesh.vertices), dtype=np.int64)
    to[used] = np.arange(len(used))
    return _of_vertices(mesh, used, to)


@overload
def _of_vertices(mesh: Mesh, keep: _Ints, to: _Ints) -> Mesh: ...


@overload
def _of_vertices(mesh: PolyMesh, keep: _Ints, to: _Ints) -> PolyMesh: ...


def _of_vertices(mesh: Mesh | PolyMesh, keep: _Ints, to: _Ints) -> Mesh | PolyMesh:
    """Return the mesh of the vertices to keep; `to` are the new indices of the old ones."""
    if isinstance(mesh, PolyMesh):
        return PolyMesh(mesh.vertices[keep], to[mesh.corners], mesh.offsets)
    return Mesh(mesh.vertices[keep], to[mesh.faces])
