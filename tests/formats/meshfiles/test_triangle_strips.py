"""Triangles of strips, against a loop."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from deltamesh_formats.meshfiles.triangle_strips import triangles_of_strips


def slow_triangles(indices: list[int]) -> list[tuple[int, int, int]]:
    found, strip = [], []
    for index in [*indices, -1]:
        if index >= 0:
            strip.append(index)
            continue
        for i in range(len(strip) - 2):
            a, b, c = strip[i : i + 3]
            if len({a, b, c}) == 3:
                found.append((b, a, c) if i % 2 else (a, b, c))
        strip = []
    return found


@given(st.lists(st.integers(-1, 6), max_size=30))
def test_triangles_are_those_of_a_loop(indices: list[int]) -> None:
    found = triangles_of_strips(np.array(indices, dtype=np.int64))
    assert found.shape[1] == 3
    assert list(map(tuple, found.tolist())) == slow_triangles(indices)


def test_all_triangles_of_a_strip_face_the_same_side() -> None:
    V = np.array([[i // 2, i % 2] for i in range(8)], dtype=float)
    triangles = triangles_of_strips(np.arange(8))
    a, b, c = (V[triangles[:, i]] for i in range(3))
    u, v = b - a, c - a
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    assert len(triangles) == 6
    assert len(set(np.sign(area).tolist())) == 1
