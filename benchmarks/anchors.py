"""Anchors: how they are chosen, and what their fit wins.

Two tables of docs/anchors.md. `choices`: bytes and errors of files whose anchors were chosen in one
way or another, at one bound. `fit`: the RMS distance with anchors at the vertices' own positions
and with fitted ones, of the same bytes.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any
from unittest import mock

import click
import corpus
import numpy as np
from anchored import File, coded
from pages import lines

from deltamesh._geometry import anchors as choice
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.solve import Factor
from deltamesh._graph.adjacency import Graph
from deltamesh._kernels.mesh import distance
from deltamesh._measures.metrics import diagonal, vertex_errors
from deltamesh._mesh import TriangleMesh
from deltamesh._options import Options
from deltamesh_formats.array_types import Floats, Ints

_EXAMPLES = """\
python benchmarks/anchors.py choices --mesh fandisk --mesh horse
python benchmarks/anchors.py fit"""

CHOICES = ("farthest", "greedy", "random", "mixed")
# What is asked of the files whose anchors are compared.
NORMALS = 1.0
# Scans and CAD, closed and with boundaries.
NAMES = ("bunny", "horse", "camelhead", "screwdriver", "sphere")
NAMES += ("fandisk", "tray", "mountain", "plane_holes")


def mixed(
    graph: Graph,
    vertices: Floats,
    delta: Floats,
    k: int,
    positions: Floats,
    factor: Factor,
) -> Ints:
    """Return the farthest k / 2 vertices, and as many local maxima of the error that these leave.

    At most one is in the cell of each.
    """
    labels = choice.components(*graph)
    anchors = choice.farthest(*graph, labels, (k + 1) // 2)
    x = factor(anchors).solve(delta, positions[anchors])
    error = ((x - vertices) ** 2).sum(axis=1)
    is_maximum = np.empty(len(error), dtype=bool)
    distance.local_maxima(*graph, error, is_maximum)
    is_maximum[anchors] = False
    maxima = np.flatnonzero(is_maximum)
    maxima = maxima[np.argsort(-error[maxima], kind="stable")]
    _, first = np.unique(Cells(graph, labels, anchors).of[maxima], return_index=True)
    added = maxima[np.sort(first)][: max(k - len(anchors), 0)]
    return np.concatenate([anchors, added])


def chosen_by(how: str, mesh: TriangleMesh, options: dict[str, Any]) -> File:
    """Encode with anchors that are chosen in one way; "mixed" is none of the encoder's."""
    if how != "mixed":
        return coded(mesh, Options(anchor_method=how, **options))
    with mock.patch.object(choice, "greedy", mixed):
        return coded(mesh, Options(anchor_method="greedy", **options))


def choices(names: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Yield a row for each mesh and setting: of the farthest, and what others are of that.

    The step is that of the farthest at the bound on normals; with others it gives the same normals,
    nearly, which a search of their own would meet less closely.
    """
    settings: dict[str, dict[str, Any]] = {
        "refined, 0.1 %": {"method": "refined", "anchors": 0.001},
        "refined, 1 %": {"method": "refined", "anchors": 0.01},
        "highpass, 0.1 %": {"method": "highpass", "anchors": 0.001},
    }
    yield ("mesh", "file", "farthest", *CHOICES[1:])
    for name in names:
        mesh = corpus.bare(name)
        for label, options in settings.items():
            bound = Options(normal_error=NORMALS, only=True, anchor_method=CHOICES[0], **options)
            found = coded(mesh, bound).parameters
            given = {"step": found.step, **options}
            if found.method == "refined":
                given["coarse"] = found.coarse
            first, *others = (measured(how, mesh, given) for how in CHOICES)
            size, rms, largest, normals, dihedral, seconds = first
            shown = f"{size:.0f}, {rms:.1e}, {largest:.1e}, {normals:.2f}, {dihedral:.2f}"
            ratios = (
                ", ".join(f"{a / b:.{3 if i == 0 else 2}f}" for i, (a, b) in enumerate(pairs))
                for pairs in (zip(other, first, strict=True) for other in others)
            )
            yield (name, label, f"{shown}, {seconds:.1f}", *ratios)


def measured(how: str, mesh: TriangleMesh, options: dict[str, Any]) -> tuple[float, ...]:
    """Return bytes, RMS and largest distance over the diagonal, angles, and CPU seconds."""
    start = time.process_time()
    one = chosen_by(how, mesh, options)
    seconds = time.process_time() - start
    errors, unit = vertex_errors(one.V, one.decoded, one.surface.faces), diagonal(one.V)
    angles = errors.normal_deviation, errors.dihedral
    return (one.size, errors.rms / unit, errors.max / unit, *angles, seconds)


def fits(names: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Yield a row for each mesh: RMS with copied anchors, and with fitted ones over these."""
    kinds: dict[str, Callable[[float], dict[str, Any]]] = {
        "0 bits, 1 %": lambda unit: {"bits": 0, "anchors": 0.01},
        "plain, 1 %": lambda unit: {"step": unit / 1000, "anchors": 0.01, "diffusion": False},
        "diffused, 0.1 %": lambda unit: {"step": unit / 1000, "anchors": 0.001},
    }
    yield ("mesh", *(f"{kind}{what}" for kind in kinds for what in ("", ": fitted", ": max")))
    for name in names:
        mesh = corpus.bare(name)
        unit = diagonal(mesh.vertices)
        cells = []
        for options in kinds.values():
            one = coded(mesh, Options(method="highpass", anchor_method="farthest", **options(unit)))
            errors = [
                vertex_errors(one.V, file.decoded, one.surface.faces) for file in (one.copied, one)
            ]
            cells += [f"{errors[0].rms / unit:.2e}", f"{errors[1].rms / errors[0].rms - 1:+.0%}"]
            cells += [f"{errors[1].max / errors[0].max - 1:+.0%}"]
        yield (name, *cells)


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.argument("what", type=click.Choice(["choices", "fit"]))
@corpus.selection
def command(what: str, names: tuple[str, ...], quick: bool) -> None:
    """Print how anchors are chosen, or what their fit wins."""
    which = corpus.chosen(names or (() if quick else NAMES), quick)
    for line in lines((choices if what == "choices" else fits)(which)):
        click.echo(line)


if __name__ == "__main__":
    command()
