"""Numbers as text: the shortest that reads as the same number again."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.polymesh.mesh import PolyMesh


def texts(values: NDArray[Any]) -> list[str]:
    """Return each number of an array, flattened, in the shortest form that its type tells apart.

    float32 and float16 are shorter than float64; whole numbers have no point.
    """
    flat = values.ravel()
    if flat.dtype.kind == "f" and flat.dtype.itemsize < 8:
        return list(map(str, flat))
    return list(map(repr, flat.tolist()))


def rows(values: NDArray[Any]) -> list[str]:
    """Return the numbers of each row of an array, (rows, width), with spaces between."""
    width = values.shape[1]
    flat = texts(values)
    return list(map(" ".join, zip(*(flat[i::width] for i in range(width)), strict=True)))


def positions(mesh: PolyMesh) -> NDArray[Any]:
    """Return the vertices, (n, 3), as float32 where the source had that and none is beyond it."""
    if mesh.precision == "float32":
        single = to_float32(mesh.vertices)
        if np.isfinite(single).all():
            return single
    return mesh.vertices


def to_float32(values: NDArray[Any]) -> NDArray[np.float32]:
    """Round numbers to float32; what is beyond becomes infinite."""
    with np.errstate(over="ignore"):
        return values.astype(np.float32)


def fractions(values: NDArray[Any], normalized: bool) -> NDArray[Any]:
    """Return colours from 0 to 1, as text formats have them, from fractions of an integer type."""
    if not normalized or values.dtype.kind not in "iu":
        return values
    return values / np.iinfo(values.dtype).max
