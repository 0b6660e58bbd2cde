"""Large irregular surfaces: what encoding and decoding take as they grow, and Draco beside them.

The surface is the same at any size: a sphere, displaced by octaves of waves, sampled at more and
more points. The points lie in a spiral of equal areas and are moved along the sphere, so that their
Delaunay triangulation has valences from 3 to 10; and each is moved a little in space, as a scanner
would, by a share of the length of an edge.
"""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import click
import corpus
import numpy as np
from processes import Usage, deltamesh, python

from deltamesh._mesh import TriangleMesh
from deltamesh_cli.output import table
from deltamesh_formats.array_types import Floats
from deltamesh_formats.meshfiles.files import write_mesh

_EXAMPLES = """\
python benchmarks/large.py
python benchmarks/large.py 2600 41000 164000 655000
python benchmarks/large.py 1300000 5000000 10000000 --folder /tmp/large"""

SIZES = (2_600, 41_000, 164_000)
# Moves along the sphere and in space, as shares of the length of an edge.
JITTER = 0.22
NOISE = 0.004
OCTAVES = 9
WAVES = 3  # in each octave
FIRST_FREQUENCY, FREQUENCIES = 1.3, 1.9
FIRST_AMPLITUDE, AMPLITUDES = 0.28, 0.5
SEED = 20030623
LEAST = 20  # vertices: a surface around the origin

# Scripts of Draco's processes, which read and write arrays as those of deltamesh do files.
_DRACO_ENCODE = """\
import sys, numpy, DracoPy
mesh = numpy.load(sys.argv[1])
data = DracoPy.encode(mesh["V"], mesh["F"], quantization_bits=11, compression_level=10)
open(sys.argv[2], "wb").write(data)"""
_DRACO_DECODE = """\
import sys, numpy, DracoPy
mesh = DracoPy.decode(open(sys.argv[1], "rb").read())
numpy.savez(sys.argv[2], V=mesh.points, F=mesh.faces)"""

_HEADING = ("vertices", "", "bytes", "CPU s", "wall s", "us/vertex", "B/vertex", "growth", "load")


class Row(NamedTuple):
    """Measurement of one process.

    Attributes
    ----------
    vertices : int
    process : str
    size : int
        Bytes of the encoded file.
    usage : Usage
    load : float
        Mean number of processes that waited for a core in the minute before.
    """

    vertices: int
    process: str
    size: int
    usage: Usage
    load: float


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.argument("sizes", type=click.IntRange(LEAST), nargs=-1)
@click.option("--quick", is_flag=True, help="Measure a surface of 1000 vertices only.")
@click.option(
    "--folder",
    type=click.Path(path_type=Path, file_okay=False),
    help="Keep the meshes there, and measure those that are there already.",
)
def command(sizes: tuple[int, ...], quick: bool, folder: Path | None) -> None:
    """Measure `deltamesh encode` and `decode`, and Draco, on surfaces of SIZES vertices.

    Draco has 11 bits and compression level 10 (extra `bench`). All are whole processes, start-up
    included; growth is the exponent from one size to the next of the CPU seconds above those of 20
    vertices. Making a surface takes 700 bytes a vertex.
    """
    chosen = sorted(sizes or ((1000,) if quick else SIZES))
    with tempfile.TemporaryDirectory() as temporary:
        kept = Path(temporary) if folder is None else folder
        kept.mkdir(parents=True, exist_ok=True)
        found = [measured(n, kept, Path(temporary)) for n in (LEAST, *chosen)]
    click.echo(table([_HEADING, *(row for rows in described(found) for row in rows)]))


def measured(n: int, folder: Path, scratch: Path) -> list[Row]:
    """Return the rows of the surface of n vertices, which is made unless the folder has it."""
    mesh, arrays = folder / f"large-{n}.ply", folder / f"large-{n}.npz"
    if not (mesh.is_file() and arrays.is_file()):
        made = surface(n)
        write_mesh(mesh, replace(corpus.as_polymesh(made), precision="float32"))
        np.savez(arrays, V=made.vertices.astype(np.float32), F=made.faces.astype(np.uint32))
        del made
    coded, draco, out = scratch / "a.dmesh", scratch / "a.drc", scratch / "out.ply"
    runs: tuple[tuple[str, Path, Callable[[], Usage]], ...] = (
        ("encode", coded, lambda: deltamesh("encode", mesh, coded, "-f", "-q")),
        ("decode", coded, lambda: deltamesh("decode", coded, out, "-f", "-q")),
        ("Draco encode", draco, lambda: python("-c", _DRACO_ENCODE, arrays, draco)),
        ("Draco decode", draco, lambda: python("-c", _DRACO_DECODE, draco, scratch / "out.npz")),
    )
    rows = []
    for process, file, run in runs:
        usage = run()
        rows.append(Row(n, process, file.stat().st_size, usage, os.getloadavg()[0]))
    return rows


def described(found: list[list[Row]]) -> list[list[tuple[str, ...]]]:
    """Return the rows of the table, for all surfaces but the first, which is the start-up."""
    start_up = [row.usage.cpu for row in found[0]]
    growths = [[""] * len(start_up)]
    for before, after in pairwise(found[1:]):
        growths.append([growth(*pair) for pair in zip(before, after, start_up, strict=True)])
    return [
        [_described(*pair) for pair in zip(rows, growth_of_rows, strict=True)]
        for rows, growth_of_rows in zip(found[1:], growths, strict=True)
    ]


def growth(before: Row, after: Row, start_up: float) -> str:
    """Return the exponent with which CPU seconds grow, or nothing within those of the start-up."""
    first, second = (row.usage.cpu - start_up for row in (before, after))
    if first <= 0 or second <= 0 or before.vertices == after.vertices:
        return ""
    return f"{math.log(second / first) / math.log(after.vertices / before.vertices):.2f}"


def _described(row: Row, growth_of_row: str) -> tuple[str, ...]:
    usage, n = row.usage, row.vertices
    return (
        str(n),
        row.process,
        str(row.size),
        f"{usage.cpu:.2f}",
        f"{usage.seconds:.2f}",
        f"{usage.cpu / n * 1e6:.1f}",
        f"{usage.peak / n:.0f}",
        growth_of_row,
        f"{row.load:.1f}",
    )


def surface(n: int) -> TriangleMesh:
    """Return a closed irregular surface of n vertices, whose positions single precision has."""
    from scipy.spatial import ConvexHull

    random = np.random.default_rng(SEED)
    edge = math.sqrt(8 * math.pi / (math.sqrt(3) * n))
    points = _spiral(n)
    points += random.normal(size=points.shape) * (JITTER * edge)
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    # The Delaunay triangulation of points on a sphere is their convex hull.
    faces = ConvexHull(points).simplices.astype(np.int64)
    if len(faces) != 2 * n - 4:
        raise ValueError(f"{n} points make {len(faces)} triangles: two of them are the same")
    a, b, c = (points[faces[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    faces[inward] = faces[inward][:, ::-1]
    V = points * (1 + _displacement(points))[:, None]
    V += random.normal(size=V.shape) * (NOISE * edge)
    return TriangleMesh(V.astype(np.float32).astype(np.float64), faces)


def _spiral(n: int) -> Floats:
    """Return n points on the unit sphere, each of the same area, float64 (n, 3)."""
    at = np.arange(n)
    z = 1 - (2 * at + 1) / n
    angle, radius = at * (math.pi * (3 - math.sqrt(5))), np.sqrt(1 - z * z)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)


def _displacement(points: Floats) -> Floats:
    """Return octaves of bent waves at points of the unit sphere, float64 (n,)."""
    random = np.random.default_rng(SEED)
    result = np.zeros(len(points))
    frequency, amplitude = FIRST_FREQUENCY, FIRST_AMPLITUDE / WAVES
    for _ in range(OCTAVES):
        for _ in range(WAVES):
            across, along = random.normal(size=(2, 3))
            across *= 2 * frequency / np.linalg.norm(across)
            bend, shift = random.uniform(0, 2 * math.pi, 2)
            waves = points @ across + 1.5 * np.sin(points @ (along * frequency) + bend) + shift
            result += amplitude * np.sin(waves)
        frequency, amplitude = frequency * FREQUENCIES, amplitude * AMPLITUDES
    return result


if __name__ == "__main__":
    command()
