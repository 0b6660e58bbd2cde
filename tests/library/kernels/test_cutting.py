"""Fans and reversed faces, against their twins."""

from __future__ import annotations

import numpy as np
import oracle
import strategies
from graphs import points_of
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.mesh import cutting
from deltamesh._shape.complexes import cut


@given(strategies.complexes())
def test_fans_are_those_of_the_oracle(mesh):
    manifold = cut(*points_of(*mesh))
    label = np.empty(3 * len(manifold.faces), dtype=np.int64)
    count = cutting.label_fans(manifold.opposite, label)
    expected = oracle.fans(manifold.opposite.tolist())
    assert label.tolist() == expected
    assert count == len(set(expected))


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9), st.booleans()), max_size=20))
def test_faces_are_turned_as_by_the_oracle(pairs):
    m = 10
    first, second = (3 * np.array([pair[i] for pair in pairs], dtype=np.int64) for i in range(2))
    twisted = np.array([pair[2] for pair in pairs], dtype=bool)
    parent, turned = np.arange(m), np.zeros(m, dtype=bool)
    cutting.orient(first, second, twisted, parent, turned)
    components, expected = oracle.orient(m, pairs)
    assert parent.tolist() == components
    assert turned.tolist() == expected
