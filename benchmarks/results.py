"""`results.csv`: what was measured, committed, so that a change of sizes or errors is a diff."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path

from measurement import COLUMNS, ERRORS, EXACT, KEYS, Row

RESULTS = Path(__file__).parent / "results.csv"

# Machines and solvers round differently, so errors may move a little; sizes may not.
TOLERANCE = 0.01

Key = tuple[str, ...]
# The row's key, the column (or what became of the row), its text before and now.
Change = tuple[str, ...]


def key(row: Row) -> Key:
    """Return what a row is of."""
    return tuple(row[column] for column in KEYS)


def read(file: Path) -> list[Row]:
    """Return the rows of a file, none where there is no file."""
    if not file.exists():
        return []
    with file.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def write(file: Path, rows: Iterable[Row]) -> None:
    """Write rows in the order of the columns, with the line ends of Unix."""
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def merged(old: Iterable[Row], new: Iterable[Row], order: tuple[str, ...]) -> list[Row]:
    """Return all rows, of measured meshes the new ones, by the order of the meshes."""
    rows = list(new)
    measured = {row["mesh"] for row in rows}
    rows += [row for row in old if row["mesh"] not in measured and row["mesh"] in order]
    return sorted(rows, key=lambda row: order.index(row["mesh"]))


def changes(old: Iterable[Row], new: Iterable[Row]) -> list[Change]:
    """Return what differs between rows, for the meshes of the new ones."""
    after = {key(row): row for row in new}
    measured = {row["mesh"] for row in after.values()}
    before = {key(row): row for row in old if row["mesh"] in measured}
    found: list[Change] = [(*k, "row", "there", "gone") for k in before if k not in after]
    for k, row in after.items():
        if k not in before:
            found.append((*k, "row", "none", "new"))
            continue
        found += [(*k, c, before[k].get(c) or "", row[c]) for c in _changed(before[k], row)]
    return found


def _changed(old: Row, new: Row) -> Iterator[str]:
    """Yield the columns that differ by more than they may."""
    yield from (column for column in EXACT if old.get(column) != new[column])
    yield from (column for column in ERRORS if not _close(old.get(column), new[column]))


def _close(old: str | None, new: str) -> bool:
    if old == new:
        return True
    a, b = float(old or "nan"), float(new)
    return abs(a - b) <= TOLERANCE * max(abs(a), abs(b))
