"""Make the small mesh that the repository carries: `benchmarks/meshes/torus.ply`.

A bumpy torus, our own formula, so that no licence of a scan stands in the way of the first command
of the README. It is sampled the way a remeshed scan is, unevenly, with valences from 4 to 8: points
of a grid are moved along the surface, and each quadrilateral is cut by its shorter diagonal.

    python benchmarks/make_meshes.py [FOLDER]

writes the same bytes everywhere: the noise is a generator of our own, and coordinates are rounded
to 1e-5, which hides the last bit, where the sines of C libraries differ.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path

FOLDER = Path(__file__).parent / "meshes"
NAME = "torus.ply"

AROUND, ACROSS = 72, 36  # samples along the large and along the small circle: 2,592 vertices
JITTER = 0.6  # how far a sample moves, in cells of the grid
SEED = 20030623

Point = tuple[float, float, float]


def noise(seed: int) -> Iterator[float]:
    """Yield numbers in [-0.5, 0.5): MINSTD, Park and Miller 1988, whose period is 2^31 - 2."""
    state = seed
    while True:
        state = state * 48271 % 2147483647
        yield state / 2147483647 - 0.5


def surface(u: float, v: float) -> Point:
    """Return the point of the bumpy torus at the angles u (large circle) and v (small circle)."""
    radius = 0.42 + 0.06 * math.sin(3 * u + 1) * math.cos(2 * v) + 0.03 * math.sin(5 * v + 2 * u)
    ring = 1 + 0.08 * math.cos(2 * u) + radius * math.cos(v)
    return ring * math.cos(u), ring * math.sin(u), radius * math.sin(v) + 0.12 * math.sin(2 * u)


def vertices() -> list[Point]:
    """Return AROUND * ACROSS points, row by row, moved off their grid and denser on one side."""
    random = noise(SEED)
    points = []
    for i in range(AROUND):
        for j in range(ACROSS):
            u = 2 * math.pi * (i + JITTER * next(random)) / AROUND
            v = 2 * math.pi * (j + JITTER * next(random)) / ACROSS
            points.append(surface(u + 0.3 * math.sin(u), v + 0.35 * math.sin(v)))
    return points


def faces(points: list[Point]) -> list[tuple[int, int, int]]:
    """Return the triangles, counter-clockwise from outside; the shorter diagonal cuts each cell."""
    triangles = []
    for i in range(AROUND):
        for j in range(ACROSS):
            below, above = i * ACROSS, (i + 1) % AROUND * ACROSS
            right = (j + 1) % ACROSS
            a, b, c, d = below + j, above + j, above + right, below + right
            if math.dist(points[a], points[c]) <= math.dist(points[b], points[d]):
                triangles += [(a, b, c), (a, c, d)]
            else:
                triangles += [(a, b, d), (b, c, d)]
    return triangles


def ply() -> str:
    """Return the mesh as an ASCII PLY file."""
    points = vertices()
    triangles = faces(points)
    header = [
        "ply",
        "format ascii 1.0",
        "comment made by benchmarks/make_meshes.py",
        f"element vertex {len(points)}",
        *(f"property float {axis}" for axis in "xyz"),
        f"element face {len(triangles)}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    lines = [f"{x:.5f} {y:.5f} {z:.5f}" for x, y, z in points]
    lines += [f"3 {a} {b} {c}" for a, b, c in triangles]
    return "\n".join([*header, *lines, ""])


def main() -> None:
    """Write the mesh into the folder of the command line, by default the repository's."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    (folder / NAME).write_bytes(ply().encode("ascii"))


if __name__ == "__main__":
    main()
