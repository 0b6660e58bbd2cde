"""Motion between frames: maps that are fitted, and the deltas that they make."""

from __future__ import annotations

import meshes
import numpy as np
import pytest
from animated import positions

from deltamesh._geometry import anchors as choice
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.motion import UNIT, Motion, carried, fitted_motion
from deltamesh._kernels.mesh import laplacian
from deltamesh._shape.surface import surface_of
from deltamesh._vectors import lengths


def cells_of(V, F, count):
    surface = surface_of(F, len(V), 0)
    anchors = choice.farthest(*surface.graph, surface.labels, count)
    return Cells(surface.graph, surface.labels, anchors)


V, F = meshes.torus(24, 18)
LINEAR = np.array([[0.5, -0.75, 0.125], [0.5, 1.25, 0.0], [-0.25, 0.0, 1.5]])  # multiples of 2^-6


@pytest.mark.parametrize("rounds", [0, 7, 255])
def test_a_map_carries_deltas_exactly(rounds: int) -> None:
    cells = cells_of(V, F, 5)
    rows = np.tile(np.rint((LINEAR - np.eye(3)) * 2**UNIT).astype(np.int64), (5, 1))
    found = carried(V, Motion(rows, rounds, UNIT), cells)
    expected = laplacian.apply(*cells.graph, V @ LINEAR.T)
    np.testing.assert_allclose(found, expected, atol=1e-13)


def test_a_linear_motion_is_found() -> None:
    cells = cells_of(V, F, 5)
    motion = fitted_motion(V, V @ LINEAR.T + np.array([3, 1, 4]), cells)
    assert motion is not None
    maps = np.eye(3) + motion.rows.reshape(-1, 3, 3) * 2.0**-UNIT
    assert np.abs(maps - LINEAR).max() <= 2.0**-UNIT


def test_nothing_that_stays_or_only_slides_has_a_motion() -> None:
    cells = cells_of(V, F, 5)
    assert fitted_motion(V, V, cells) is None
    assert fitted_motion(V, V + np.array([1e3, 2, -7]), cells) is None


def test_a_flat_surface_is_turned_with_its_normals() -> None:
    """Nothing of it tells what becomes of a direction across: a rotation does."""
    V, F = meshes.grid(12, 12)
    V = np.pad(V[:, :2], ((0, 0), (0, 1)))
    turn = np.array([[1, 0, 0], [0, 0.6, -0.8], [0, 0.8, 0.6]])
    motion = fitted_motion(V, V @ turn.T, cells_of(V, F, 3))
    assert motion is not None
    maps = np.eye(3) + motion.rows.reshape(-1, 3, 3) * 2.0**-UNIT
    assert np.abs(maps - turn).max() <= 2.0**-UNIT


@pytest.mark.parametrize("V", [np.zeros((6, 3)), np.pad(np.arange(6.0)[:, None], ((0, 0), (0, 2)))])
def test_a_point_and_a_line_have_maps(V) -> None:
    F = np.array([[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 5]])
    motion = fitted_motion(V, V @ LINEAR.T, cells_of(V, F, 2))
    assert motion is None or np.isfinite(carried(V, motion, cells_of(V, F, 2))).all()


def test_maps_predict_a_twist_better_than_nothing() -> None:
    cells = cells_of(V, F, 12)
    before, after = positions(V, 2)
    motion = fitted_motion(before, after, cells)
    assert motion is not None
    wanted = laplacian.apply(*cells.graph, after)
    by_maps = lengths(wanted - carried(before, motion, cells)).mean()
    plain = lengths(wanted - laplacian.apply(*cells.graph, before)).mean()
    assert by_maps < 0.3 * plain
