"""Points of a grid, and ascending indices, in a stream and back."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.coding import points
from deltamesh._streams import entropy


@given(
    st.lists(st.integers(0, 5000), max_size=40, unique=True),
    st.lists(st.tuples(*[st.integers(0, 2**30 - 1)] * 3), max_size=20),
    st.lists(st.tuples(*[st.integers(0, 2**30 - 1)] * 3), max_size=20),
)
def test_points_round_trip(
    gaps: list[int], anchors: list[tuple[int, int, int]], isolated: list[tuple[int, int, int]]
) -> None:
    indices = np.array(sorted(gaps), dtype=np.int64)
    first = np.array(anchors, dtype=np.int64).reshape(-1, 3)
    second = np.array(sorted(isolated), dtype=np.int64).reshape(-1, 3)
    bits, extra = np.array([30, 30, 30]), np.arange(len(first)) % 31
    first += ((np.arange(len(first)) % 7 << extra) * (1 << 27))[:, None]
    coder = entropy.encoder(100, points.SLOTS, points.MIXERS)
    assert points.code_gaps(coder, indices.copy(), 5001)
    points.code_points(coder, first.copy(), bits, extra)
    assert points.code_sorted_points(coder, second.copy(), bits)
    decoder = entropy.decoder(entropy.finish(coder), points.SLOTS, points.MIXERS)
    out = np.zeros_like(indices), np.zeros_like(first), np.zeros_like(second)
    assert points.code_gaps(decoder, out[0], 5001)
    points.code_points(decoder, out[1], bits, extra)
    assert points.code_sorted_points(decoder, out[2], bits)
    entropy.check_end(decoder, 0)
    for decoded, given_values in zip(out, (indices, first, second), strict=True):
        np.testing.assert_array_equal(decoded, given_values)


def test_indices_outside_are_refused() -> None:
    coder = entropy.encoder(10, points.SLOTS, points.MIXERS)
    assert points.code_gaps(coder, np.array([3, 9]), 10)
    data = entropy.finish(coder)
    decoder = entropy.decoder(data, points.SLOTS, points.MIXERS)
    assert not points.code_gaps(decoder, np.zeros(2, dtype=np.int64), 9)
