"""Positions in formats that hold float32 alone."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.numbers import to_float32

# Of the diagonal of the bounding box. Below it rounding is of no more account than the format's.
_TOLERATED: Final = 2.0**-22


def diagonal_of(vertices: NDArray[np.float64]) -> float:
    """Return the diagonal of the bounding box."""
    with np.errstate(over="ignore"):
        return float(np.linalg.norm(np.ptp(vertices, axis=0)))


def in_float32(
    vertices: NDArray[np.float64], diagonal: float, file_format: str
) -> tuple[NDArray[np.float32], list[str]]:
    """Round positions to float32; words for the loss where it is large for the size of the mesh.

    Parameters
    ----------
    vertices : float64 (n, 3)
    diagonal : float
        Of the bounding box of the mesh.
    file_format : str
        Its name in messages.

    Raises
    ------
    MeshError
        When a coordinate is beyond float32.
    """
    positions = to_float32(vertices)
    if not np.isfinite(positions).all():
        raise MeshError(f"{file_format} holds float32, and a coordinate exceeds that")
    error = float(np.abs(positions - vertices).max(initial=0))
    if error > _TOLERATED * diagonal:
        return positions, [f"positions beyond float32 (by up to {error:.2g})"]
    return positions, []
