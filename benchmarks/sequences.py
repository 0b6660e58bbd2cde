"""Sequences of frames against a file a frame: bytes, errors, and CPU time, of an animated mesh.

The animation bends a mesh, twists it, and lets a bulge run up: motion that is neither small nor
rigid. `--per-cycle` makes it slower. Beside a sequence at default quality there are a file of
deltamesh for each frame, of the same quality, and one of Draco, with the fewest bits that
keep normals about as well; of both, some frames are measured.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import click
import corpus
import numpy as np

import deltamesh
from deltamesh._measures.metrics import diagonal, vertex_errors
from deltamesh._mesh import TriangleMesh
from deltamesh.bench._peers import draco
from deltamesh_formats.array_types import Floats

_EXAMPLES = """\
python benchmarks/sequences.py
python benchmarks/sequences.py --mesh bunny --frames 12 --per-cycle 100"""

HEAD = "| frames | bytes a frame | all | RMS | normals | dihedral | CPU s a frame |"
RULE = "|---|--:|--:|--:|--:|--:|--:|"
# RMS distance over the diagonal, mean deviations of normals and of dihedral angles in degrees.
Errors: TypeAlias = tuple[float, float, float]
# Angles of the bend and of the twist in radians, and how much the bulge adds.
BEND, TWIST, BULGE = 0.7, 0.8, 0.04
# Draco's normals may be worse than ours by that factor.
MARGIN = 1.2
# Shares of the frames that are measured where each is a file.
MEASURED = (0.15, 0.65)


@dataclass(frozen=True)
class Row:
    """What one way of coding the frames makes of them.

    Attributes
    ----------
    name : str
    frame : float
        Mean bytes of a frame; of a sequence, of one beyond the first.
    total : float
        Bytes of all frames.
    rms : float
        Mean RMS distance over the diagonal.
    normals, dihedral : float
        Mean deviations, in degrees.
    seconds : float
        CPU time of encoding, a frame.
    """

    name: str
    frame: float
    total: float
    rms: float
    normals: float
    dihedral: float
    seconds: float

    def __str__(self) -> str:
        sizes = f"{self.frame:,.0f}", f"{self.total / 1000:,.0f} kB"
        errors = f"{self.rms:.1e}", f"{self.normals:.2f}", f"{self.dihedral:.2f}"
        return f"| {' | '.join((self.name, *sizes, *errors, f'{self.seconds:.1f}'))} |"


def animation(V: Floats, frames: int, per_cycle: int) -> Iterator[Floats]:
    """Yield positions of vertices (n, 3), frame by frame; a cycle brings them back."""
    low, high = V.min(axis=0), V.max(axis=0)
    foot = np.array([(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2])
    x, y, z = ((V - foot) / (high - low).max()).T
    for t in range(frames):
        u = 2 * np.pi * t / per_cycle
        twist, bend = TWIST * np.sin(2 * u) * y, BEND * np.sin(u) * y**2
        a, c = np.cos(twist) * x + np.sin(twist) * z, np.cos(twist) * z - np.sin(twist) * x
        turned = np.cos(bend) * a - np.sin(bend) * y, np.sin(bend) * a + np.cos(bend) * y, c
        size = (high - low).max() * (1 + BULGE * np.sin(6 * np.pi * y - 2 * u))
        yield foot + size[:, None] * np.stack(turned, axis=1)


def rows(mesh: TriangleMesh, frames: int, per_cycle: int) -> Iterator[Row]:
    """Yield the rows of the table of a mesh."""
    every = list(animation(mesh.vertices, frames, per_cycle))
    sequence = of_sequence(every, mesh)
    yield sequence
    some = [every[int(share * frames)] for share in MEASURED]
    yield _of_files("deltamesh, a file each", some, mesh, frames, _own)
    bits = next(
        bits
        for bits in range(6, 31)
        if np.mean([_by_draco(V, mesh, bits)[1][1] for V in some]) <= MARGIN * sequence.normals
    )
    name = f"Draco, {bits} bits, a file each"
    yield _of_files(name, some, mesh, frames, lambda V, m: _by_draco(V, m, bits))


def of_sequence(every: list[Floats], mesh: TriangleMesh) -> Row:
    """Return the row of a sequence of all frames."""
    given = (deltamesh.from_arrays(V, mesh.faces) for V in every)
    start = time.process_time()
    data = deltamesh.encode(given, keep_order=True)
    seconds = (time.process_time() - start) / len(every)
    sizes = [frame.size for frame in deltamesh.info(data).frames]
    decoded = zip(every, deltamesh.frames(data), strict=True)
    errors = [_errors(V, found.vertices, mesh) for V, found in decoded]
    # Without the order, which a file of another order does not have.
    total = len(data) - deltamesh.info(data).sections["ORDR"].size
    return Row(
        "deltamesh, a sequence", float(np.mean(sizes)), float(total), *_means(errors), seconds
    )


def _errors(V: Floats, W: Floats, mesh: TriangleMesh) -> Errors:
    e = vertex_errors(V, W, mesh.faces)
    return e.rms / diagonal(V), e.normal_deviation, e.dihedral


def _means(errors: list[Errors]) -> Errors:
    rms, normals, dihedral = np.mean(errors, axis=0).tolist()
    return rms, normals, dihedral


def _of_files(
    name: str,
    some: list[Floats],
    mesh: TriangleMesh,
    frames: int,
    code: Callable[[Floats, TriangleMesh], tuple[int, Errors]],
) -> Row:
    """Return the row of a file for each frame, from some frames."""
    start = time.process_time()
    coded = [code(V, mesh) for V in some]
    seconds = (time.process_time() - start) / len(some)
    frame = float(np.mean([size for size, _ in coded]))
    return Row(name, frame, frames * frame, *_means([errors for _, errors in coded]), seconds)


def _own(V: Floats, mesh: TriangleMesh) -> tuple[int, Errors]:
    data = deltamesh.encode(V, mesh.faces, method="refined", keep_order=True)
    size = len(data) - deltamesh.info(data).sections["ORDR"].size
    return size, _errors(V, deltamesh.decode(data).vertices, mesh)


def _by_draco(V: Floats, mesh: TriangleMesh, bits: int) -> tuple[int, Errors]:
    coded = draco(TriangleMesh(V, mesh.faces), bits)
    return coded.size, _errors(coded.reference.vertices, coded.decoded.vertices, mesh)


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.option("--frames", default=20, show_default=True, help="Frames of the sequence.")
@click.option("--per-cycle", type=int, help="Frames of a whole motion.  [default: all]")
@corpus.selection
def command(names: tuple[str, ...], quick: bool, frames: int, per_cycle: int | None) -> None:
    """Print what the frames of an animated mesh take as a sequence, and as a file each."""
    for name in corpus.chosen(names or ("bunny",) * (not quick), quick):
        click.echo(f"{name}, {frames} frames, {per_cycle or frames} a cycle")
        click.echo(f"{HEAD}\n{RULE}")
        for row in rows(corpus.bare(name), frames, per_cycle or frames):
            click.echo(str(row))


if __name__ == "__main__":
    command()
