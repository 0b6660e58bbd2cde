"""Tables of measurements, as CSV text, and the changes between two of them.

A row is text: counts in full, all else with four significant digits, for more would differ from
machine to machine. Rows that are kept have no times, which differ from run to run.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from deltamesh._geometry.bounds import POSITION_TOLERANCE
from deltamesh._measures.table import METRICS
from deltamesh.bench._measure import Measurement
from deltamesh_formats.errors import DeltameshError
from deltamesh_formats.printing import number

Row = dict[str, str]

KEYS: Final = ("mesh", "codec")
COUNTS: Final = ("vertices", "faces")
ERRORS: Final = tuple(metric.column for metric in METRICS)
COLUMNS: Final = (*KEYS, *COUNTS, "bytes", "bpv", *ERRORS, "sections")
SECONDS: Final = ("encode_seconds", "decode_seconds")

# By how much bytes and errors may grow. Machines and solvers round differently.
TOLERANCE: Final = 0.005
ERROR_TOLERANCE: Final = 0.01
# Errors that are as good as none: what decoding may differ by, in diagonals; and for angles, what
# that makes of an edge of a 1e-4th of the diagonal, in degrees.
_NOTHING: Final = {
    metric.column: POSITION_TOLERANCE if metric.is_length else 1e-3 for metric in METRICS
}


@dataclass(frozen=True)
class Change:
    """A difference between two tables.

    Attributes
    ----------
    mesh, codec : str
        The row.
    column : str
        "row" where the row itself has come or gone.
    before, now : str
    verdict : {"grew", "shrank", "changed", "gone", "new"}
        "changed" is of counts: it is another mesh.
    growth : float or None
        Relative; infinite from 0.
    """

    mesh: str
    codec: str
    column: str
    before: str
    now: str
    verdict: str
    growth: float | None = None

    @property
    def worse(self) -> bool:
        """Whether a gate should close: more bytes or errors, another mesh, or a row less."""
        return self.verdict in ("grew", "changed", "gone")


def row_of(measurement: Measurement) -> Row:
    """Return a measurement as text, times included."""
    one = measurement
    counts = {name: str(getattr(one, name)) for name in (*KEYS, *COUNTS, "bytes")}
    rest = {name: number(getattr(one, name)) for name in ("bpv", *ERRORS, *SECONDS)}
    return {**counts, **rest, "sections": _sections(one.sections)}


def _sections(sizes: Mapping[str, int]) -> str:
    """Return bytes by section; of a `.dmesh` all but the header."""
    return " ".join(f"{name}={size}" for name, size in sizes.items())


def as_text(rows: Iterable[Mapping[str, str]], columns: Sequence[str] = COLUMNS) -> str:
    """Return rows as CSV, with the line ends of Unix; values without a column are left out."""
    stream = io.StringIO()
    writer = csv.DictWriter(stream, columns, extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()


def from_text(text: str) -> list[Row]:
    """Return the rows of CSV text.

    Raises
    ------
    DeltameshError
        If a column is missing, or a value is not a number.
    """
    reader = csv.DictReader(io.StringIO(text))
    _check_columns(dict.fromkeys(reader.fieldnames or (), ""))
    rows = []
    for row in reader:
        _check_columns(row)
        for column in (*COUNTS, "bytes", *ERRORS):
            _check_number(row, column)
        rows.append(row)
    return rows


def _check_columns(row: Row) -> None:
    if missing := [column for column in COLUMNS if row.get(column) is None]:
        raise DeltameshError(f"this is no table of rates: no {', '.join(missing)}")


def _check_number(row: Row, column: str) -> None:
    try:
        float(row[column])
    except ValueError:
        where = f"{column} of {row['mesh']}, {row['codec']}"
        raise DeltameshError(f"{where} is not a number: {row[column]!r}") from None


def key(row: Mapping[str, str]) -> tuple[str, str]:
    """Return the mesh and the codec of a row."""
    return row["mesh"], row["codec"]


def changes(
    old: Iterable[Row],
    new: Iterable[Row],
    *,
    tolerance: float = TOLERANCE,
    error_tolerance: float = ERROR_TOLERANCE,
) -> list[Change]:
    """Return the differences between two tables that exceed the tolerances.

    Parameters
    ----------
    old, new : iterables of rows
    tolerance, error_tolerance : float
        Relative, of bytes and of errors.
    """
    before, after = ({key(row): row for row in rows} for rows in (old, new))
    found = [Change(*k, "row", "there", "none", "gone") for k in before if k not in after]
    for k, row in after.items():
        if k not in before:
            found.append(Change(*k, "row", "none", "there", "new"))
            continue
        was = before[k]
        found += [Change(*k, c, was[c], row[c], "changed") for c in COUNTS if was[c] != row[c]]
        found += _moved(was, row, ("bytes",), tolerance)
        found += _moved(was, row, ERRORS, error_tolerance)
    return found


def _moved(old: Row, new: Row, columns: Iterable[str], tolerance: float) -> list[Change]:
    """Return the columns that have grown or shrunk by more than the tolerance."""
    found = []
    for column in columns:
        a, b = float(old[column]), float(new[column])
        allowed = tolerance * abs(a) + _NOTHING.get(column, 0.0)
        if old[column] == new[column] or abs(b - a) <= allowed:
            continue
        verdict = "shrank" if b < a else "grew"  # NaN has grown
        growth = b / a - 1 if a else math.inf
        found.append(Change(*key(new), column, old[column], new[column], verdict, growth))
    return found
