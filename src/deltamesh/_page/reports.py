"""Reports: pages with a table of files and curves of it, and with as many of the files as fit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Final, Literal, TypeAlias

from deltamesh._page.filling import REPORT, PageFile, filled
from deltamesh_formats.printing import printable

Cell: TypeAlias = str | float | None

# Bytes of `.dmesh` files in a page: of one file, and of all. As text they take a quarter more.
MOST_OF_ONE: Final = 4 << 20
MOST_OF_ALL: Final = 24 << 20


@dataclass(frozen=True)
class Column:
    """A column of a report: its heading, and what is in its cells."""

    title: str
    kind: Literal["text", "number", "share"] = "number"


@dataclass(frozen=True)
class ReportRow:
    """A row of a report.

    Attributes
    ----------
    cells : sequence of str, float or None
        One for each column.
    files : sequence of int
        The files that are seen beside each other when the row is looked at.
    thumbnail : int or None
        The file whose picture the row has.
    without : str
        What stands there instead.
    series : str
        The curve that the row belongs to.
    beside : sequence of int
        The other rows whose files are among `files`.
    failed : bool
    """

    cells: Sequence[Cell]
    files: Sequence[int] = ()
    thumbnail: int | None = None
    without: str = ""
    series: str = ""
    beside: Sequence[int] = ()
    failed: bool = False


@dataclass(frozen=True)
class CurveColumns:
    """Columns of curves, by their numbers: the mesh, and sizes and errors to choose among."""

    mesh: int
    x: Sequence[int]
    y: Sequence[int]


@dataclass
class Travelling:
    """Files that travel in a page, as many as fit; `left` counts the others.

    Attributes
    ----------
    files : list of PageFile
    left : int
    most : int
        Bytes of all files.
    """

    files: list[PageFile] = field(default_factory=list)
    left: int = 0
    most: int = MOST_OF_ALL

    @property
    def room(self) -> int:
        """Bytes for which there is still room."""
        return self.most - sum(len(file.data) for file in self.files)

    def add(self, file: PageFile | None) -> int | None:
        """Add a file; return its number, None where there is none or it does not fit."""
        if file is None:
            return None
        if len(file.data) > min(MOST_OF_ONE, self.room):
            self.left += 1
            return None
        self.files.append(file)
        return len(self.files) - 1


def report_page(
    title: str,
    summary: Sequence[Sequence[str | int]],
    columns: Sequence[Column],
    rows: Sequence[ReportRow],
    travelling: Travelling,
    curves: CurveColumns | None = None,
) -> str:
    """Return a report as HTML.

    Parameters
    ----------
    title : str
    summary : sequence of rows
        A table whose first row is a head.
    columns : sequence of Column
    rows : sequence of ReportRow
    travelling : Travelling
    curves : CurveColumns, optional

    Raises
    ------
    DeltameshError
        If this installation was made without the page.
    """
    report = {
        "title": printable(title),
        "summary": [[_cell(one) for one in row] for row in summary],
        "notes": list(_notes(travelling)),
        "columns": [asdict(one) for one in columns],
        "rows": [{**asdict(row), "cells": [_cell(one) for one in row.cells]} for row in rows],
        "curves": None if curves is None else asdict(curves),
    }
    return filled(REPORT, travelling.files, title, {"report": report})


def _notes(travelling: Travelling) -> Sequence[str]:
    if not travelling.left:
        return ()
    inside, left = len(travelling.files), travelling.left
    room = f"{travelling.most / 2**20:.4g} MiB of meshes, {MOST_OF_ONE / 2**20:.4g} MiB of one file"
    return (
        f"Meshes in this page: {inside}. Left out, since the page has room for {room}: {left}.",
    )


def _cell(value: Cell) -> Cell:
    """Return a cell as JSON can express it."""
    if isinstance(value, str):
        return printable(value)
    return value if value is None or math.isfinite(value) else None
