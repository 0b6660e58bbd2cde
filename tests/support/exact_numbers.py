"""hypothesis strategies: numbers of many kinds, and positions made of them."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from deltamesh._mesh import LARGEST

doubles = st.floats(-LARGEST, LARGEST)
singles = st.floats(-(2.0**100), 2.0**100, width=32)
decimals = st.builds(lambda m, k: m / 10**k, st.integers(-(10**7), 10**7), st.integers(0, 9))
dyadics = st.builds(lambda m, k: m / 2.0**k, st.integers(-(2**20), 2**20), st.integers(-40, 40))
extremes = st.sampled_from(
    [0.0, -0.0, 5e-324, -5e-324, 2.2250738585072014e-308, 1e150, -1e150, 1e-45]
)
numbers = st.sampled_from([doubles, singles, decimals, dyadics, extremes])


@st.composite
def positions(draw: st.DrawFn, count: int) -> np.ndarray:
    """Numbers of one kind or of several, all positions different."""
    kinds = draw(st.lists(numbers, min_size=1, max_size=3))
    rows = st.tuples(*[st.one_of(kinds)] * 3)
    bits = lambda row: np.array(row).tobytes()  # noqa: E731
    found = draw(st.lists(rows, min_size=count, max_size=count, unique_by=bits))
    return np.array(found)
