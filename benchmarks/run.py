"""Sizes and errors of every mesh under every configuration: write or check `results.csv`."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import groupby, product
from pathlib import Path

import click
import corpus
import results
from measurement import CONFIGURATIONS, ERRORS, KEYS, Configuration, Row, measure

from deltamesh_cli.output import table

_EXAMPLES = """\
python benchmarks/run.py                  measure all, write results.csv
python benchmarks/run.py --check          compare with results.csv instead
python benchmarks/run.py --quick --check
python benchmarks/run.py --mesh bunny --mesh horse"""

# What is printed of a row; the file has all of it.
_SHOWN = (*KEYS[1:], "bytes", "bpv", "CONN", *ERRORS)


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
    default=results.RESULTS,
    help="Another file than benchmarks/results.csv.",
)
@click.option(
    "-j",
    "--jobs",
    type=click.IntRange(1),
    default=2,
    show_default=True,
    help="Measure so many rows at a time.",
)
def command(names: tuple[str, ...], quick: bool, check: bool, file: Path, jobs: int) -> None:
    """Measure sizes and errors of each mesh at the papers' bit depths.

    High-pass at 4 to 8 bits, with and without diffusion, and Cartesian at 8 to 12 bits, without
    isolated vertices. Rows of meshes that are not measured stay in results.csv as they are.
    Lengths are fractions of the bounding box diagonal.
    """
    start = time.perf_counter()
    chosen = corpus.chosen(names, quick)
    old = results.read(file)
    if check and not old:
        raise click.ClickException(f"there is nothing to compare with in {file}")
    rows = []
    for name, group in groupby(measured(chosen, jobs), key=lambda row: row["mesh"]):
        rows += (of_mesh := list(group))
        _print_mesh(name, of_mesh)
    click.echo(f"{len(rows)} rows in {time.perf_counter() - start:.0f} s", err=True)
    if check:
        _report(file, results.changes(old, rows), len(rows))
    else:
        results.write(file, results.merged(old, rows, corpus.NAMES))


def measured(names: tuple[str, ...], jobs: int) -> Iterator[Row]:
    """Yield the rows of the meshes, in order."""
    tasks = list(product(names, CONFIGURATIONS))
    if jobs == 1:
        yield from (measure(*task) for task in tasks)
        return
    # spawn is what every platform has; a forked child could inherit a lock of the solver's threads.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context) as pool:
        try:
            yield from pool.map(_measure, tasks)
        finally:
            pool.shutdown(cancel_futures=True)


def _measure(task: tuple[str, Configuration]) -> Row:
    return measure(*task)


def _print_mesh(name: str, rows: list[Row]) -> None:
    click.echo(f"\n{name}: {rows[0]['vertices']} vertices, {rows[0]['faces']} faces")
    click.echo(table([_SHOWN, *([row[column] for column in _SHOWN] for row in rows)]))


def _report(file: Path, changes: list[results.Change], count: int) -> None:
    """Print the changes; exit with 1 where there are any."""
    if not changes:
        click.echo(f"\n{count} rows are as in {file}")
        return
    heading = (*KEYS, "column", "before", "now")
    click.echo(f"\nnot as in {file}:\n{table([heading, *changes])}")
    raise SystemExit(1)


if __name__ == "__main__":
    command()
