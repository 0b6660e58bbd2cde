"""Choice of anchors: the farthest, random ones, those of the largest error."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest
from graphs import components_of, graph_of, laplacian_of

from deltamesh._geometry import anchors, greedy_anchors
from deltamesh._geometry.solve import factorization
from deltamesh._graph.adjacency import adjacency
from deltamesh._options import Settings

MESHES = meshes.every()


@pytest.mark.parametrize("k", [1, 4, 25])
@pytest.mark.parametrize("name", MESHES)
def test_farthest_equals_its_oracle(name: str, k: int) -> None:
    V, F = MESHES[name]
    labels = components_of(F, len(V))
    chosen = anchors.farthest(*adjacency(F, len(V)), labels, k)
    assert chosen.dtype == np.int64
    assert chosen.tolist() == oracle.farthest(oracle.laplacian(F, len(V)), k)


def test_every_vertex_can_be_an_anchor() -> None:
    V, F = meshes.with_isolated()
    labels = components_of(F, len(V))
    for k in (len(V), 10 * len(V)):
        assert sorted(anchors.farthest(*adjacency(F, len(V)), labels, k)) == list(range(len(V)))
        assert sorted(anchors.random(labels, k, 3)) == list(range(len(V)))
        L = laplacian_of(F, len(V))
        assert sorted(greedy_anchors.greedy(graph_of(L), V, L @ V, k)) == list(range(len(V)))


@pytest.mark.parametrize("seed", [0, 1, 0x123456789ABCDEF, 2**64 - 1])
def test_random_follows_its_definition(seed: int) -> None:
    V, F = meshes.two_components()
    labels = components_of(F, len(V))
    keys = oracle.splitmix64(seed, len(V))
    order = sorted(range(len(V)), key=lambda i: (keys[i], i))
    first = [next(i for i in order if labels[i] == c) for c in (0, 1)]
    expected = first + [i for i in order if i not in first]
    assert anchors.random(labels, 30, seed).tolist() == expected[:30]


def test_splitmix64_is_the_published_one() -> None:
    # The first outputs for seed 1234567, as in the reference implementation's test.
    expected = [6457827717110365317, 3203168211198807973, 9817491932198370423]
    assert anchors._splitmix64(1234567, 3).tolist() == expected == oracle.splitmix64(1234567, 3)


@pytest.mark.parametrize("k", [1, 6, 40])
def test_one_anchor_for_each_component_at_least(k: int) -> None:
    V, F = meshes.with_isolated()
    labels, L = components_of(F, len(V)), laplacian_of(F, len(V))
    for chosen in (
        anchors.farthest(*adjacency(F, len(V)), labels, k),
        anchors.random(labels, k, 99),
        greedy_anchors.greedy(graph_of(L), V, L @ V, k),
    ):
        assert set(labels[chosen]) == set(labels)
        assert len(set(chosen.tolist())) == len(chosen) == max(k, 5)


@pytest.mark.parametrize("step", [0.02, None], ids=["quantized", "least-squares mesh"])
@pytest.mark.parametrize("name", ["torus", "grid", "two_components"])
def test_greedy_takes_vertices_of_nearly_the_largest_error(name: str, step: float | None) -> None:
    V, F = MESHES[name]
    L = laplacian_of(F, len(V))
    delta = np.round(L @ V / step) * step if step else np.zeros_like(V)
    positions = np.round(V, 1)
    chosen = greedy_anchors.greedy(graph_of(L), V, delta, 30, positions).tolist()
    components = components_of(F, len(V)).max() + 1
    for count in range(components, 30):
        errors = oracle.greedy_errors(L.toarray(), V, delta, chosen[:count], positions)
        share = 1 if count == components else greedy_anchors.SHARE
        assert errors[chosen[count]] >= (share - 1e-9) * errors.max()


def test_greedy_across_refactoring(monkeypatch: pytest.MonkeyPatch) -> None:
    V, F = meshes.torus(12, 10)
    L = laplacian_of(F, len(V))
    once = greedy_anchors.greedy(graph_of(L), V, 0 * V, 30)
    monkeypatch.setattr(greedy_anchors, "MAX_UPDATES", 7)
    often = greedy_anchors.greedy(graph_of(L), V, 0 * V, 30)
    largest = [oracle.greedy_errors(L.toarray(), V, 0 * V, a, V).max() for a in (once, often)]
    assert largest[1] == pytest.approx(largest[0], rel=0.2)
    np.testing.assert_array_equal(once[:7], often[:7])


def test_greedy_is_the_same_for_any_number_of_threads() -> None:
    V, F = meshes.icosphere(4)
    graph = adjacency(F, len(V))
    factors = [factorization(graph, threads=threads) for threads in (1, 2)]
    one, two = (greedy_anchors.greedy(graph, V, 0 * V, 200, factor=factor) for factor in factors)
    np.testing.assert_array_equal(one, two)


@pytest.mark.parametrize(
    ("wanted", "n", "components", "expected"),
    [
        (None, 100_000, 3, 100),
        (None, 100, 1, 1),
        (0.01, 1000, 1, 10),
        (0.01, 1000, 40, 40),
        (7, 1000, 1, 7),
        (np.int32(7), 1000, 1, 7),
        (7, 5, 1, 5),
        (1, 1000, 3, 3),
    ],
)
def test_count(wanted: float | None, n: int, components: int, expected: int) -> None:
    assert anchors.count_anchors(wanted, n, components) == expected


@pytest.mark.parametrize(
    ("settings", "n", "components", "k", "expected"),
    [
        (Settings("highpass"), 50_000, 1, 1000, "greedy"),
        (Settings("highpass"), 50_001, 1, 1000, "farthest"),
        (Settings("highpass"), 50_001, 3, 3, "farthest"),
        (Settings("highpass", interpolated=True), 1000, 1, 10, "farthest"),
        (Settings("refined"), 1000, 1, 10, "farthest"),
        (Settings("refined", interpolated=True), 1000, 1, 10, "farthest"),
        (Settings("refined", anchor_method="random"), 1000, 1, 10, "random"),
        (Settings("highpass", anchor_method="greedy"), 10**6, 1, 10**5, "greedy"),
    ],
)
def test_method_of(settings: Settings, n: int, components: int, k: int, expected: str) -> None:
    assert anchors.method_of(settings, n, components, k) == expected


@pytest.mark.parametrize("wanted", [0, -1, 0.0, 1.0, 1.5, -0.1, float("nan"), True, "3"])
def test_nonsense_counts_are_refused(wanted: float) -> None:
    with pytest.raises(ValueError, match="anchors"):
        anchors.count_anchors(wanted, 100, 1)
