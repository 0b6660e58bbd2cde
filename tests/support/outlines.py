"""Simple polygons of many forms in the plane, turned to the left, with holes over bridges too."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

U = ((0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3))
H = (
    *((0, 0), (1, 0), (1, 1), (2, 1), (2, 0), (3, 0)),
    *((3, 3), (2, 3), (2, 2), (1, 2), (1, 3), (0, 3)),
)
KEYHOLE = (
    *((0, 0), (4, 0), (4, 4), (0, 4), (0, 0)),
    *((1, 1), (1, 3), (3, 3), (3, 1), (1, 1)),
)
# Both holes hang on the first corner, the right one on the bridge's right.
TWO_HOLES = (
    *((0, 0), (9, 0), (9, 9), (0, 9), (0, 0)),
    *((1, 4), (1, 7), (2, 5), (1, 4), (0, 0)),
    *((4, 1), (5, 3), (7, 1), (4, 1)),
)


def pacman(corners: int) -> np.ndarray:
    angle = np.linspace(np.pi / 6, 2 * np.pi - np.pi / 6, corners - 1)
    return np.append(np.stack([np.cos(angle), np.sin(angle)], axis=1), [[0, 0]], axis=0)


def star(radii: np.ndarray) -> np.ndarray:
    """Corners all around the origin, as far from it as `radii` has them."""
    angle = 2 * np.pi * np.arange(len(radii)) / len(radii)
    return radii[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def comb(teeth: int, depth: float) -> np.ndarray:
    """Teeth of width 1, 1 apart, on a back of height 1."""
    x = np.repeat(np.arange(2 * teeth - 1, -1, -1), 2)
    y = np.tile([1, 1 + depth, 1 + depth, 1], teeth)
    points = np.stack([x, y], axis=1)[1:-1]
    ends = [(0, 0), (2 * teeth - 1, 0)]
    return np.concatenate([ends, points]).astype(float)


def spiral(corners: int, turns: float) -> np.ndarray:
    """A corridor around a middle, away from it along the outer wall and back along the inner."""
    angle = 2 * np.pi * turns * np.linspace(0, 1, corners // 2)[:, None]
    wall = np.concatenate([np.cos(angle), np.sin(angle)], axis=1)
    radius = 1 + angle / (2 * np.pi)
    return np.concatenate([(radius + 0.4) * wall, (radius * wall)[::-1]])


def untangled(points: np.ndarray) -> np.ndarray:
    """A tour of points in general position: parts are turned around until no edges cross."""
    while True:
        after = np.roll(points, -1, axis=0)
        crossing = np.argwhere(np.triu(_cross(points, after, points, after), 2))
        if not len(crossing):
            return points if area(points) > 0 else points[::-1]
        i, j = crossing[len(crossing) // 2]
        points = np.concatenate([points[: i + 1], points[j:i:-1], points[j + 1 :]])


def with_holes(rng: np.random.Generator, across: int) -> np.ndarray:
    """A square board with a hole in most of its cells, each joined over the shortest bridge."""
    outline = np.array([(0, 0), (across, 0), (across, across), (0, across)], dtype=float)
    holes = []
    for cell in rng.permutation(across**2)[: max(across**2 - 1, 1)]:
        ring = star(rng.uniform(0.1, 0.4, size=rng.integers(3, 12)))[::-1]
        holes.append(ring + np.array([cell % across + 0.5, cell // across + 0.5]))
    while holes:
        outline = _joined(outline, holes)
    return outline


def _joined(outline: np.ndarray, holes: list[np.ndarray]) -> np.ndarray:
    """The outline with one hole more, which is taken out of `holes`."""
    rings = [outline, *holes]
    begin = np.concatenate(rings)
    end = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    # A corner where a bridge ends already has two sides, of which only one would be right.
    once = np.unique(outline, axis=0, return_inverse=True, return_counts=True)[1:]
    free = np.flatnonzero(once[1][once[0].ravel()] == 1)
    hole = np.concatenate(holes)
    far = np.linalg.norm(outline[free, None] - hole[None], axis=2)
    for at in np.argsort(far, axis=None):
        i, j = np.unravel_index(at, far.shape)
        if not _cross(outline[free[i]][None], hole[j][None], begin, end).any():
            break
    owner = np.repeat(np.arange(len(holes)), [len(ring) for ring in holes])[j]
    j -= sum(len(ring) for ring in holes[:owner])
    ring = np.roll(holes.pop(owner), -j, axis=0)
    i = free[i]
    return np.concatenate([outline[: i + 1], ring, ring[:1], outline[i:]])


def _cross(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Whether each segment from a to b crosses each one from c to d, not only at its ends."""

    def side(p, q, r):
        return (q - p)[..., 0] * (r - p)[..., 1] - (q - p)[..., 1] * (r - p)[..., 0]

    a, b, c, d = a[:, None], b[:, None], c[None], d[None]
    return (side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)


def area(points: np.ndarray) -> float:
    """The area by the shoelace formula, exact but for the last rounding."""
    exact = [(Fraction(float(x)), Fraction(float(y))) for x, y in points]
    pairs = zip(exact, exact[1:] + exact[:1], strict=True)
    return float(sum(a[0] * b[1] - a[1] * b[0] for a, b in pairs) / 2)


def with_middles(points: np.ndarray) -> np.ndarray:
    """A corner more in the middle of each edge, in line but for rounding."""
    middles = (points + np.roll(points, -1, axis=0)) / 2
    return np.stack([points, middles], axis=1).reshape(-1, 2)


def random_outline(rng: np.random.Generator, corners: int) -> np.ndarray:
    """A simple polygon of about so many corners, eight at least."""
    kinds = {
        "star": lambda: star(rng.uniform(0.05, 1, size=corners)),
        "spikes": lambda: star(10 ** rng.uniform(-3, 0, size=corners)),
        "comb": lambda: comb(corners // 4, 10 ** rng.uniform(-1, 2)),
        "spiral": lambda: spiral(corners, rng.uniform(0.1, min(corners / 16, 6))),
        "untangled": lambda: untangled(rng.normal(size=(corners, 2))),
        "holes": lambda: with_holes(rng, max(math.isqrt(corners // 9), 1)),
        "pacman": lambda: pacman(corners),
    }
    points = kinds[rng.choice(list(kinds))]()
    return with_middles(points) if rng.random() < 0.2 else points


def in_space(rng: np.random.Generator, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The points in some plane in space, float64 (n, 3), and its unit normal."""
    basis = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return points @ basis[:2] + rng.normal(size=3), np.cross(basis[0], basis[1])
