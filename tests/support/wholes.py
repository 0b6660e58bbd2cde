"""Meshes with something of everything, what is compared of two, and whether the codec keeps it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import meshes
import numpy as np
import polymeshes

import deltamesh
from deltamesh_formats.polymesh.mesh import PolyMesh

NUMBERS = ("f4", "f8", "u1", "i2", "i4", "i8")
VERTEX = polymeshes.Kind("vertex", NUMBERS, (1, 3, 5), partly=True)
FACE = polymeshes.Kind("face", NUMBERS, (1, 2), partly=True)
CORNER = polymeshes.Kind("corner", NUMBERS, (1, 2), partly=True)
NORMAL = polymeshes.Kind("vertex", ("f4", "f8"), (3,), "normal")
UV = polymeshes.Kind("vertex", ("f8",), (2,), "uv")
COLOUR = polymeshes.Kind("vertex", ("u1",), (4,), "colour")
PARTS = {"material": polymeshes.names, "group": polymeshes.names}


def plain(mesh: PolyMesh) -> dict[str, Any]:
    """Everything of a mesh, attributes as a row for each element."""
    rows = (replace(a, values=a.dense(), index=None) for a in mesh.attributes)
    return polymeshes.described(replace(mesh, attributes=tuple(rows)))


def sample(faces: Any = None, corner: bool = False) -> PolyMesh:
    """A torus with attributes of vertices and faces, and of corners with seams."""
    V, F = meshes.torus(9, 7)
    faces = F if faces is None else faces
    count = sum(map(len, faces))
    rng = np.random.default_rng(1)
    return deltamesh.from_arrays(
        V,
        faces,
        vertex={
            "temperature": rng.random(len(V)),
            "normal": rng.standard_normal((len(V), 3)).astype(np.float32),
            "colour": rng.integers(0, 256, (len(V), 4), dtype=np.uint8),
        },
        face={"region": rng.integers(0, 5, len(faces))},
        corner={"uv": rng.random((count, 2))} if corner else {},
    )
