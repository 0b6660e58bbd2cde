"""What surfaces do at their anchors, and how far the decoder is from a direct solution.

Two tables of docs/anchors.md: of mesh files, how much more the deltas and the normals err at
anchors than elsewhere, and how far positions are from those of a direct solution in double
precision; and what is the largest of each. `--picture` draws the worst of them.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

import click
import corpus
import numpy as np
from anchor_picture import draw_worst
from anchored import STEPS, File, coded
from direct import distance_from_direct
from pages import lines, replaced

from deltamesh import DeltameshError, MeshError
from deltamesh._compare.welding import welded, without_isolated
from deltamesh._geometry.interpolation import TOLERANCE
from deltamesh._measures.metrics import diagonal
from deltamesh._options import Options
from deltamesh_formats.array_types import Floats
from deltamesh_formats.meshfiles.formats import EXTENSIONS

_EXAMPLES = """\
python benchmarks/spikes.py --most 20000
python benchmarks/spikes.py --quick FILE...
python benchmarks/spikes.py --write FOLDER
python benchmarks/spikes.py --picture docs/figures/anchors.png"""

PAGE = Path(__file__).parents[1] / "docs" / "anchors.md"
# Vertices of the meshes that are summed up: below them there is one anchor, one among few vertices.
LEAST: Final = 1000
NAMES = ("deltas", "largest", "normals")
RATIOS = (*NAMES, *(f"{kind}: {name}" for kind in ("without fit", "highpass") for name in NAMES))
DISTANCE: Final = "from direct, steps"
HEADING = ("mesh", "vertices", "components", "valence", "anchors", *RATIOS, DISTANCE)
Row = tuple[str, ...]


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


def angles_of(file: File, W: Floats) -> Floats:
    """Return the angle by which the normal of each face is off, or NaN where there is none."""
    F = file.surface.faces
    N, M = (np.cross(X[F[:, 1]] - X[F[:, 0]], X[F[:, 2]] - X[F[:, 0]]) for X in (file.V, W))
    with np.errstate(invalid="ignore"):
        cosines = (N * M).sum(axis=1) / (np.linalg.norm(N, axis=1) * np.linalg.norm(M, axis=1))
    return np.asarray(np.arccos(np.clip(cosines, -1, 1)))


def spikes_of(file: File, W: Floats) -> Spikes:
    """Return what a surface does at its anchors."""
    error, angles, at = file.errors(W), angles_of(file, W), np.zeros(len(W), dtype=bool)
    at[file.integers.anchors] = True
    there, elsewhere = error[at], error[~at]
    sound = np.isfinite(angles)
    near = at[file.surface.faces].any(axis=1) & sound
    with np.errstate(divide="ignore", invalid="ignore"):
        deltas = np.sqrt((there**2).mean() / (elsewhere**2).mean())
        normals = angles[near].mean() / angles[sound].mean() if near.any() else np.nan
        return Spikes(float(deltas), float(there.max() / elsewhere.max()), float(normals))


def file_of(path: Path, method: str = "refined", most: int | None = None) -> File:
    """Encode a mesh file at the step of the table.

    Raises
    ------
    DeltameshError
        If it cannot be read, has no faces, or more vertices than there may be.
    """
    mesh = without_isolated(welded(corpus.read(path)))
    n = len(mesh.vertices)
    if not n or n > (most or n):
        raise MeshError(f"{path}: {n} vertices of faces")
    return coded(mesh, Options(method=method, step=diagonal(mesh.vertices) / STEPS))


def row_of(path: Path, most: int | None = None) -> Row:
    """Return the row of a mesh file.

    Raises
    ------
    DeltameshError
        See `file_of`.
    """
    refined = file_of(path, most=most)
    W, bare = refined.decoded, refined.copied
    found = [*spikes_of(refined, W), *spikes_of(bare, bare.decoded)]
    distance = distance_from_direct(refined, W)
    graph, labels = refined.surface.graph, refined.surface.labels
    counts = (len(W), labels.max() + 1, np.diff(graph[0]).max(), len(refined.integers.anchors))
    highpass = file_of(path, "highpass")
    found += spikes_of(highpass, highpass.decoded)
    ratios = (f"{number:.2f}" if np.isfinite(number) else "-" for number in found)
    return (path.name, *map(str, counts), *ratios, f"{distance:.1e}")


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
    for name in (*RATIOS, DISTANCE):
        at = HEADING.index(name)
        counted = [row for row in rows if name == DISTANCE or int(row[1]) >= LEAST]
        cells = {row[0]: float(row[at]) for row in counted if row[at] != "-"}
        if not cells:
            continue
        shown = ".1e" if name == DISTANCE else ".2f"
        worst = max(cells, key=lambda mesh: cells[mesh])
        numbers = (format(x, shown) for x in (statistics.median(cells.values()), cells[worst]))
        yield (name, str(len(cells)), *numbers, worst)


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
    "--picture",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Draw the worst mesh, and measure nothing; needs the extra `view`.",
)
def command(
    paths: tuple[Path, ...], most: int | None, quick: bool, write: bool, picture: Path | None
) -> None:
    """Print what surfaces do at their anchors: of all meshes of the corpus, and of further ones.

    Exits with 1 if a position is further from a direct solution than the format allows.
    """
    if picture is not None:
        draw_worst(picture)
        return
    own, rows = [corpus.path(corpus.GENERATED)] if quick else corpus.files(), []

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
    if far := [row[0] for row in rows[1:] if float(row[-1]) > TOLERANCE]:
        raise click.ClickException(f"further than {TOLERANCE:g} steps: {', '.join(far)}")


if __name__ == "__main__":
    command()
