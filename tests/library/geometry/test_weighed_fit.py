"""The encoder's fit of anchors that are weighed in least squares, against dense matrices."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest
from test_cells import cells_of

from deltamesh._geometry.solve import LeastSquares
from deltamesh._geometry.weighed_fit import moves

MESHES = {
    "sphere": meshes.icosphere(3),
    "torus": meshes.torus(40, 20),
    "grid": meshes.grid(25, 25),
    "two": meshes.union(meshes.icosphere(2), meshes.torus(15, 12)),
}


def rms(x):
    return np.sqrt((x**2).sum(axis=1).mean())


def rounding(L, V, step):
    """What is left of deltas: that of a rounding or, of 0 bits, all of them."""
    noise = np.random.default_rng(1).uniform(-0.5, 0.5, (len(L), 3))
    return step * noise if step else L @ V


@pytest.mark.parametrize("step", [0.1, 0.0], ids=["quantized", "0 bits"])
@pytest.mark.parametrize("k", [2, 30])
@pytest.mark.parametrize("name", MESHES)
def test_moves_are_nearly_the_best_ones(name: str, k: int, step: float) -> None:
    V, F = MESHES[name]
    cells = cells_of(F, len(V), k / len(V))
    anchors, L = cells.anchors, oracle.laplacian(F, len(V))
    left = rounding(L, V, step)
    system = LeastSquares(cells.graph, anchors)
    d, e = moves(system, cells, left)
    copied = -oracle.least_squares(L, anchors, left, np.zeros((len(anchors), 3)))
    basis = oracle.least_squares(L, anchors, np.zeros((len(L), len(anchors))), np.eye(len(anchors)))
    best = np.linalg.lstsq(basis, -copied, rcond=None)[0]
    least = rms(copied + basis @ best)
    # What is said of the vertices is so.
    np.testing.assert_allclose(e, copied + basis @ d, atol=1e-6 * np.abs(copied).max())
    assert rms(e) <= 1.05 * least
    assert rms(e) < rms(copied)


def test_nothing_left_moves_nothing() -> None:
    V, F = MESHES["torus"]
    cells = cells_of(F, len(V), 0.01)
    d, e = moves(LeastSquares(cells.graph, cells.anchors), cells, np.zeros_like(V))
    assert not d.any()
    assert not e.any()


def test_all_vertices_as_anchors() -> None:
    V, F = meshes.icosphere(1)
    cells = cells_of(F, len(V), 1.0)
    L = oracle.laplacian(F, len(V))
    left = rounding(L, V, 0.1)
    d, e = moves(LeastSquares(cells.graph, cells.anchors), cells, left)
    assert d.shape == V.shape
    copied = oracle.least_squares(L, cells.anchors, left, 0 * V)
    assert rms(e) < rms(copied)
