"""Positions in float32: where they lose no more than their margin, and what is lost elsewhere."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh.mesh import PolyMesh

# As a fraction of the largest coordinate: float64 positions that were moved to another place and
# back differ by that.
_NOISE: Final = 2.0**-50


def stored_positions(mesh: PolyMesh) -> NDArray[Any]:
    """Return the vertices, (n, 3), as float32 where the source had that and it holds them.

    It holds them if none is moved by more than the margin of the mesh.
    """
    if mesh.precision == "float32":
        single = _to_float32(mesh.vertices)
        if not rounding_error(single, mesh.vertices) > mesh.margin:
            return single
    return mesh.vertices


def bounding_diagonal(vertices: Floats) -> float:
    """Return the diagonal of the bounding box of positions, (n, 3)."""
    with np.errstate(over="ignore"):
        return float(np.linalg.norm(np.ptp(vertices, axis=0)))


def single_positions(vertices: Floats, file_format: str) -> NDArray[np.float32]:
    """Round positions to float32.

    Parameters
    ----------
    vertices : float64 (n, 3)
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
    return positions


def rounding_error(stored: NDArray[Any], values: NDArray[Any]) -> float:
    """Return the largest difference of numbers in a file from those of a mesh, NaN from NaN 0."""
    with np.errstate(all="ignore"):
        error = np.abs(stored.astype(np.float64) - values.astype(np.float64))
    error[(stored == values) | (np.isnan(stored) & np.isnan(values))] = 0
    return float(error.max(initial=0))


def rounding_losses(what: str, error: float, margin: float, largest: float = 0.0) -> list[str]:
    """Describe the loss where rounding to float32 has moved numbers by more than their margin.

    Parameters
    ----------
    what : str
        Plural, for the description.
    error : float
        The largest difference that rounding made.
    margin : float
    largest : float
        The largest magnitude of numbers that were moved to another place and back.
    """
    if not error <= max(margin, _NOISE * largest):
        return [f"{what} beyond float32 (by up to {error:.2g})"]
    return []


def _to_float32(values: NDArray[Any]) -> NDArray[np.float32]:
    """Round numbers to float32; what is beyond becomes infinite."""
    with np.errstate(over="ignore"):
        return values.astype(np.float32)
