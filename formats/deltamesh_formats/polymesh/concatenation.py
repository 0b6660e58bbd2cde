"""Concatenation of several meshes into one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from deltamesh_formats.array_types import Ints
from deltamesh_formats.polymesh.kinds import Kind
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh


def concatenate(meshes: Sequence[PolyMesh]) -> PolyMesh:
    """Return one mesh of the vertices, polygons, attributes and parts of several.

    Attributes of one domain, name, role, type and width become one; elements of a mesh without it
    have no row. Parts of one kind follow each other. Metadata are those of the first mesh.

    Parameters
    ----------
    meshes : sequence of PolyMesh
        At least one.
    """
    points = _starts([len(mesh.vertices) for mesh in meshes])
    corners = _starts([len(mesh.corners) for mesh in meshes])
    offsets = [mesh.offsets[1:] + start for mesh, start in zip(meshes, corners, strict=False)]
    counts = {
        "vertex": points,
        "corner": corners,
        "face": _starts([len(mesh.offsets) - 1 for mesh in meshes]),
    }
    same: dict[tuple[Any, ...], list[Attribute | None]] = {}
    for i, mesh in enumerate(meshes):
        for a in mesh.attributes:
            key = (a.domain, a.name, a.role, a.values.dtype, a.width, a.normalized)
            same.setdefault(key, [None] * len(meshes))[i] = a
    kinds: dict[Kind, None] = dict.fromkeys(p.kind for mesh in meshes for p in mesh.parts)
    return replace(
        meshes[0],
        vertices=np.concatenate([mesh.vertices for mesh in meshes]),
        corners=np.concatenate(
            [mesh.corners + start for mesh, start in zip(meshes, points, strict=False)]
        ),
        offsets=np.concatenate([np.zeros(1, dtype=np.int64), *offsets]),
        attributes=tuple(_attribute(some, counts[key[0]]) for key, some in same.items()),
        parts=tuple(_parts(kind, meshes) for kind in kinds),
        lost=tuple(dict.fromkeys(description for mesh in meshes for description in mesh.lost)),
        precision="float32" if all(m.precision == "float32" for m in meshes) else "float64",
        margin=min(mesh.margin for mesh in meshes),
    )


def _starts(counts: Sequence[int]) -> Ints:
    """Return the first element of each mesh, and the end of the last."""
    return np.cumsum([0, *counts], dtype=np.int64)


def _attribute(some: Sequence[Attribute | None], starts: Ints) -> Attribute:
    there = [a for a in some if a is not None]
    values, margin = np.concatenate([a.values for a in there]), min(a.margin for a in there)
    if len(there) == len(some) and all(a.index is None for a in there):
        return replace(there[0], values=values, margin=margin)
    index = np.full(int(starts[-1]), -1)
    first = 0
    for a, begin, end in zip(some, starts[:-1], starts[1:], strict=True):
        if a is not None:
            rows = a.rows()
            index[begin:end] = np.where(rows < 0, -1, rows + first)
            first += len(a.values)
    return replace(there[0], values=values, index=index, margin=margin)


def _parts(kind: Kind, meshes: Sequence[PolyMesh]) -> Parts:
    names: tuple[str, ...] = ()
    of_face, transforms = [], []
    for mesh in meshes:
        parts = mesh.parts_of(kind)
        if parts is None:
            of_face.append(np.full(len(mesh.offsets) - 1, -1))
            continue
        of_face.append(np.where(parts.of_face < 0, -1, parts.of_face + len(names)))
        names += parts.names
        own = parts.transforms
        transforms.append(np.tile(np.eye(4), (len(parts.names), 1, 1)) if own is None else own)
    moved = any(p.kind == kind and p.transforms is not None for m in meshes for p in m.parts)
    return Parts(
        kind, names, np.concatenate(of_face), np.concatenate(transforms) if moved else None
    )
