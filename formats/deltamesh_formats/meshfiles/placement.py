"""Positions, normals and tangents under the transforms of a scene, and back.

A transform is float64 (4, 4) with columns as axes; positions, normals and tangents are rows.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Floats


def is_identity(matrix: Floats) -> bool:
    """Return whether a transform, or its linear part, is the identity."""
    return bool((matrix == np.eye(len(matrix))).all())


def is_mirror(matrix: Floats) -> bool:
    """Return whether a transform reverses the winding of faces."""
    with np.errstate(all="ignore"):
        return bool(np.linalg.det(matrix[:3, :3]) < 0)


def moved(points: Floats, matrix: Floats) -> Floats:
    """Return positions, (n, 3), moved by a transform."""
    if is_identity(matrix):
        return points
    turned = points if is_identity(matrix[:3, :3]) else points @ matrix[:3, :3].T
    return turned + matrix[:3, 3]


def moved_back(points: Floats, matrix: Floats) -> Floats:
    """Return positions, (n, 3), before they were moved by a transform that has an inverse."""
    if is_identity(matrix):
        return points
    shifted = points - matrix[:3, 3]
    if is_identity(matrix[:3, :3]):
        return shifted
    return np.linalg.solve(matrix[:3, :3], shifted.T).T.astype(np.float64)


def turned(name: str, values: NDArray[Any], matrix: Floats) -> NDArray[Any]:
    """Return normals or tangents under a transform, other attributes as they are.

    Normals are multiplied by the transpose of the inverse, tangents (three of their four numbers)
    by the matrix; both keep their lengths. Those of signed integers are rounded.
    """
    linear = matrix[:3, :3]
    if name not in ("normal", "tangent") or values.dtype.kind not in "fi" or is_identity(linear):
        return values
    try:
        rule = np.linalg.inv(linear) if name == "normal" else linear.T
    except np.linalg.LinAlgError:
        return values
    before = values[:, :3].astype(np.float64)
    after = before @ rule
    with np.errstate(all="ignore"):
        length = np.linalg.norm(before, axis=1, keepdims=True)
        after *= length / np.linalg.norm(after, axis=1, keepdims=True)
    found = values.astype(np.float64)
    found[:, :3] = np.where(np.isfinite(after), after, before)
    if name == "tangent" and is_mirror(matrix):
        found[:, 3:] *= -1  # the handedness
    if values.dtype.kind == "i":
        largest = np.iinfo(values.dtype).max
        found = np.clip(np.round(found), -largest, largest)
    return found.astype(values.dtype)
