"""How long `deltamesh` takes, as whole processes, and how fast connectivity is coded."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median

import click
import corpus
from processes import Usage, deltamesh, python

from deltamesh._graph.halfedges import weld
from deltamesh._shape.complexes import cut
from deltamesh._shape.connectivity import decode_connectivity, encode_connectivity
from deltamesh._shape.topology import build_topology
from deltamesh_cli.output import number, table

_EXAMPLES = """\
python benchmarks/speed.py
python benchmarks/speed.py --mesh bunny --mesh turbineblade --runs 5
python benchmarks/speed.py --quick"""

_PROCESSES = ("mesh", "vertices", "encode", "median", "MiB", "decode", "median", "MiB")
_CONNECTIVITY = ("mesh", "faces", "encode", "decode")


@click.command(epilog=corpus.epilog(_EXAMPLES))
@corpus.selection
@click.option(
    "--runs",
    type=click.IntRange(1),
    default=3,
    show_default=True,
    help="Run each command so many times.",
)
@click.option(
    "--method",
    type=click.Choice(["highpass", "refined", "cartesian"]),
    default="highpass",
    show_default=True,
    help="Method of encoding; everything else is the command's default.",
)
def command(names: tuple[str, ...], quick: bool, runs: int, method: str) -> None:
    """Measure seconds and peak memory of the commands, from process start to end.

    Then CPU seconds of start-up, and faces per second of the connectivity coder inside a process.
    Nothing is stored.
    """
    chosen = corpus.chosen(names, quick)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        rows = [_PROCESSES, *(of_processes(name, folder, runs, method) for name in chosen)]
        click.echo(f"whole processes, seconds (best and median of {runs}):")
        click.echo(table(rows))
        click.echo(f"\n{corpus.GENERATED}, CPU seconds:")
        click.echo(table(_start_up(folder, runs)))
    rows = [_CONNECTIVITY, *(of_connectivity(name, runs) for name in chosen)]
    click.echo(f"\nconnectivity, million faces a second (best of {runs}):")
    click.echo(table(rows))


def of_processes(name: str, folder: Path, runs: int, method: str) -> tuple[str, ...]:
    """Return a row: least and median seconds and peak memory of encoding and of decoding."""
    encoding = [_encode(name, folder, method) for _ in range(runs)]
    decoding = [_decode(name, folder) for _ in range(runs)]
    return (name, str(len(corpus.load(name).vertices)), *_cells(encoding), *_cells(decoding))


def _encode(name: str, folder: Path, method: str) -> Usage:
    target = folder / f"{name}.dmesh"
    arguments = ("encode", corpus.path(name), target, "-f", "-q", "--method", method)
    return deltamesh(*arguments)


def _decode(name: str, folder: Path) -> Usage:
    arguments = ("decode", folder / f"{name}.dmesh", folder / f"{name}.ply", "-f", "-q")
    return deltamesh(*arguments)


def _cells(usages: list[Usage]) -> tuple[str, ...]:
    seconds = [usage.seconds for usage in usages]
    peak = max(usage.peak for usage in usages)
    return f"{min(seconds):.2f}", f"{median(seconds):.2f}", f"{peak / 2**20:.0f}"


def _start_up(folder: Path, runs: int) -> list[tuple[str, ...]]:
    """Return rows: CPU seconds of the commands for a small mesh, and how often numpy fits in."""
    source, coded = corpus.path(corpus.GENERATED), folder / "start.dmesh"
    commands = {
        "import numpy": partial(python, "-c", "import numpy"),
        "--help": partial(deltamesh, "--help"),
        "encode": partial(deltamesh, "encode", source, coded, "-f", "-q"),
        "info": partial(deltamesh, "info", coded),
        "decode": partial(deltamesh, "decode", coded, folder / "start.ply", "-f", "-q"),
    }
    rounds = [[run().cpu for run in commands.values()] for _ in range(runs)]
    seconds = [sorted(column) for column in zip(*rounds, strict=True)]
    rows = [("", "best", "median", "of numpy")]
    for label, some in zip(commands, seconds, strict=True):
        ratio = median(some) / median(seconds[0])
        rows.append((label, f"{some[0]:.3f}", f"{median(some):.3f}", f"{ratio:.2f}"))
    return rows


def of_connectivity(name: str, runs: int) -> tuple[str, ...]:
    """Return a row: million faces a second of the two directions, arrays to bytes and back."""
    mesh = corpus.load(name)
    keep, welded = weld(mesh.vertices)
    manifold = cut(welded[mesh.faces], len(keep))
    topology = build_topology(manifold.faces, manifold.opposite, len(manifold.points))
    payload, coded = encode_connectivity(topology)
    view, n, m = memoryview(payload), len(coded.order), len(coded.manifold.faces)
    seconds = (
        _best(lambda: encode_connectivity(topology), runs),
        _best(lambda: decode_connectivity(view, n, m), runs),
    )
    return (name, str(m), *(number(m / 1e6 / one) for one in seconds))


def _best(function: Callable[[], object], runs: int) -> float:
    """Return the least seconds of some runs, after one that does not count."""
    times = []
    for _ in range(runs + 1):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return min(times[1:])


if __name__ == "__main__":
    command()
