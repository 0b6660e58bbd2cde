"""Positions in float32: where the source had no more, and where a format holds no more."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh.mesh import PolyMesh

# As a fraction of the diagonal of the bounding box: a rounding error up to it is that of the format
# at the size of the mesh, and not worth a warning.
_TOLERANCE: Final = 2.0**-22


def source_positions(mesh: PolyMesh) -> NDArray[Any]:
    """Return the vertices, (n, 3), as float32 where the source had that and none is beyond it."""
    if mesh.precision == "float32":
        rounded = _to_float32(mesh.vertices)
        if np.isfinite(rounded).all():
            return rounded
    return mesh.vertices


def bounding_diagonal(vertices: Floats) -> float:
    """Return the diagonal of the bounding box of positions, (n, 3)."""
    with np.errstate(over="ignore"):
        return float(np.linalg.norm(np.ptp(vertices, axis=0)))


def rounded_positions(
    vertices: Floats, diagonal: float, file_format: str
) -> tuple[NDArray[np.float32], list[str]]:
    """Round positions to float32, and describe the loss if it is large for the size of the mesh.

    Parameters
    ----------
    vertices : float64 (n, 3)
    diagonal : float
        Of the bounding box of the mesh.
    file_format : str
        Title of the format, for messages.

    Raises
    ------
    MeshError
        When a coordinate is beyond float32.
    """
    positions = _to_float32(vertices)
    if not np.isfinite(positions).all():
        i = int(np.argmin(np.isfinite(positions).all(axis=1)))
        raise MeshError(
            f"{file_format} holds float32, and a coordinate of {vertices[i].tolist()} exceeds that"
        )
    error = float(np.abs(positions - vertices).max(initial=0))
    if error > _TOLERANCE * diagonal:
        return positions, [f"positions beyond float32 (by up to {error:.2g})"]
    return positions, []


def _to_float32(values: NDArray[Any]) -> NDArray[np.float32]:
    """Round numbers to float32; what is beyond becomes infinite."""
    with np.errstate(over="ignore"):
        return values.astype(np.float32)
