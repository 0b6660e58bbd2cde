"""Peak memory of decoding, as whole processes, against what the limits take it to be."""

from __future__ import annotations

import tempfile
from pathlib import Path

import click
import corpus
import numpy as np
from processes import deltamesh

from deltamesh._limits import memory_needed
from deltamesh._mesh import TriangleMesh
from deltamesh._methods import METHODS
from deltamesh._options import Options
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh_cli.output import table
from deltamesh_formats.container.reader import read_container

_EXAMPLES = """\
python benchmarks/memory.py
python benchmarks/memory.py --mesh turbineblade
python benchmarks/memory.py --solver scipy --quick"""

_HEADING = ("mesh", "method", "vertices", "faces", "MiB", "B/vertex", "B/face", "estimate", "ratio")


@click.command(epilog=corpus.epilog(_EXAMPLES))
@corpus.selection
@click.option(
    "--solver",
    type=click.Choice(["auto", "core", "rslab", "pardiso", "scipy"]),
    default="auto",
    show_default=True,
    help="Solver of the decoder.",
)
def command(names: tuple[str, ...], quick: bool, solver: str) -> None:
    """Measure `deltamesh decode` against `deltamesh._limits.memory_needed`.

    Without --mesh also on a mesh of half a million vertices, where that is in the folder. Bytes
    per vertex and per face are each of all that is above the process's own need, which is taken
    from decoding a triangle. Exits with 1 where an estimate is too low.
    """
    chosen = corpus.chosen(names, quick)
    if not (names or quick):
        chosen += corpus.present([corpus.LARGE])
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        base = {method: _base(folder, method, solver) for method in METHODS}
        rows = [
            measured(name, folder, method, solver, base[method])
            for name in chosen
            for method in METHODS
        ]
    click.echo(table([_HEADING, *rows]))
    low = [f"{row[0]} ({row[1]})" for row in rows if float(row[-1]) > 1]
    if low:
        raise click.ClickException(f"the estimate is too low for {', '.join(low)}")


def _base(folder: Path, method: str, solver: str) -> int:
    """Return the peak of decoding a single triangle, in bytes."""
    file = folder / "triangle.dmesh"
    mesh = TriangleMesh(np.eye(3), np.array([[0, 1, 2]]))
    file.write_bytes(encode_mesh(corpus.as_polymesh(mesh), Options(method=method)).data)
    return _peak(file, solver)


def measured(name: str, folder: Path, method: str, solver: str, base: int) -> tuple[str, ...]:
    """Return a row: the peak of decoding a mesh, and its ratio to the estimate."""
    file = folder / f"{name}.dmesh"
    data = encode_mesh(corpus.as_polymesh(corpus.load(name)), Options(method=method)).data
    file.write_bytes(data)
    container = read_container(data)
    peak, estimate = _peak(file, solver), memory_needed(container)
    n, m = container.vertices, container.triangles
    return (
        name,
        method,
        str(n),
        str(m),
        _mebibytes(peak),
        f"{(peak - base) / n:.0f}",
        f"{(peak - base) / m:.0f}",
        _mebibytes(estimate),
        f"{peak / estimate:.3f}",
    )


def _peak(file: Path, solver: str) -> int:
    target = file.with_suffix(".ply")
    return deltamesh("decode", file, target, "-f", "-q", "--solver", solver).peak


def _mebibytes(size: int) -> str:
    return f"{size / 2**20:.0f}"


if __name__ == "__main__":
    command()
