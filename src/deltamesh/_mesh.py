"""The mesh, and the one place where arrays from outside are checked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh.mesh import PolyMesh

# The squares of coordinates, and of their sums, have to stay within double precision.
LARGEST = 1e150


@dataclass(frozen=True)
class TriangleMesh:
    """A triangle mesh.

    Attributes
    ----------
    vertices : float64 (n, 3)
        Positions, in the unit of the source.
    faces : int64 (m, 3)
        Vertex indices from 0, counter-clockwise seen from outside.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]


def triangulated(mesh: PolyMesh) -> TriangleMesh:
    """Return the triangles of a mesh of polygons."""
    return TriangleMesh(mesh.vertices, mesh.triangles)


def checked_mesh(vertices: ArrayLike, faces: ArrayLike) -> TriangleMesh:
    """Check arrays from outside and return them as a `Mesh`; the arguments stay as they are.

    Parameters
    ----------
    vertices : array_like, (n, 3) real numbers, finite
    faces : array_like, (m, 3) integers in [0, n)

    Raises
    ------
    MeshError
        For a wrong shape or type, a coordinate that is not finite or beyond 1e150, an index out of
        range; the message names the first offending element.
    """
    V, F = _as_array(vertices, "vertices"), _as_array(faces, "faces")
    if V.ndim != 2 or V.shape[1] != 3:
        raise MeshError(f"vertices must have shape (n, 3), not {V.shape}")
    if F.ndim != 2 or F.shape[1] != 3:
        raise MeshError(f"faces must have shape (m, 3), not {F.shape}: triangles only")
    if V.dtype.kind not in "fiu":
        raise MeshError(f"vertices must be real numbers, not {V.dtype}")
    if F.dtype.kind not in "iu":
        raise MeshError(f"faces must be integers, not {F.dtype}")
    V = np.ascontiguousarray(V, dtype=np.float64)
    _check_finite(V)
    _check_extent(V)
    _check_indices(F, len(V))
    return TriangleMesh(V, np.ascontiguousarray(F, dtype=np.int64))


def _as_array(value: ArrayLike, name: str) -> NDArray[Any]:
    try:
        return np.asarray(value)
    except ValueError as error:
        raise MeshError(f"{name} are not an array: {error}") from None


def _check_extent(V: NDArray[np.float64]) -> None:
    bad = (np.abs(V) > LARGEST).any(axis=1)
    if bad.any():
        i = int(np.argmax(bad))
        raise MeshError(f"vertex {i} is beyond {LARGEST:g}: {V[i].tolist()}")


def _check_finite(V: NDArray[np.float64]) -> None:
    bad = ~np.isfinite(V).all(axis=1)
    if bad.any():
        i = int(np.argmax(bad))
        raise MeshError(f"vertex {i} is not finite: {V[i].tolist()}")


def _check_indices(F: NDArray[np.integer], n: int) -> None:
    bad = ((F < 0) | (n <= F)).any(axis=1)
    if bad.any():
        i = int(np.argmax(bad))
        raise MeshError(f"face {i} has vertex indices {F[i].tolist()}, outside 0..{n - 1}")
