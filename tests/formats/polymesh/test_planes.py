"""Polygons in their planes: neither the first corner nor the plane decides anything."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh_formats.polymesh.planes import following, in_planes, starts

points = st.tuples(*[st.integers(0, 2)] * 3)
polygons = st.lists(st.lists(points, min_size=3, max_size=8), min_size=1, max_size=5)


def flat(rows: list[list[tuple[int, ...]]]) -> tuple[np.ndarray, np.ndarray]:
    at = np.array([point for row in rows for point in row], dtype=float)
    return at, np.cumsum([0, *map(len, rows)])


@given(polygons)
def test_a_polygon_starts_its_least_sequence(rows: list[list[tuple[int, ...]]]) -> None:
    for row, start in zip(rows, starts(*flat(rows)).tolist(), strict=True):
        sequences = [row[i:] + row[:i] for i in range(len(row))]
        assert sequences[start] == min(sequences)


@given(polygons)
def test_the_corner_after_is_in_the_same_polygon(rows: list[list[tuple[int, ...]]]) -> None:
    at, offsets = flat(rows)
    after = at[following(offsets)].tolist()
    expected = [list(map(float, p)) for row in rows for p in (*row[1:], row[0])]
    assert after == expected


def area(x: np.ndarray, y: np.ndarray) -> float:
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) / 2


@given(st.integers(0, 10**6), st.integers(3, 9), st.sampled_from([1e-150, 1.0, 1e100]))
def test_a_polygon_turns_to_the_left_in_its_plane(seed: int, size: int, unit: float) -> None:
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.random(size)) * 2 * np.pi
    ring = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    x, y, has_plane = in_planes(unit * (ring @ turn.T + rng.normal(size=3)), np.array([0, size]))
    if has_plane[0]:  # but for slivers
        assert area(x, y) > 0
    assert np.abs([x, y]).max() <= 2


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [1, -1])
def test_coordinates_at_right_angles_to_an_axis_are_not_rounded(axis: int, sign: int) -> None:
    square = np.array([[0.1, 0.2], [0.7, 0.2], [0.7, 0.9], [0.1, 0.9]])[::sign]
    at = np.insert(square, axis, 5.0, axis=1)
    x, y, has_plane = in_planes(at, np.array([0, 4]))
    assert has_plane.all()
    assert area(x, y) == pytest.approx(0.42)
    exact = {*np.abs(square - square[0]).ravel().tolist()}
    assert {*np.abs(x).tolist(), *np.abs(y).tolist()} <= exact


def test_polygons_without_an_area_have_no_plane() -> None:
    line = np.array([[0.0, 0, 0], [1, 1, 1], [2, 2, 2]])
    bad = np.array([[0.0, 0, 0], [1, 0, 0], [0, np.nan, 0]])
    good = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    _, _, has_plane = in_planes(np.concatenate([line, bad, good]), np.array([0, 3, 6, 9]))
    assert has_plane.tolist() == [False, False, True]
