"""The size of our files over that of Draco's: no worse in normals, dihedral angles and distances.

The headline keeps three bounds at once: the mean deviation of the face normals and the mean error
of the dihedral angles of Draco's file, and an RMS distance that a silhouette does not show. Each
angle by itself is measured, too.

Draco is at its best, compression level 10; both write positions and faces of the same welded mesh
without isolated vertices, in an order of their own; whole files count.
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import click
import corpus
import pool
from equal import Coder, Point, coded_at, interpolated_at, point

from deltamesh._measures.parts import QUALITY_RMS
from deltamesh.bench import codec_of, missing
from deltamesh_cli.output import table
from deltamesh_formats.errors import DeltameshError, OptionError

_EXAMPLES = """\
python benchmarks/headline.py
python benchmarks/headline.py --error all --mesh bunny --mesh horse
python benchmarks/headline.py --codec "refined coarse=4" --way curve
python benchmarks/headline.py --codec cartesian --mesh fandisk --json fandisk.json"""

ERRORS = ("normals", "dihedral")
ALL = "all"
OPTIONS = {"normals": "normal_error", "dihedral": "dihedral_error", "rms": "rms_error_rel"}
COLUMNS = (*ERRORS, ALL)


class Comparison(NamedTuple):
    """Draco's file of a mesh, and ours at each error of it; None where we have none.

    Attributes
    ----------
    mesh : str
    bits : int
        Draco's quantization bits.
    draco : Point
    ours : mapping of str to Point or None
        By the name of the error, of `COLUMNS`.
    """

    mesh: str
    bits: int
    draco: Point
    ours: Mapping[str, Point | None]

    def ratio(self, error: str) -> float:
        """Return our size over Draco's, NaN without ours."""
        ours = self.ours[error]
        return math.nan if ours is None else ours.size / self.draco.size


@click.command(epilog=corpus.epilog(_EXAMPLES))
@corpus.selection
@click.option(
    "--codec",
    default="auto",
    show_default=True,
    metavar="LABEL",
    help="Method and options of ours, as deltamesh bench prints them.",
)
@click.option(
    "--bits",
    type=click.IntRange(1, 30),
    multiple=True,
    default=(10, 11, 12),
    show_default=True,
    help="Draco's quantization bits; may be repeated.",
)
@click.option(
    "--way",
    type=click.Choice(["exact", "curve"]),
    default="exact",
    show_default=True,
    help="exact: files of that quality, by --normal-error, by all bounds together and, for dihedral"
    " angles alone, by a search for the step (or else --normal-error) within 1 %. curve:"
    " interpolated, log-log, between files with steps in the ratio sqrt(2); faster, and at exactly"
    " the same error.",
)
@click.option(
    "--error",
    "columns",
    type=click.Choice(COLUMNS),
    multiple=True,
    default=COLUMNS,
    show_default=True,
    help="The error that is alike, or all at once; may be repeated.",
)
@click.option(
    "--rms",
    type=click.FloatRange(0, min_open=True),
    default=QUALITY_RMS,
    show_default=True,
    metavar="E",
    help="The RMS distance, over the diagonal, that holds with both angles.",
)
@click.option("--draco-rms", is_flag=True, help="Keep Draco's own RMS distance with both angles.")
@click.option("--json", "file", type=click.Path(dir_okay=False, path_type=Path), help="Write all.")
@pool.jobs
def command(
    names: tuple[str, ...],
    quick: bool,
    codec: str,
    bits: tuple[int, ...],
    way: str,
    columns: tuple[str, ...],
    rms: float,
    draco_rms: bool,
    file: Path | None,
    jobs: int,
) -> None:
    """Compare file sizes with Draco's at equal error; needs the extra `bench`.

    Our size over Draco's where the mean deviation of the face normals, or the mean error of the
    dihedral angles, is that of Draco's file, and where neither is larger and the RMS distance is
    within a bound; then geometric means.
    """
    if absent := missing("draco"):
        raise click.ClickException(f"{absent[0]} is missing: pip install '.[bench]'")
    try:
        codec_of(codec)
    except OptionError as error:
        raise click.UsageError(f"{error}.") from error
    start = time.perf_counter()
    chosen = corpus.chosen(names, quick)
    largest_rms = None if draco_rms else rms
    tasks = [(name, codec, bits, way, columns, largest_rms) for name in chosen]
    found = dict(zip(chosen, pool.each(compared, tasks, jobs), strict=True))
    click.echo(f"{codec} over Draco, level 10, sizes at equal error ({way}); Draco's bits:")
    click.echo(table(_rows(found, bits, columns)))
    click.echo(f"{time.perf_counter() - start:.0f} s", err=True)
    if file is not None:
        file.write_text(json.dumps(_as_objects(found, codec, way), indent=1) + "\n")


Task = tuple[str, str, tuple[int, ...], str, tuple[str, ...], float | None]


def compared(task: Task) -> list[Comparison]:
    """Return the comparisons of a mesh at each of Draco's bits; with its RMS distance if None."""
    name, label, bits, way, columns, rms = task
    coder = Coder(label, corpus.bare(name))
    found = []
    for one in bits:
        draco = point(f"draco bits={one}", coder.mesh)
        angles = {error: getattr(draco, error) for error in ERRORS}
        bounds = {**angles, "rms": draco.rms if rms is None else rms}
        wanted = {**{error: {error: angles[error]} for error in ERRORS}, ALL: bounds}
        ours = {column: _within(coder, wanted[column], way) for column in columns}
        found.append(Comparison(name, one, draco, ours))
    return found


def _within(coder: Coder, bounds: Mapping[str, float], way: str) -> Point | None:
    """Return the point whose error is the bound, or that keeps several; None without any."""
    try:
        if way == "curve":
            points = [interpolated_at(coder, *each) for each in bounds.items()]
            return max(points, key=lambda one: one.size)
        if tuple(bounds) == ("dihedral",):
            return coded_at(coder, "dihedral", bounds["dihedral"])
        words = [f"{OPTIONS[error]}={bound!r}" for error, bound in bounds.items()]
        return point(" ".join([coder.label, *words]), coder.mesh)
    except DeltameshError as failure:
        shown = ", ".join(f"{error} {bound:.4g}" for error, bound in bounds.items())
        print(f"no size at {shown}: {failure}", file=sys.stderr)
        return None


def geometric_mean(values: Sequence[float]) -> float:
    """Return the geometric mean; NaN where a value is."""
    return math.exp(math.fsum(map(math.log, values)) / len(values))


def largest(values: Sequence[float]) -> float:
    """Return the largest value; NaN where a value is."""
    return math.nan if any(map(math.isnan, values)) else max(values)


def _rows(
    found: Mapping[str, list[Comparison]], bits: tuple[int, ...], columns: tuple[str, ...]
) -> Iterator[tuple[str, ...]]:
    yield ("", *(f"{column} {one}" for column in columns for one in bits), *columns)
    for name, comparisons in found.items():
        yield (name, *_cells([comparisons]))
    for group, names in corpus.GROUPS.items():
        inside = [found[name] for name in names if name in found]
        if len(inside) > 1:
            yield (f"mean, {group}", *_cells(inside))
            yield (f"worst, {group}", *_cells(inside, worst=True))


def _cells(meshes: list[list[Comparison]], worst: bool = False) -> Iterator[str]:
    """Yield ratios: at each of the bits, by error; then their means."""
    of_all = largest if worst else geometric_mean
    ratios = {c: [[one.ratio(c) for one in mesh] for mesh in meshes] for c in meshes[0][0].ours}
    for column in ratios:
        yield from (f"{of_all(of_bits):.3f}" for of_bits in zip(*ratios[column], strict=True))
    for column in ratios:
        yield f"{of_all(list(map(geometric_mean, ratios[column]))):.3f}"


def _as_objects(
    found: Mapping[str, list[Comparison]], codec: str, way: str
) -> list[dict[str, Any]]:
    return [
        {
            "mesh": one.mesh,
            "codec": codec,
            "way": way,
            "bits": one.bits,
            "draco": one.draco._asdict(),
            **{error: ours and ours._asdict() for error, ours in one.ours.items()},
        }
        for comparisons in found.values()
        for one in comparisons
    ]


if __name__ == "__main__":
    command()
