"""Anchors: how they are chosen, and what the surface does around them.

Three tables, in Markdown. `choices`: bytes and errors of files whose anchors were chosen in one way
or another, at one bound. `fit`: the RMS distance with anchors at the vertices' own positions and
with fitted ones, of the same bytes. `spikes`: of every mesh file of a folder, how much more the
deltas and the normals err at anchors than elsewhere, and how far positions are from a direct
solution in double precision. `--picture` draws a surface without the fit and with it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple, cast
from unittest import mock

import click
import corpus
import numpy as np

from deltamesh import DeltameshError
from deltamesh._compare.welding import welded, without_isolated
from deltamesh._geometry import greedy_anchors, positions
from deltamesh._geometry.anchors import farthest
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.integers import NO_CELLS, NONE, Integers
from deltamesh._geometry.interpolation import Interpolation
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.solve import Factor
from deltamesh._geometry.systems import Systems
from deltamesh._graph.adjacency import Graph, components
from deltamesh._graph.laplacian import laplacian as sparse_laplacian
from deltamesh._kernels.mesh import distance, laplacian
from deltamesh._measures.metrics import diagonal, vertex_errors
from deltamesh._mesh import TriangleMesh
from deltamesh._options import Options
from deltamesh._pipeline.decoder import read_content
from deltamesh._pipeline.encoder import Encoded, encode_mesh
from deltamesh._shape.surface import Surface
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.container import Parameters

_EXAMPLES = """\
python benchmarks/anchors.py choices --mesh fandisk --mesh horse
python benchmarks/anchors.py fit
python benchmarks/anchors.py spikes --most 50000
python benchmarks/anchors.py spikes --picture docs/figures/anchors.png"""

CHOICES = ("farthest", "greedy", "random", "mixed")
# What is asked of the files whose anchors are compared.
NORMALS = 1.0
# Scans and CAD, closed and with boundaries.
NAMES = ("bunny", "horse", "camelhead", "screwdriver", "sphere")
NAMES += ("fandisk", "tray", "mountain", "plane_holes")


class File(NamedTuple):
    """What a file of anchors says, and the positions that it was made of, (n, 3)."""

    surface: Surface
    V: Floats
    parameters: Parameters
    integers: Integers
    size: int

    @property
    def decoded(self) -> Floats:
        """The positions of the vertices of the faces, (n, 3)."""
        return self.positions(Systems(self.surface))

    def positions(self, systems: Systems) -> Floats:
        """Return the positions that some systems solve for, (n, 3)."""
        coder = geometry_codec(self.parameters.method)
        found = coder.reconstruct(self.surface, self.parameters, self.integers, systems)
        return found[: len(self.V)]

    @property
    def copied(self) -> File:
        """The same deltas, with anchors at the vertices' own positions, and no fit."""
        p, integers = positions.placed(
            self.V[self.integers.anchors], self.V, self.V[:0], self.parameters, self.integers
        )
        return self._replace(parameters=p, integers=replace(integers, cells=NO_CELLS, units=NONE))


def coded(mesh: TriangleMesh, options: Options) -> File:
    """Encode a mesh, and read the file.

    Raises
    ------
    DeltameshError
    """
    one: Encoded = encode_mesh(corpus.as_polymesh(mesh), options)
    content = read_content(one.container, len(mesh.vertices), 1 << 40)
    surface = content.structure.surface
    V = one.draft.positions[: surface.vertex_count]
    return File(surface, V, one.container.parameters, content.integers, len(one.data))


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
    labels = components(*graph)
    anchors = farthest(*graph, labels, (k + 1) // 2)
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
    with mock.patch.object(greedy_anchors, "greedy", mixed):
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


class Direct:
    """Interpolated anchors by a direct solution in double precision."""

    def __init__(self, cells: Cells) -> None:
        from scipy.sparse.linalg import splu

        L = sparse_laplacian(*cells.graph).tocsc()
        self.cells = cells
        self._free = np.ones(len(cells.labels), dtype=bool)
        self._free[cells.anchors] = False
        self._fixed = L[self._free][:, cells.anchors]
        self._factor = splu(L[self._free][:, self._free])

    def solve(
        self,
        delta: Floats,
        positions: Floats,
        steps: Floats,
        tolerance: float = 0.0,
        start: Floats | None = None,
    ) -> Floats:
        """Return what `Interpolation.solve` does."""
        x = np.empty_like(delta)
        x[self.cells.anchors] = positions
        shift = positions.mean(axis=0)
        b = delta[self._free] - self._fixed @ (positions - shift)
        x[self._free] = self._factor.solve(b) + shift
        return x


class DirectSystems(Systems):
    """Systems whose Poisson problems are factored."""

    def interpolation(self, anchors: Ints) -> Interpolation:
        """Return the system that goes through the anchors."""
        return cast(Interpolation, Direct(self.cells(anchors)))


class Spikes(NamedTuple):
    """What the surface does at anchors.

    Attributes
    ----------
    deltas : float
        RMS error of the deltas there over that elsewhere.
    faces : float
        Mean angle of the normals of the faces there over that of all faces.
    """

    deltas: float
    faces: float


def errors_of_deltas(file: File, W: Floats) -> Floats:
    """Return the error of the delta of each vertex, float64 (n,)."""
    error = laplacian.apply(*file.surface.graph, W - file.V)
    return np.sqrt((error**2).sum(axis=1))


def spikes_of(file: File, W: Floats) -> Spikes:
    """Return what a surface does at its anchors."""
    error, at = errors_of_deltas(file, W), np.zeros(len(W), dtype=bool)
    at[file.integers.anchors] = True
    F = file.surface.faces
    N, M = (np.cross(X[F[:, 1]] - X[F[:, 0]], X[F[:, 2]] - X[F[:, 0]]) for X in (file.V, W))
    lengths = np.linalg.norm(N, axis=1), np.linalg.norm(M, axis=1)
    sound = (lengths[0] > 0) & (lengths[1] > 0)
    cosines = (N[sound] * M[sound]).sum(axis=1) / (lengths[0][sound] * lengths[1][sound])
    angles = np.arccos(np.clip(cosines, -1, 1))
    near = at[F[sound]].any(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        deltas = np.sqrt((error[at] ** 2).mean() / (error[~at] ** 2).mean())
        return Spikes(float(deltas), float(angles[near].mean() / angles.mean()))


def spikes(files: list[Path], most: int) -> Iterator[tuple[str, ...]]:
    """Yield a row for each mesh file: spikes with and without a fit, and errors of the solver."""
    heading = ("refined", "without fit", "normals", "without fit", "highpass", "normals")
    yield ("mesh", "vertices", "anchors", *heading, "from direct, steps")
    for file in files:
        try:
            mesh = without_isolated(welded(corpus.read(file)))
            if not 0 < len(mesh.vertices) <= most:
                continue
            step = diagonal(mesh.vertices) / 2000
            refined = coded(mesh, Options(method="refined", step=step))
            highpass = coded(mesh, Options(method="highpass", step=step))
            W, direct = refined.decoded, refined.positions(DirectSystems(refined.surface))
        except DeltameshError as error:
            click.echo(f"skipped: {file.name}: {error}", err=True)
            continue
        with_fit, bare = spikes_of(refined, W), spikes_of(refined.copied, refined.copied.decoded)
        weighed = spikes_of(highpass, highpass.decoded)
        numbers = (with_fit.deltas, bare.deltas, with_fit.faces, bare.faces, *weighed)
        yield (
            file.name,
            str(len(W)),
            str(refined.parameters.anchor_count),
            *(f"{number:.2f}" for number in numbers),
            f"{np.abs(W - direct).max() / step:.1e}",
        )


def draw_anchors(path: Path) -> None:
    """Draw the camel head with interpolated anchors, without the fit and with it."""
    from scenes import Look, Panel, draw, save

    options = Options(method="refined", normal_error=4.0, only=True, anchors=0.005)
    one = coded(corpus.bare("camelhead"), options)
    F = one.surface.faces
    look = Look((1.0, 0.3, 0.6), focus=(0.5, 0.55, 0.5), height=0.66)
    files = {"without a fit": one.copied, "fitted": one}
    row = [
        Panel(TriangleMesh(file.decoded, F), TriangleMesh(one.V, F), look, text)
        for text, file in files.items()
    ]
    save(draw([row], (880, 420), None), path)


def print_table(rows: Iterator[tuple[str, ...]]) -> None:
    """Print rows in Markdown, as they come."""
    for i, row in enumerate(rows):
        click.echo(f"| {' | '.join(row)} |")
        if i == 0:
            click.echo(f"|{'---|' * len(row)}")


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.argument("what", type=click.Choice(["choices", "fit", "spikes"]))
@corpus.selection
@click.option("--most", default=20_000, show_default=True, help="Vertices of meshes of `spikes`.")
@click.option(
    "--picture", type=click.Path(dir_okay=False, path_type=Path), help="Draw, and print no table."
)
def command(
    what: str, names: tuple[str, ...], quick: bool, most: int, picture: Path | None
) -> None:
    """Print how anchors are chosen, what their fit wins, or what the surface does around them."""
    if picture is not None:
        draw_anchors(picture)
    elif what == "spikes":
        given = (
            [corpus.path(name) for name in corpus.chosen(names, quick)] if names or quick else []
        )
        print_table(spikes(given or corpus.files(), most))
    else:
        which = corpus.chosen(names or (() if quick else NAMES), quick)
        print_table((choices if what == "choices" else fits)(which))


if __name__ == "__main__":
    command()
