"""Cells of anchors, against dense matrices."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import poisson_oracle
import pytest

from deltamesh._geometry import anchors as choice
from deltamesh._geometry.cells import Cells
from deltamesh._graph.adjacency import adjacency, components

MESHES = meshes.every()
CASES = [(name, share) for name in MESHES for share in (0.0, 0.1, 1.0) if name != "with_isolated"]


def cells_of(F, n: int, share: float = 0.1) -> Cells:
    """The cells of so many of the farthest vertices, one a component at least."""
    graph = adjacency(F, n)
    labels = components(*graph)
    k = max(int(labels.max()) + 1, round(share * n))
    return Cells(graph, labels, choice.farthest(*graph, labels, k))


def case(name, share):
    V, F = MESHES[name]
    return cells_of(F, len(V), share), oracle.laplacian(F, len(V))


@pytest.mark.parametrize(("name", "share"), CASES)
def test_cells_have_the_nearest_vertices(name: str, share: float) -> None:
    cells, L = case(name, share)
    anchors = cells.anchors.tolist()
    assert cells.of.tolist() == poisson_oracle.nearest(L, anchors)
    assert cells.of[cells.anchors].tolist() == list(range(len(anchors)))
    assert cells.sizes.ravel().tolist() == [cells.of.tolist().count(k) for k in range(len(anchors))]
    parts = [set(part.tolist()) for part in poisson_oracle.parts(L)]
    alone = [a for part in parts if len(own := part & set(anchors)) == 1 for a in own]
    assert cells.shared.tolist() == [k for k, a in enumerate(anchors) if a not in alone]


@pytest.mark.parametrize(("name", "share"), CASES)
def test_sums_and_fluxes_are_products_with_the_indicators(name: str, share: float) -> None:
    cells, L = case(name, share)
    rng, k = np.random.default_rng(1), len(cells.anchors)
    indicators = np.eye(k)[cells.of]
    x, r = rng.normal(size=(len(L), 4)), rng.normal(size=(k, 4))
    np.testing.assert_allclose(cells.sums(x), indicators.T @ x, atol=1e-11)
    np.testing.assert_allclose(cells.fluxes(r), indicators.T @ L @ indicators @ r, atol=1e-11)


@pytest.mark.parametrize(("name", "share"), CASES)
def test_completed_deltas_sum_to_nothing(name: str, share: float) -> None:
    cells, L = case(name, share)
    rng, k = np.random.default_rng(2), len(cells.anchors)
    delta, y = rng.normal(size=(len(L), 3)), rng.normal(size=(k, 3))
    copies = delta.copy(), y.copy()
    found = cells.completed(delta, y)
    expected = poisson_oracle.completed(L, cells.anchors.tolist(), delta, y)
    np.testing.assert_allclose(found, expected, atol=1e-12)
    for part in poisson_oracle.parts(L):
        np.testing.assert_allclose(found[part].sum(axis=0), 0, atol=1e-11)
    np.testing.assert_array_equal((delta, y)[0], copies[0])
    np.testing.assert_array_equal(y, copies[1])


def test_what_components_have_of_their_own() -> None:
    V = MESHES["two_components"][0]
    cells, L = case("two_components", 0.1)
    x = np.random.default_rng(3).uniform(1, 2, (len(V), 1))
    for part in poisson_oracle.parts(L):
        own = np.isin(cells.anchors, part)
        assert (cells.least(x)[part] == x[part].min()).all()
        centre = cells.centres(V[cells.anchors])[part]
        np.testing.assert_allclose(centre, np.tile(V[cells.anchors[own]].mean(0), (len(part), 1)))
    alike = np.full((len(V), 1), 0.5)
    np.testing.assert_array_equal(cells.least(alike), alike)


def test_of_no_vertices_there_are_no_cells() -> None:
    nothing = np.zeros(0, dtype=np.int64)
    cells = Cells(adjacency(np.zeros((0, 3), dtype=np.int64), 0), nothing, nothing)
    assert cells.of.shape == cells.shared.shape == (0,)
    assert cells.least(np.zeros((0, 1))).shape == (0, 1)
    assert cells.sums(np.zeros((0, 3))).shape == (0, 3)
