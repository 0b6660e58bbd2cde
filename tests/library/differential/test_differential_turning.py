"""Rotations of the research module: a turned surface has turned deltas."""

from __future__ import annotations

import meshes
import numpy as np
import pytest

from deltamesh.differential import (
    deltas,
    fitted_rotations,
    laplacian,
    nearest_rotations,
    turned_deltas,
)

# About (1, 2, 2) / 3, by 90 degrees.
TURN = np.array([[1, -4, 8], [8, 4, 1], [-4, 7, 4]]) / 9


@pytest.mark.parametrize("rings", [0, 2])
def test_a_turned_surface_has_turned_deltas(rings: int) -> None:
    V, F = meshes.icosphere(2)
    L = laplacian(F, len(V))
    R = fitted_rotations(L, V, V @ TURN.T + 5, rings)
    np.testing.assert_allclose(R, np.broadcast_to(TURN, R.shape), atol=1e-9)
    np.testing.assert_allclose(turned_deltas(L, V, R), deltas(L, V) @ TURN.T, atol=1e-9)


def test_the_nearest_rotation_of_a_multiple_is_itself() -> None:
    np.testing.assert_allclose(nearest_rotations([2 * TURN, 0.3 * TURN]), [TURN] * 2, atol=1e-12)


def test_faults_are_named() -> None:
    V, F = meshes.tetrahedron()
    L = laplacian(F, 4)
    with pytest.raises(ValueError, match=r"vertices after have shape \(3, 3\), not \(4, 3\)"):
        fitted_rotations(L, V, V[:3])
    with pytest.raises(ValueError, match=r"matrices have shape \(3, 3\), not \(k, 3, 3\)"):
        nearest_rotations(TURN)
    with pytest.raises(ValueError, match="1 matrices for 4 vertices"):
        turned_deltas(L, V, [TURN])
