"""Rate-distortion tables and curves: bits per vertex against every error, ours and other codecs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import click
import corpus
import pool
from equal import knob

from deltamesh._measures.metrics import diagonal
from deltamesh.bench import PEERS, Measurement, codec_of, measure, missing
from deltamesh.bench import _rates as rates
from deltamesh_cli.output import table
from deltamesh_formats.errors import DeltameshError, OptionError

_EXAMPLES = """\
python benchmarks/curves.py --quick --output curves
python benchmarks/curves.py --mesh bunny --mesh fandisk --output curves
python benchmarks/curves.py --mesh horse --codec "refined coarse=4" --codec draco --output curves"""

# Families of codecs: labels that lack the option which makes a curve of them.
FAMILIES = (
    *("refined", "highpass", "highpass diffusion=False", "cartesian"),
    *("draco", "meshopt", "zstd"),
)
# What that option goes through. Steps are fractions of the diagonal of the bounding box.
_BITS = range(8, 15)
_STEPS = tuple(2.0**-k for k in range(8, 15))
_NORMALS = (8, 4, 2, 1, 0.5, 0.25, 0.125)

_SHOWN = ("codec", "bytes", "bpv", *rates.ERRORS)


@click.command(epilog=corpus.epilog(_EXAMPLES))
@corpus.selection
@click.option(
    "--codec",
    "families",
    default=FAMILIES,
    show_default=True,
    multiple=True,
    metavar="LABEL",
    help="Method and options as deltamesh bench prints them, without bits, step or another rate;"
    " may be repeated. One with a rate is a point.",
)
@click.option(
    "--output",
    type=click.Path(file_okay=False, path_type=Path),
    required=True,
    help="A folder for MESH.csv, MESH.json and MESH.png of each mesh.",
)
@pool.jobs
def command(
    names: tuple[str, ...], quick: bool, families: tuple[str, ...], output: Path, jobs: int
) -> None:
    """Measure each mesh under each codec at several rates; needs the extra `bench`.

    All write the same welded mesh without isolated vertices; bits per vertex count whole files.
    Errors are those of deltamesh bench, lengths as fractions of the bounding box diagonal.
    """
    import figures

    for family in families:
        if family not in PEERS:
            _check(family)
    output.mkdir(parents=True, exist_ok=True)
    there = tuple(family for family in families if not _absent(family))
    for name in corpus.chosen(names, quick):
        tasks = [(name, label) for family in there for label in sweep(family, name)]
        results = pool.each(measured, tasks, jobs)
        found = {family: _some(results, len([*sweep(family, name)])) for family in there}
        _write(output / name, [one for points in found.values() for one in points])
        title = f"{name}, {len(corpus.bare(name).vertices):,} vertices"
        figures.save(figures.curves(found, title), output / f"{name}.png")


def _some(results: Iterator[Measurement | None], count: int) -> list[Measurement]:
    """Return the next so many results, without those that failed."""
    return [one for one in islice(results, count) if one is not None]


def _check(family: str) -> None:
    try:
        codec_of(family)
    except OptionError as error:
        raise click.UsageError(f"{error}.") from error


def _absent(family: str) -> bool:
    """Tell whether a package is missing, and on standard error which."""
    if absent := missing(family):
        click.echo(f"skipped: {family}: {', '.join(absent)} is not installed", err=True)
    return bool(absent)


def sweep(family: str, name: str) -> Iterator[str]:
    """Yield the labels of a family at its rates, for a mesh; a label with a rate is alone."""
    method, *words = family.split()
    given = {word.partition("=")[0] for word in words}
    if given & {"bits", "step", "normal_error", "max_error", "max_error_rel", "quality"}:
        yield family
    elif method in PEERS:
        yield from (f"{family} bits={b}" for b in _BITS) if PEERS[method].max_bits else (family,)
    elif method == "cartesian":
        yield from (f"{family} bits={b}" for b in _BITS)
    elif knob(family) == "step":
        unit = diagonal(corpus.load(name).vertices)
        yield from (f"{family} step={step * unit:.6g}" for step in _STEPS)
    else:
        yield from (f"{family} normal_error={one}" for one in _NORMALS)


def measured(task: tuple[str, str]) -> Measurement | None:
    """Measure a mesh under a label; what fails is told, and missing."""
    name, label = task
    try:
        return measure(name, corpus.bare(name), codec_of(label))
    except DeltameshError as error:
        click.echo(f"{name}: {label}: {error}", err=True)
        return None


def _write(stem: Path, found: list[Measurement]) -> None:
    """Print a table, and write it as CSV and as JSON."""
    rows = [rates.row_of(one) for one in found]
    click.echo(f"\n{stem.name}:")
    click.echo(table([_SHOWN, *([row[column] for column in _SHOWN] for row in rows)]))
    columns = (*rates.COLUMNS, *rates.SECONDS)
    stem.with_suffix(".csv").write_bytes(rates.as_text(rows, columns).encode())
    objects = [{**vars(one), "bpv": one.bpv} for one in found]
    stem.with_suffix(".json").write_text(json.dumps(objects, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    command()
