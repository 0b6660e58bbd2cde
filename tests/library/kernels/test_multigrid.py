"""Multigrid: its levels against dense matrices, and its solves against direct ones."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import oracle
import poisson_oracle
import pytest
from sparse_matrices import GRAPHS

from deltamesh._geometry.poisson import Poisson
from deltamesh._graph.adjacency import adjacency, adjacency_between
from deltamesh._kernels.mesh import multigrid
from deltamesh._kernels.mesh.multigrid import BLOCK, COORDINATES, MAX_DENSE, Hierarchy, Level
from deltamesh_formats.array_types import Ints

MESHES = meshes.every()
SMALL = {name: matrix for name, matrix in GRAPHS.items() if 0 < matrix.shape[0] <= 300}
RNG = np.random.default_rng(1957)


def laplacian_matrix(matrix):
    """The dense Laplacian of the graph of a sparse matrix."""
    A = (matrix.toarray() != 0).astype(float)
    np.fill_diagonal(A, 0)
    return np.diag(A.sum(axis=1)) - A


LAPLACIANS = {name: laplacian_matrix(matrix) for name, matrix in SMALL.items()} | {
    f"mesh {name}": oracle.laplacian(F, len(V)) for name, (V, F) in MESHES.items()
}


def finest(L, fixed) -> Level:
    """The finest level of a dense Laplacian."""
    n, A = len(L), (L != 0) & ~np.eye(len(L), dtype=bool)
    indptr = np.concatenate([[0], np.cumsum(A.sum(axis=1))]).astype(np.int32)
    free = A.any(axis=1)
    free[fixed] = False
    diagonal = np.diag(L).astype(np.float32)
    inverse = np.where(free, 1 / np.maximum(diagonal, 1), 0).astype(np.float32)
    none = np.full(n, -1, dtype=np.int32)
    shorts = np.nonzero(A)[1].astype(np.int32)
    return Level(indptr, shorts, np.zeros(0, np.float32), diagonal, inverse, none)


def some_fixed(n: int, k: int) -> Ints:
    return np.sort(RNG.permutation(n)[:k])


@pytest.mark.parametrize("name", LAPLACIANS)
@pytest.mark.parametrize("share", [0.0, 0.02, 0.5, 1.0])
def test_levels_are_those_of_dense_matrices(name: str, share: float) -> None:
    matrix = LAPLACIANS[name]
    lowest = [part[0] for part in poisson_oracle.parts(matrix)]
    fixed = np.union1d(lowest, some_fixed(len(matrix), round(share * len(matrix))))
    level = finest(matrix, fixed)
    for _ in range(9):
        of, count = multigrid.aggregate(level.indptr, level.indices, level.inverse)
        free = level.inverse != 0
        rows = np.split(level.indices, level.indptr[1:-1])
        assert (of.tolist(), count) == poisson_oracle.aggregates(rows, free)
        assert (np.bincount(of[of >= 0], minlength=count) >= 2).all()
        assert (of[~free] == -1).all()
        level.aggregate[:] = of
        if not count:
            break
        matrix = poisson_oracle.coarsened(matrix, of, count)
        level = multigrid.coarsen(level, count)
        np.testing.assert_allclose(level.matrix(), matrix, atol=1e-4)
        np.testing.assert_allclose(level.inverse, 1 / np.diag(matrix), rtol=1e-5)
        for i in range(count):
            row = level.indices[level.indptr[i] : level.indptr[i + 1]]
            assert len(np.unique(row)) == len(row)
            assert i not in row
        assert (level.aggregate == -1).all()


@pytest.mark.parametrize("name", LAPLACIANS)
@pytest.mark.parametrize("block", [1, 2, 7, 40])
def test_aggregates_stay_within_blocks(name: str, block: int) -> None:
    level = finest(LAPLACIANS[name], some_fixed(len(LAPLACIANS[name]), 3))
    rows = [row.tolist() for row in np.split(level.indices, level.indptr[1:-1])]
    of, count = multigrid.aggregate(level.indptr, level.indices, level.inverse, block)
    within = poisson_oracle.within_blocks(rows, block)
    assert (of.tolist(), count) == poisson_oracle.aggregates(within, level.inverse != 0)


def test_blocks_are_of_many_rows_unless_these_are_not_apart() -> None:
    n = BLOCK + 100
    chain = np.stack((np.arange(n - 1), np.arange(1, n)))
    assert multigrid.choose_block(*adjacency_between(*chain, n)) == BLOCK
    star = np.stack((np.full(n - 1, BLOCK), np.delete(np.arange(n), BLOCK)))
    assert multigrid.choose_block(*adjacency_between(*star, n)) == n
    few = np.concatenate([chain, star[:, : n // 10]], axis=1)
    assert multigrid.choose_block(*adjacency_between(*few, n)) == BLOCK
    assert multigrid.choose_block(*adjacency_between(*star[:, :0], 0)) == BLOCK


@pytest.mark.parametrize("n", [0, 1, 2, 30, MAX_DENSE])
def test_dense_factors(n: int) -> None:
    root = RNG.normal(size=(n, n))
    matrix = root @ root.T + n * np.eye(n)
    before = matrix.copy()
    found = np.tril(multigrid.factor_dense(matrix))
    np.testing.assert_allclose(found, poisson_oracle.factor(matrix), atol=1e-12 * (n + 1))
    np.testing.assert_array_equal(matrix, before)


def test_a_pivot_that_rounding_has_made_too_small_is_kept_above_0() -> None:
    L = oracle.laplacian(MESHES["icosphere"][1], len(MESHES["icosphere"][0]))
    found = np.tril(multigrid.factor_dense(L))
    assert np.isfinite(found).all()
    assert (np.diag(found) > 0).all()
    np.testing.assert_allclose(found @ found.T, L, atol=1e-9)


@pytest.mark.parametrize("wrong", [0.0, -1.0, np.nan])
def test_matrices_that_are_not_positive_are_refused(wrong: float) -> None:
    with pytest.raises(ValueError, match="contradict"):
        multigrid.factor_dense(np.diag([1.0, wrong, 1.0]))


def hierarchy_of(L, fixed, block=None) -> Hierarchy:
    """Two levels: the coarse one is solved by a dense factor."""
    level = finest(L, fixed)
    of, count = multigrid.aggregate(level.indptr, level.indices, level.inverse, block)
    level.aggregate[:] = of
    levels = [level, multigrid.coarsen(level, count)] if count else [level]
    return Hierarchy(levels, block or len(L))


TWO_LEVELS = [name for name, L in LAPLACIANS.items() if len(poisson_oracle.parts(L)) == 1]


@pytest.mark.parametrize("name", TWO_LEVELS)
@pytest.mark.parametrize("block", [1, 9, 64, 1000])
@pytest.mark.parametrize("threads", [1, 3])
def test_a_few_iterations_are_those_of_dense_matrices(name: str, block: int, threads: int) -> None:
    L, fixed = LAPLACIANS[name], np.array([len(LAPLACIANS[name]) // 2])
    n, level = len(L), finest(L, fixed)
    free = np.setdiff1d(np.arange(n), fixed)
    of, count = multigrid.aggregate(level.indptr, level.indices, level.inverse, block)
    if not len(free) or count > MAX_DENSE:
        return
    # The dense twin has all nodes, so that blocks are the same: the fixed one is alone, at 0.
    matrix = np.diag(np.diag(L))
    matrix[np.ix_(free, free)] = L[np.ix_(free, free)]
    b, none = L @ RNG.normal(size=(n, COORDINATES)), np.zeros((n, COORDINATES))
    b[fixed] = 0
    for most in (1, 3):
        x = none.copy()
        hierarchy_of(L, fixed, block).solve(b, x, 0.0, most, threads)
        expected = poisson_oracle.descended(matrix, of, count, b, none, block, most)
        np.testing.assert_allclose(x, expected, atol=2e-4 * np.abs(expected).max())


@pytest.mark.parametrize("threads", [2, 3, 9])
def test_the_result_does_not_depend_on_threads(threads: int) -> None:
    n = 3 * BLOCK + 7
    faces = np.array([(i, i + 1, i + 2) for i in range(n - 2)])
    graph = adjacency(faces, n)
    fixed = np.arange(0, n, 200)
    b, start = RNG.normal(size=(n, COORDINATES)), np.zeros((n, COORDINATES))
    results = []
    for each in (1, threads):
        x = start.copy()
        found = Poisson(graph, fixed, each).solve(b, x, 1e-6)
        results.append((found, x.tobytes()))
    assert results[0] == results[1]


@pytest.mark.parametrize("name", LAPLACIANS)
def test_a_solve_ends_within_its_bound(name: str) -> None:
    L = LAPLACIANS[name]
    n = len(L)
    parts = poisson_oracle.parts(L)
    fixed = np.array([RNG.choice(part) for part in parts])
    free = np.setdiff1d(np.arange(n), fixed)
    if not len(free):
        return
    hierarchy, expected = hierarchy_of(L, fixed), RNG.normal(size=(n, COORDINATES))
    inverse = np.linalg.inv(L[np.ix_(free, free)])
    for tolerance in (1e-1, 1e-5, 1e-9):
        b, x = L @ expected, np.zeros((n, COORDINATES))
        x[fixed] = expected[fixed]
        bound, iterations = hierarchy.solve(b, x, tolerance, 1000)
        error = np.abs(x - expected).max()
        assert error <= bound * (1 + 1e-6)
        assert bound <= tolerance
        assert 0 < iterations < 60
        assert hierarchy.barrier >= np.abs(inverse).sum(axis=1).max() * (1 - 1e-9)
        np.testing.assert_array_equal(x[fixed], expected[fixed])


def test_after_so_many_iterations_it_ends() -> None:
    L = LAPLACIANS["mesh torus"]
    hierarchy, expected = hierarchy_of(L, np.array([0])), RNG.normal(size=(len(L), COORDINATES))
    errors = []
    for most in (0, 3, 9):
        b, x = L @ expected, np.zeros((len(L), COORDINATES))
        x[0] = expected[0]
        bound, iterations = hierarchy.solve(b, x, 0.0, most)
        assert bound == np.inf
        assert iterations == most
        errors.append(np.abs(x - expected).max())
    assert errors[0] > 2 * errors[1] > 4 * errors[2]


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_of_what_is_no_number_no_error_is_bounded(wrong: float) -> None:
    L = LAPLACIANS["mesh torus"]
    b, x = np.ones((len(L), COORDINATES)), np.zeros((len(L), COORDINATES))
    b[7, 1] = wrong
    bound, _ = hierarchy_of(L, np.array([0])).solve(b, x, 1e-3, 50)
    assert bound == np.inf


LEVEL = finest(LAPLACIANS["mesh torus"], np.array([3]))
ENTRIES = len(LEVEL.indices)


def changed(array, at, value):
    array = array.copy()
    array[at] = value
    return array


@pytest.mark.parametrize(
    "changes",
    [
        {"indptr": changed(LEVEL.indptr, 0, 1)},
        {"indptr": changed(LEVEL.indptr, -1, ENTRIES - 1)},
        {"indptr": changed(LEVEL.indptr, 4, ENTRIES)},
        {"indices": changed(LEVEL.indices, 2, LEVEL.nodes)},
        {"indices": changed(LEVEL.indices, 2, -1)},
    ],
    ids=["begin", "end", "order", "too large", "too small"],
)
def test_graphs_that_are_none_are_refused(changes) -> None:
    wrong = replace(LEVEL, **changes)
    with pytest.raises(ValueError, match="contradict"):
        multigrid.aggregate(wrong.indptr, wrong.indices, wrong.inverse)
    with pytest.raises(ValueError, match="contradict"):
        multigrid.coarsen(wrong, 1)
    rows = np.zeros((LEVEL.nodes, COORDINATES))
    with pytest.raises(ValueError, match="contradict"):
        Hierarchy([wrong]).solve(rows, rows.copy(), 1.0, 1)


def test_aggregates_that_are_none_are_refused() -> None:
    of, count = multigrid.aggregate(LEVEL.indptr, LEVEL.indices, LEVEL.inverse)
    good = replace(LEVEL, aggregate=of)
    coarse = multigrid.coarsen(good, count)
    bad = replace(LEVEL, aggregate=changed(of, 5, count))
    with pytest.raises(ValueError, match="contradict"):
        multigrid.coarsen(bad, count)
    for wrong in (-1, LEVEL.nodes + 1):
        with pytest.raises(ValueError):  # noqa: PT011  # numpy's own, or the core's
            multigrid.coarsen(good, wrong)
    rows = np.zeros((LEVEL.nodes, COORDINATES))
    with pytest.raises(ValueError, match="contradict"):
        Hierarchy([bad, coarse]).solve(rows, rows.copy(), 1.0, 1)


def test_more_levels_than_there_may_be_are_refused() -> None:
    rows = np.zeros((LEVEL.nodes, COORDINATES))
    levels = [LEVEL] + [replace(LEVEL, weights=np.ones(ENTRIES, np.float32))] * multigrid.MAX_LEVELS
    with pytest.raises(ValueError, match="contradict"):
        Hierarchy(levels).solve(rows, rows.copy(), 1.0, 1)


def test_arrays_of_other_sizes_are_refused() -> None:
    with pytest.raises(ValueError):  # noqa: PT011
        multigrid.aggregate(LEVEL.indptr, LEVEL.indices, LEVEL.inverse[:-1])
    for rows in (
        np.zeros((LEVEL.nodes, COORDINATES - 1)),
        np.zeros((LEVEL.nodes - 1, COORDINATES)),
    ):
        with pytest.raises(ValueError):  # noqa: PT011
            Hierarchy([LEVEL]).solve(rows, rows.copy(), 1.0, 1)


@pytest.mark.parametrize("name", MESHES)
def test_a_mesh_has_the_levels_of_its_graph(name: str) -> None:
    """The dense matrices of these tests are those of the codec's own neighbour lists."""
    V, F = MESHES[name]
    indptr, indices = adjacency(F, len(V))
    level = finest(LAPLACIANS[f"mesh {name}"], [])
    np.testing.assert_array_equal(level.indptr, indptr)
    np.testing.assert_array_equal(level.indices, indices)


def test_numbers_that_overflow_end_the_iterations() -> None:
    level = finest(LAPLACIANS[f"mesh {next(iter(MESHES))}"], [0])
    rows = np.full((level.nodes, COORDINATES), 1e300)
    bound, iterations = Hierarchy([level]).solve(rows, np.zeros_like(rows), 1e-3, 1000)
    assert bound == np.inf
    assert iterations <= 2
