"""What surfaces do at their anchors, and how far the decoder is from a direct solution.

Two tables of docs/anchors.md: of mesh files, how much more the deltas and the normals err at
anchors than elsewhere, and how far positions are from those of a direct solution in double
precision; and what is the largest of each. `--picture` draws surfaces instead.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple, cast

import click
import corpus
import numpy as np
from anchored import File, coded
from pages import lines, replaced

from deltamesh import DeltameshError, MeshError
from deltamesh._compare.welding import welded, without_isolated
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.interpolation import Interpolation
from deltamesh._geometry.steps import of_vertices
from deltamesh._geometry.systems import Systems
from deltamesh._graph.laplacian import laplacian as sparse_laplacian
from deltamesh._kernels.mesh import laplacian
from deltamesh._measures.metrics import diagonal
from deltamesh._mesh import TriangleMesh
from deltamesh._options import Options
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.meshfiles.formats import EXTENSIONS

_EXAMPLES = """\
python benchmarks/spikes.py --most 20000
python benchmarks/spikes.py --quick FILE...
python benchmarks/spikes.py --write FOLDER
python benchmarks/spikes.py --picture docs/figures"""

PAGE = Path(__file__).parents[1] / "docs" / "anchors.md"
# Steps of deltas in a diagonal.
STEPS: Final = 2000
# Vertices of the meshes that are summed up: below them there is one anchor, one among few vertices.
LEAST: Final = 1000
NAMES = ("deltas", "largest", "normals")
HEADING = ("mesh", "vertices", "components", "valence", "anchors", *NAMES)
HEADING += (*(f"without fit: {name}" for name in NAMES), *(f"highpass: {name}" for name in NAMES))
DISTANCE: Final = "from direct, steps"
HEADING += (DISTANCE,)
Row = tuple[str, ...]


class Direct:
    """Interpolated anchors by a direct solution in double precision: SuperLU, and one refinement.

    It has the matrix in common with `Interpolation`, and nothing of the multigrid solver.
    """

    def __init__(self, cells: Cells) -> None:
        from scipy.sparse.linalg import splu

        L = sparse_laplacian(*cells.graph).tocsc()
        self.cells = cells
        self._free = np.ones(len(cells.labels), dtype=bool)
        self._free[cells.anchors] = False
        self._fixed = L[self._free][:, cells.anchors]
        self._matrix = L[self._free][:, self._free]
        # Symmetric and diagonally dominant: no pivoting.
        self._factor = splu(
            self._matrix,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )

    def solve(
        self,
        delta: Floats,
        positions: Floats,
        steps: Floats,
        tolerance: float = 0.0,
        start: Floats | None = None,
    ) -> Floats:
        """Return what `Interpolation.solve` does."""
        shift = self.cells.centres(positions)
        x = np.empty_like(delta)
        x[self.cells.anchors] = positions
        b = delta[self._free] - self._fixed @ (positions - shift[self.cells.anchors])
        found = self._factor.solve(b)
        found += self._factor.solve(b - self._matrix @ found)
        x[self._free] = found + shift[self._free]
        return x


class DirectSystems(Systems):
    """Systems whose Poisson problems are factored."""

    def interpolation(self, anchors: Ints) -> Interpolation:
        """Return the system that goes through the anchors."""
        return cast(Interpolation, Direct(self.cells(anchors)))


def distance_from_direct(file: File, W: Floats) -> float:
    """Return the largest distance of a coordinate from a direct solution, in steps.

    A step is the least of the component, as in the tolerance of the format.
    """
    systems = DirectSystems(file.surface)
    steps = of_vertices(file.parameters.step, file.integers)[: len(W)]
    least = systems.cells(file.integers.anchors).least(steps)
    return float((np.abs(W - file.positions(systems)) / least).max())


class Spikes(NamedTuple):
    """What the surface does at anchors.

    Attributes
    ----------
    deltas : float
        RMS error of the deltas there over that elsewhere.
    largest : float
        Largest error of a delta there over the largest elsewhere.
    normals : float
        Mean angle of the normals of the faces there over that of all faces.
    """

    deltas: float
    largest: float
    normals: float


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
    there, elsewhere = error[at], error[~at]
    with np.errstate(divide="ignore", invalid="ignore"):
        deltas = np.sqrt((there**2).mean() / (elsewhere**2).mean())
        normals = angles[near].mean() / angles.mean() if near.any() else np.nan
        return Spikes(float(deltas), float(there.max() / elsewhere.max()), float(normals))


def row_of(file: Path, most: int | None) -> Row:
    """Return the row of a mesh file.

    Raises
    ------
    DeltameshError
        If it cannot be read, has no faces, or more vertices than there may be.
    """
    mesh = without_isolated(welded(corpus.read(file)))
    n = len(mesh.vertices)
    if not n or n > (most or n):
        raise MeshError(f"{file}: {n} vertices of faces")
    step = diagonal(mesh.vertices) / STEPS
    refined = coded(mesh, Options(method="refined", step=step))
    W, bare = refined.decoded, refined.copied
    found = [*spikes_of(refined, W), *spikes_of(bare, bare.decoded)]
    distance = distance_from_direct(refined, W)
    graph, labels = refined.surface.graph, refined.surface.labels
    counts = (len(W), labels.max() + 1, np.diff(graph[0]).max(), len(refined.integers.anchors))
    highpass = coded(mesh, Options(method="highpass", step=step))
    found += spikes_of(highpass, highpass.decoded)
    ratios = (f"{number:.2f}" if np.isfinite(number) else "-" for number in found)
    return (file.name, *map(str, counts), *ratios, f"{distance:.1e}")


def spikes(files: list[Path], most: int | None = None) -> Iterator[Row]:
    """Yield the heading, and a row for each mesh file; others are named on standard error."""
    yield HEADING
    for file in files:
        try:
            yield row_of(file, most)
        except DeltameshError as error:
            click.echo(f"skipped: {error}", err=True)


def summary(rows: list[Row]) -> Iterator[Row]:
    """Yield median and largest of each column, of the meshes of `LEAST` vertices or more.

    Distances are those of all meshes.
    """
    yield ("column", "meshes", "median", "largest", "of")
    for name in (*HEADING[5:-1], DISTANCE):
        at = HEADING.index(name)
        counted = [row for row in rows if name == DISTANCE or int(row[1]) >= LEAST]
        cells = {row[0]: float(row[at]) for row in counted if row[at] != "-"}
        if not cells:
            continue
        shown = ".1e" if name == DISTANCE else ".2f"
        worst = max(cells, key=lambda mesh: cells[mesh])
        numbers = (format(x, shown) for x in (statistics.median(cells.values()), cells[worst]))
        yield (name, str(len(cells)), *numbers, worst)


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


def mesh_files(paths: tuple[Path, ...]) -> Iterator[Path]:
    """Yield files, and the mesh files of folders, in the order of their names."""
    for path in paths:
        inside = sorted(path.rglob("*")) if path.is_dir() else [path]
        yield from (one for one in inside if one == path or one.suffix[1:].lower() in EXTENSIONS)


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.argument(
    "paths", nargs=-1, metavar="[FILE | FOLDER]...", type=click.Path(exists=True, path_type=Path)
)
@click.option("--most", type=int, help="Leave meshes of more vertices out.")
@click.option(
    "--quick", is_flag=True, help="Measure the repository's own mesh, and what is given, only."
)
@click.option("--write", is_flag=True, help="Write the tables into docs/anchors.md, too.")
@click.option(
    "--picture", type=click.Path(dir_okay=False, path_type=Path), help="Draw, and print no table."
)
def command(
    paths: tuple[Path, ...], most: int | None, quick: bool, write: bool, picture: Path | None
) -> None:
    """Print what surfaces do at their anchors: of all meshes of the corpus, and of further ones."""
    if picture is not None:
        draw_anchors(picture)
        return
    own = [corpus.path(corpus.GENERATED)] if quick else corpus.files()
    rows = []

    def seen() -> Iterator[Row]:
        for row in spikes([*own, *mesh_files(paths)], most):
            rows.append(row)
            yield row

    for line in lines(seen()):
        click.echo(line)
    tables = {"spikes": rows, "largest": list(summary(rows[1:]))}
    click.echo()
    for line in lines(tables["largest"]):
        click.echo(line)
    if write:
        page = PAGE.read_text(encoding="utf-8")
        for name, table in tables.items():
            page = replaced(page, name, "\n".join(lines(table)))
        PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    command()
