"""Report of `deltamesh batch`: a row for each file, whether it is done or not."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final

from deltamesh._page.filling import PageFile
from deltamesh._page.reports import MOST_OF_ONE, Column, ReportRow, Travelling, report_page
from deltamesh.batch import DONE, FAILED, SKIPPED, Record, Task, record_key
from deltamesh_cli import files
from deltamesh_cli.batch.report import BEFORE
from deltamesh_cli.failures import Failure
from deltamesh_cli.output import display_name

NOT_YET: Final = "not done yet"
_STATES: Final = (DONE, BEFORE, SKIPPED, FAILED, NOT_YET)
_COLUMNS: Final = (
    Column("file", "text"),
    Column("state", "text"),
    Column("bytes in"),
    Column("bytes out"),
    Column("out/in", "share"),
    Column("vertices"),
    Column("faces"),
    Column("RMS / diagonal"),
    Column("max / diagonal"),
    Column("face normals, °"),
    Column("dihedral angles, °"),
    Column("worst part", "text"),
    Column("its normals, °"),
    Column("seconds"),
    Column("notes", "text"),
)


def page_of_batch(
    planned: Iterable[Task | Record],
    records: Mapping[tuple[str, str], tuple[Record, bool]],
    decode: bool,
) -> str:
    """Return the page of a batch: a row a file, whether it is done or not.

    Parameters
    ----------
    planned : iterable of Task or Record
    records : mapping
        The record of each (source, target) that has one, and whether an earlier run made it.
    decode : bool
        Whether `.dmesh` files are decoded.
    """
    travelling = Travelling()
    rows = []
    files_of, bytes_in, bytes_out = Counter[str](), Counter[str](), Counter[str]()
    for one in planned:
        key = (one.source, one.target) if isinstance(one, Task) else record_key(one)
        record, before = records.get(key, ({"status": NOT_YET}, False))
        state = BEFORE if before else record["status"]
        files_of[state] += 1
        bytes_in[state] += record.get("source_bytes") or 0
        bytes_out[state] += record.get("target_bytes") or 0
        rows.append(_row(key, record, state, decode, travelling))
    summary: list[tuple[str | int, ...]] = [("", "files", "bytes in", "bytes out")]
    summary += [
        (state, files_of[state], bytes_in[state], bytes_out[state])
        for state in _STATES
        if files_of[state]
    ]
    return report_page("deltamesh batch", summary, _COLUMNS, rows, travelling)


def _row(
    key: tuple[str, str], record: Record, state: str, decode: bool, travelling: Travelling
) -> ReportRow:
    number, without = None, ""
    if record["status"] == DONE:
        file, without = _dmesh_of(key[0] if decode else key[1], record, decode)
        travelling.left += without == "left out"
        number = travelling.add(file)
        without = without or ("left out" if number is None else "")
    return ReportRow(
        _cells(key[0], record, state),
        files=[] if number is None else [number],
        thumbnail=number,
        without=without,
        failed=record["status"] == FAILED,
    )


def _dmesh_of(path: str, record: Record, decode: bool) -> tuple[PageFile | None, str]:
    """Return the `.dmesh` of a file that is done, or why it is not in the page."""
    size = record["source_bytes" if decode else "target_bytes"]
    if size > MOST_OF_ONE:
        return None, "left out"
    try:
        data = files.read_input(path)
    except Failure:
        return None, "unreadable"
    return PageFile(os.path.basename(path), data, "", size), ""


def _cells(source: str, record: Record, state: str) -> list[str | float | None]:
    size, made = record.get("source_bytes"), record.get("target_bytes")
    errors: dict[str, Any] = record.get("errors") or {}
    part: dict[str, Any] = errors.get("worst_part") or {}
    names = ("rms_relative", "max_relative", "normal_deviation_degrees", "dihedral_degrees")
    return [
        display_name(source),
        state,
        size,
        made,
        made / size if made and size else None,
        record.get("vertices"),
        record.get("faces"),
        *map(errors.get, names),
        part.get("name", ""),
        part.get("normal_deviation_degrees"),
        record.get("seconds"),
        "; ".join(_notes(record)),
    ]


def _notes(record: Record) -> Iterator[str]:
    if "message" in record:
        yield record["message"]
    yield from record.get("notes", ())
    if record.get("not_kept"):
        yield f"not kept: {', '.join(record['not_kept'])}"
