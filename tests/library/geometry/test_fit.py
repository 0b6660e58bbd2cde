"""The encoder's fit of what cells have lost, against dense matrices."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import poisson_oracle
import pytest
from test_cells import cells_of

from deltamesh._geometry import fit
from deltamesh._geometry.fit import Fit

MESHES = {name: mesh for name, mesh in meshes.every().items() if name != "with_isolated"}
LARGE = {"sphere": meshes.icosphere(3), "torus": meshes.torus(40, 20), "grid": meshes.grid(25, 25)}


def rounding(L, seed=0):
    """What is left of deltas that were rounded: centred, as both are Laplacians, nearly."""
    q = np.random.default_rng(seed).uniform(-0.5, 0.5, (len(L), 3))
    for part in poisson_oracle.parts(L):
        q[part] -= q[part].mean(axis=0)
    return q


def rms(x):
    return np.sqrt((x**2).sum(axis=1).mean())


@pytest.mark.parametrize("share", [0.0, 0.1, 1.0])
@pytest.mark.parametrize("name", MESHES)
def test_smooth_vectors_are_means_of_what_is_smoothed(name: str, share: float) -> None:
    V, F = MESHES[name]
    cells, L = cells_of(F, len(V), share), oracle.laplacian(F, len(V))
    q = rounding(L)
    indicators = np.eye(len(cells.anchors))[cells.of]
    sums, sizes = (
        indicators.T @ poisson_oracle.smoothed(L, x, fit.ROUNDS) for x in (q, np.ones((len(V), 1)))
    )
    np.testing.assert_allclose(Fit(cells).smooth(q), sums / sizes, atol=1e-12)


@pytest.mark.parametrize("share", [0.02, 0.05])
@pytest.mark.parametrize("name", LARGE)
def test_two_steps_do_for_the_mean_errors_of_all_cells(name: str, share: float) -> None:
    """The equations K y = P^T L^+ q, solved densely, have little to add."""
    V, F = LARGE[name]
    cells, L = cells_of(F, len(V), share), oracle.laplacian(F, len(V))
    q, k = rounding(L), len(cells.anchors)
    indicators, inverse = np.eye(k)[cells.of], np.linalg.pinv(L)
    y, e = Fit(cells).exact(q)
    left = inverse @ cells.completed(q, -y)
    # What the steps know of the errors is near to what they are.
    assert rms(left - e) < 0.1 * rms(left)
    best = np.linalg.lstsq(
        indicators.T @ inverse @ indicators, indicators.T @ inverse @ q, rcond=None
    )[0]
    none, least = rms(inverse @ q), rms(inverse @ cells.completed(q, -best))
    smooth = rms(inverse @ cells.completed(q, -Fit(cells).smooth(q)))
    assert rms(left) < smooth < none
    assert rms(left) <= 1.15 * least
    means = [np.abs(indicators.T @ x / cells.sizes).max() for x in (left, inverse @ q)]
    assert means[0] < 0.3 * means[1]


@pytest.mark.parametrize("name", LARGE)
def test_scale_changes_nothing(name: str) -> None:
    V, F = LARGE[name]
    cells, q = cells_of(F, len(V), 0.05), rounding(oracle.laplacian(F, len(V)))
    y, e = Fit(cells).exact(q)
    for scale in (2.0**-20, 2.0**20):
        for found, expected in zip(Fit(cells).exact(q * scale), (y, e), strict=True):
            np.testing.assert_allclose(found / scale, expected, atol=1e-6 * np.abs(expected).max())


def test_the_same_again_to_the_last_bit() -> None:
    V, F = LARGE["torus"]
    q = rounding(oracle.laplacian(F, len(V)))
    one, two = (Fit(cells_of(F, len(V), 0.05)).exact(q.copy()) for _ in range(2))
    assert [array.tobytes() for array in one] == [array.tobytes() for array in two]


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("share", [0.0, 1.0])
def test_the_fewest_and_the_most_anchors(name: str, share: float) -> None:
    """One cell a component loses nothing; with one a vertex, nothing is left."""
    V, F = MESHES[name]
    cells, L = cells_of(F, len(V), share), oracle.laplacian(F, len(V))
    q = rounding(L)
    y, e = Fit(cells).exact(q)
    assert np.isfinite(y).all()
    assert np.isfinite(e).all()
    if share:
        assert rms(e) < 0.5 * rms(np.linalg.pinv(L) @ q)
    else:
        np.testing.assert_allclose(y, 0, atol=1e-12)


def test_without_anything_lost_there_is_nothing_to_fit() -> None:
    V, F = LARGE["sphere"]
    y, e = Fit(cells_of(F, len(V), 0.05)).exact(np.zeros_like(V))
    assert not y.any()
    assert not e.any()
