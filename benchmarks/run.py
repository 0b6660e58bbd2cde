"""Sizes and errors of every mesh under every configuration: write or check `results.csv`.

The rows are those of `deltamesh bench`; the file is committed, so that a change is a diff.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from itertools import groupby, product
from pathlib import Path

import click
import corpus
import pool

from deltamesh.bench import Change, Row, codec_of, measure
from deltamesh.bench import _rates as rates
from deltamesh_cli.output import table
from deltamesh_cli.rate_tables import change_table

_EXAMPLES = """\
python benchmarks/run.py                  measure all, write results.csv
python benchmarks/run.py --check          compare with results.csv instead
python benchmarks/run.py --quick --check
python benchmarks/run.py --mesh bunny --mesh horse"""

RESULTS = Path(__file__).parent / "results.csv"

# The papers' bit depths, as they round and as we do, and what quantizing x, y, z costs instead.
CODECS = (
    *(f"highpass bits={b}{how}" for b in (4, 5, 6, 7, 8) for how in ("", " diffusion=False")),
    *(f"refined bits={b}" for b in (4, 5, 6, 7, 8)),
    *(f"cartesian bits={b}" for b in (8, 9, 10, 11, 12)),
)

# What is printed of a row; the file has all of it.
_SHOWN = ("codec", "bytes", "bpv", *rates.ERRORS)


@click.command(epilog=corpus.epilog(_EXAMPLES))
@corpus.selection
@click.option(
    "--check",
    is_flag=True,
    help="Write nothing; exit with 1, and tell what changed, where a size differs from results.csv"
    " or an error by more than 1 %.",
)
@click.option(
    "--results",
    "file",
    type=click.Path(dir_okay=False, path_type=Path),
    default=RESULTS,
    help="Another file than benchmarks/results.csv.",
)
@pool.jobs
def command(names: tuple[str, ...], quick: bool, check: bool, file: Path, jobs: int) -> None:
    """Measure sizes and errors of each mesh at the papers' bit depths.

    High-pass at 4 to 8 bits, with and without diffusion, refined, and Cartesian at 8 to 12 bits,
    without isolated vertices. Rows of meshes that are not measured stay in results.csv as they are.
    Lengths are fractions of the bounding box diagonal.
    """
    start = time.perf_counter()
    chosen = corpus.chosen(names, quick)
    old = read(file)
    if check and not old:
        raise click.ClickException(f"there is nothing to compare with in {file}")
    rows = []
    for name, group in groupby(measured(chosen, jobs), key=lambda row: row["mesh"]):
        rows += (of_mesh := list(group))
        _print_mesh(name, of_mesh)
    click.echo(f"{len(rows)} rows in {time.perf_counter() - start:.0f} s", err=True)
    if check:
        _report(file, changes(old, rows), len(rows))
    else:
        file.write_bytes(rates.as_text(merged(old, rows)).encode())


def read(file: Path) -> list[Row]:
    """Return the rows of a file, none where there is no file."""
    return rates.from_text(file.read_text(encoding="utf-8")) if file.exists() else []


def measured(names: Iterable[str], jobs: int) -> Iterator[Row]:
    """Yield the rows of the meshes, in order."""
    return pool.each(row, product(names, CODECS), jobs)


def row(task: tuple[str, str]) -> Row:
    """Measure a mesh under a codec; in the table the mesh has the name of its file."""
    name, label = task
    return rates.row_of(measure(corpus.path(name).name, corpus.bare(name), codec_of(label)))


def merged(old: Iterable[Row], new: Iterable[Row]) -> list[Row]:
    """Return all rows, of measured meshes the new ones, by our order of the meshes."""
    order = [corpus.path(name).name for name in corpus.NAMES]
    rows = list(new)
    fresh = {row["mesh"] for row in rows}
    rows += [row for row in old if row["mesh"] not in fresh and row["mesh"] in order]
    return sorted(rows, key=lambda row: order.index(row["mesh"]))


def changes(old: Iterable[Row], new: Iterable[Row]) -> list[Change]:
    """Return what differs for the meshes of the new rows; sizes must be met exactly."""
    rows = list(new)
    names = {row["mesh"] for row in rows}
    return rates.changes((row for row in old if row["mesh"] in names), rows, tolerance=0)


def _print_mesh(name: str, rows: list[Row]) -> None:
    click.echo(f"\n{name}: {rows[0]['vertices']} vertices, {rows[0]['faces']} faces")
    click.echo(table([_SHOWN, *([row[column] for column in _SHOWN] for row in rows)]))


def _report(file: Path, found: list[Change], count: int) -> None:
    """Print the changes; exit with 1 where there are any."""
    if not found:
        click.echo(f"\n{count} rows are as in {file}")
        return
    click.echo(f"\nnot as in {file}:\n{change_table(found)}")
    raise SystemExit(1)


if __name__ == "__main__":
    command()
