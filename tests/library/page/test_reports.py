"""Reports: rows as the page reads them, and as many files as fit."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import pytest

from deltamesh._page import reports
from deltamesh._page.filling import PageFile
from deltamesh._page.reports import Column, CurveColumns, ReportRow, Travelling, report_page


@pytest.fixture(autouse=True)
def template(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "report.html"
    path.write_text("<title>{title}</title><script>{facts}</script>\n{meshes}", encoding="utf-8")
    monkeypatch.setattr(reports, "REPORT", path)


def facts_of(page: str) -> Any:
    found = re.search(r"<script>(.*)</script>\n", page)
    assert found is not None
    return json.loads(found[1])["report"]


def file(size: int) -> PageFile:
    return PageFile("a", bytes(size), "", size)


def test_files_travel_while_there_is_room() -> None:
    travelling = Travelling(most=10)
    assert [travelling.add(file(size)) for size in (4, 7, 6, 1)] == [0, None, 1, None]
    assert travelling.add(None) is None
    assert (travelling.left, travelling.room) == (2, 0)


def test_no_file_is_too_large_for_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reports, "MOST_OF_ONE", 3)
    travelling = Travelling()
    assert [travelling.add(file(size)) for size in (3, 4)] == [0, None]
    notes = facts_of(report_page("t", [], [], [], travelling))["notes"]
    assert len(notes) == 1
    assert notes[0].startswith("Meshes in this page: 1. Left out")
    assert notes[0].endswith("room for 24 MiB of meshes, 2.861e-06 MiB of one file: 1.")


def test_rows_are_what_the_page_reads() -> None:
    rows = [
        ReportRow(["</script>\udcff\n", 2.5, math.nan, None], [0], 0, series="s", beside=[1]),
        ReportRow(["b", math.inf, 0, 1], without="left out", failed=True),
    ]
    columns = [Column("name", "text"), Column("x"), Column("y", "share"), Column("z")]
    travelling = Travelling([file(2)])
    page = report_page("<b>", [("a", 1)], columns, rows, travelling, CurveColumns(0, (1,), (2, 3)))
    page.encode()
    assert page.count("</script>") == 2
    assert page.startswith("<title>&lt;b&gt;</title>")
    found = facts_of(page)
    assert found["rows"][0]["cells"] == ["</script>\\udcff\\n", 2.5, None, None]
    assert found["rows"][1]["cells"] == ["b", None, 0, 1]
    assert [row["failed"] for row in found["rows"]] == [False, True]
    assert found["curves"] == {"mesh": 0, "x": [1], "y": [2, 3]}
    assert (found["summary"], found["notes"]) == ([["a", 1]], [])
    assert [one["kind"] for one in found["columns"]] == ["text", "number", "share", "number"]
