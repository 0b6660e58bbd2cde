"""Printed measurements of `deltamesh bench`: tables, CSV, JSON, and changes of rates."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Final

import click

from deltamesh._measures.table import METRICS
from deltamesh_cli.failures import DONE, MISSED
from deltamesh_cli.output import display_name, message, print_json, table

if TYPE_CHECKING:
    from deltamesh.bench import Change, Measurement

# The headings of a table, and the column of a row under each.
_HEADINGS: Final = {
    "codec": "codec",
    "bytes": "bytes",
    "bits/vertex": "bpv",
    **{metric.heading: metric.column for metric in METRICS},
    "enc s": "encode_seconds",
    "dec s": "decode_seconds",
}


def print_table(path: str, measurements: Sequence[Measurement]) -> None:
    """Print the measurements of one mesh for people."""
    from deltamesh.bench import row_of

    if not measurements:
        return
    first, rows = measurements[0], [row_of(one) for one in measurements]
    click.echo(f"{display_name(path)}: {first.vertices} vertices, {first.faces} faces")
    cells = ([row[column] for column in _HEADINGS.values()] for row in rows)
    click.echo(f"{table([list(_HEADINGS), *cells])}\n")


def print_csv(measurements: Iterable[Measurement]) -> None:
    """Print all rows as CSV, including the times."""
    from deltamesh.bench import COLUMNS, SECONDS, as_text, row_of

    click.echo(as_text(map(row_of, measurements), (*COLUMNS, *SECONDS)), nl=False)


def print_objects(measurements: Iterable[Measurement]) -> None:
    """Print one JSON object per measurement, with lengths as fractions of the diagonal."""
    for one in measurements:
        print_json({**vars(one), "sections": dict(one.sections), "bits_per_vertex": one.bpv})


def report_changes(
    path: str, changed: Sequence[Change], count: int, *, as_json: bool, quiet: bool
) -> int:
    """Report the changes against a file, and return the exit code.

    Parameters
    ----------
    path : str
        Name of the file.
    changed : sequence of Change
    count : int
        Number of rows that were compared.
    as_json, quiet : bool
    """
    if changed:
        message(f"deltamesh: differences from {display_name(path)}:")
        message(change_table(changed))
    if as_json:
        for one in changed:
            print_json({"check": path, **vars(one), "worse": one.worse})
    elif not (quiet or changed):
        click.echo(f"{count} rows match {display_name(path)}")
    return MISSED if any(one.worse for one in changed) else DONE


def change_table(changed: Iterable[Change]) -> str:
    """Return the changes as a table."""
    heading = ("mesh", "codec", "column", "before", "now", "", "")
    return table([heading, *_change_rows(changed)])


def _change_rows(changed: Iterable[Change]) -> Iterator[tuple[str, ...]]:
    for one in changed:
        known = one.growth is not None and math.isfinite(one.growth)
        growth = f"{100 * one.growth:+.2f} %" if known and one.growth is not None else ""
        yield (one.mesh, one.codec, one.column, one.before, one.now, growth, one.verdict)
