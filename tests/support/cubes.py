"""A cube as text of each format, and whether a mesh is that cube."""

from __future__ import annotations

import numpy as np

from deltamesh_formats.polymesh.mesh import PolyMesh

VERTICES = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
FACES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]

_POINTS = [" ".join(map(str, row)) for row in VERTICES.astype(int).tolist()]
OBJ = "".join(f"v {row}\n" for row in _POINTS)
OBJ += "".join(f"f {' '.join(str(i + 1) for i in face)}\n" for face in FACES)
_ROWS = "".join(f"{row}\n" for row in _POINTS)
_ROWS += "".join(f"4 {' '.join(map(str, face))}\n" for face in FACES)
OFF = f"OFF\n8 6 0\n{_ROWS}"
PLY_HEADER = (
    "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
    "property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
)
PLY = PLY_HEADER + _ROWS
PLY_BODY = VERTICES.astype("<f4").tobytes() + b"".join(
    b"\4" + np.array(face, dtype="<i4").tobytes() for face in FACES
)
TRIANGLES = np.array([[f[0], f[i], f[i + 1]] for f in FACES for i in (1, 2)])


def _facet(triangle: list[int]) -> str:
    corners = "".join(f"   vertex {_POINTS[i]}\n" for i in triangle)
    normal = np.cross(*(VERTICES[triangle[1:]] - VERTICES[triangle[0]])).astype(int)
    start = f" facet normal {' '.join(map(str, normal.tolist()))}\n  outer loop\n"
    return f"{start}{corners}  endloop\n endfacet\n"


FACETS = "".join(map(_facet, TRIANGLES.tolist()))
STL = f"solid cube\n{FACETS}endsolid cube\n"
_RECORDS = b"".join(
    bytes(12) + VERTICES[triangle].astype("<f4").tobytes() + b"\0\0" for triangle in TRIANGLES
)
STL_BINARY = b"made".ljust(80, b"\0") + (12).to_bytes(4, "little") + _RECORDS


def is_cube(mesh: PolyMesh, more: int = 0) -> bool:
    """Whether all faces of the cube are there, turned outwards, and its vertices, before others."""
    V, F = mesh.vertices, mesh.triangles
    a, b, c = (V[F[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
    same = sorted(V[:8].tolist()) == sorted(VERTICES.tolist())
    counts = len(V) == 8 + more and len(F) == 12
    return bool(counts and same and np.isclose(area, 6) and np.isclose(volume, 1))
