"""Meshes in a pose: positions, and normals that turn with the surface."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from deltamesh._vectors import safe_lengths
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh


def posed_mesh(mesh: PolyMesh, vertices: Floats, turns: Floats) -> PolyMesh:
    """Return a mesh with other positions, and with its normals turned.

    Parameters
    ----------
    mesh : PolyMesh
    vertices : float64 (n, 3)
    turns : float64 (n, 3, 3)
        How the neighbourhood of each vertex has turned. The normals of a polygon turn as its
        corners do in the mean.
    """
    attributes = tuple(
        _turned(one, mesh, turns) if _is_normal(one) else one for one in mesh.attributes
    )
    return replace(mesh, vertices=vertices, attributes=attributes)


def _is_normal(attribute: Attribute) -> bool:
    is_float = attribute.values.dtype.kind == "f"
    return attribute.role == "normal" and attribute.width == 3 and is_float


def _turned(attribute: Attribute, mesh: PolyMesh, turns: Floats) -> Attribute:
    """Return normals with a row for each element, turned; their lengths stay."""
    if attribute.domain == "vertex":
        each = turns
    elif attribute.domain == "corner":
        each = turns[mesh.corners]
    else:
        sums = np.add.reduceat(turns[mesh.corners], mesh.offsets[:-1], axis=0)
        each = sums / mesh.sizes[:, None, None]
    old = attribute.dense().astype(np.float64)
    new = np.einsum("nij,nj->ni", each, old)
    lengths, were = safe_lengths(new), safe_lengths(old)
    has = np.isfinite(old).all(axis=1) & (lengths > 0)
    new[~has] = old[~has]
    new[has] *= (were[has] / lengths[has])[:, None]
    index = None if attribute.index is None else _rows(attribute)
    return replace(attribute, values=new.astype(attribute.values.dtype), index=index)


def _rows(attribute: Attribute) -> Ints:
    """Return the rows of the elements of a table that has one for each, -1 for none."""
    assert attribute.index is not None
    return np.where(attribute.index < 0, -1, np.arange(len(attribute.index)))
