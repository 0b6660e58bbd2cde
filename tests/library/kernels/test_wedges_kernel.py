"""Corners around a vertex in the order of their fans, and numbers of isolated vertices."""

from __future__ import annotations

import meshes
import numpy as np
import polygon_oracle
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._kernels.coding import wedges as kernels
from deltamesh._kernels.coding.models import Model
from deltamesh._streams.entropy import check_end, decoder, encode_with, encoder

MODEL = Model(kernels.SLOTS, kernels.MIXERS)


@given(strategies.surfaces())
def test_corners_are_visited_fan_after_fan(mesh: meshes.Arrays) -> None:
    used, F = np.unique(mesh[1], return_inverse=True)
    F = F.reshape(-1, 3)
    opposite, n = pair_halfedges(F), len(used)
    ring, spoke, closing = (np.empty(F.size, dtype=np.int64) for _ in range(3))
    kernels.fill_rings(opposite, F.ravel(), np.arange(n), ring, spoke, closing)
    assert sorted(ring.tolist()) == list(range(F.size))
    at = F.ravel()[ring]
    assert (np.diff(at) >= 0).all()
    first = np.concatenate(([True], at[1:] != at[:-1]))
    assert ((spoke < 0) == first).all()
    for k in np.flatnonzero(~first):
        # Across the spoke, the edge of the corner before, lies this one.
        assert spoke[k] == ring[k - 1]
        assert ring[k] == polygon_oracle.after(opposite[spoke[k]])
    before = np.array([polygon_oracle.before(h) for h in ring.tolist()])
    # Where a fan is closed, it ends across the edge before its first corner.
    sizes = np.diff(np.append(np.flatnonzero(first), len(ring)))
    assert closing.tolist() == np.repeat(opposite[before[first]], sizes).tolist()
    assert (opposite[before[~first]] >= 0).all()


@given(st.lists(st.integers(0, 3) | st.just(0) | st.integers(0, 30), min_size=1, max_size=30))
def test_numbers_of_isolated_vertices_come_back(numbers: list[int]) -> None:
    isolated, total = np.array(numbers), sum(numbers)
    data = encode_with(
        MODEL, 1000, lambda coder: kernels.code_isolated(coder, isolated.copy(), total)
    )
    coder, out = decoder(data, *MODEL), np.zeros_like(isolated)
    assert kernels.code_isolated(coder, out, total)
    check_end(coder, 0)
    assert out.tolist() == numbers
    # One more than there are is noticed: whatever follows in the stream, it is not there.
    more = encode_with(
        MODEL, 1000, lambda coder: kernels.code_isolated(coder, isolated.copy(), total + 1)
    )
    assert not kernels.code_isolated(decoder(more, *MODEL), out, total + 1)


@pytest.mark.parametrize(
    ("bounds", "ring"),
    [
        ([0, 1, 2, 3], [0, 1, 1]),  # a corner that comes twice, and one that never does
        ([0, 1, 2, 3], [0, 1, 3]),
        ([], [0, 1, 2]),
        ([0, 2, 1, 3], [0, 1, 2]),
    ],
)
def test_corners_that_are_not_in_rings_are_refused(bounds: list[int], ring: list[int]) -> None:
    edges, kind = np.full(3, -1), np.full(3, kernels.FAN)
    corners = np.array(bounds, dtype=np.int64), np.array(ring), edges, edges, edges, kind
    with pytest.raises(ValueError, match="dm_code_wedges"):
        kernels.code_wedges(encoder(3, *MODEL), edges, *corners, np.zeros(3, np.int64), 1)
