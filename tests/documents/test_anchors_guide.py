"""The tables of docs/anchors.md are what is measured."""

from __future__ import annotations

import importlib
import itertools
import re
import sys

import pytest
from places import BENCHMARKS, ROOT

from deltamesh._options import ANCHOR_METHODS

sys.path.append(str(BENCHMARKS))
corpus, anchors = map(importlib.import_module, ("corpus", "anchors"))

GUIDE = (ROOT / "docs" / "anchors.md").read_text(encoding="utf-8")
TABLES = [
    [tuple(row[2:-2].split(" | ")) for row in table.splitlines()]
    for table in re.findall(r"(?:^\|.*\n)+", GUIDE, re.MULTILINE)
]


def table(first: str) -> list[tuple[str, ...]]:
    """The rows of the table with a column of this name."""
    (found,) = (rows for rows in TABLES if first in rows[0])
    return found


def without_times(row: tuple[str, ...]) -> list[str]:
    """All that is measured but the seconds, which come last in each column."""
    return [row[0], row[1], *(column.rpartition(", ")[0] for column in row[2:])]


def test_every_choice_is_described() -> None:
    assert {row[0].strip("`") for row in table("`--anchor-method`")[2:]} == set(ANCHOR_METHODS)


@pytest.mark.parametrize("name", ["choices", "fits", "spikes"])
def test_its_headings_are_those_that_are_printed(name: str) -> None:
    made = {"choices": ((),), "fits": ((),), "spikes": ([], 0)}[name]
    heading = next(getattr(anchors, name)(*made))
    assert heading in [rows[0] for rows in TABLES]


def test_meshes_of_the_tables() -> None:
    for rows in (table("farthest"), table("0 bits, 1 %")):
        assert {row[0] for row in rows[2:]} == set(anchors.NAMES)


def test_its_figure_is_there() -> None:
    (name,) = re.findall(r"\]\((figures/[^)]+)\)", GUIDE)
    assert (ROOT / "docs" / name).read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["fandisk", "camelhead"])
def test_its_numbers_are_what_is_measured(name: str) -> None:
    if not corpus.path(name).is_file():
        pytest.skip(f"no {name} in {corpus.folder()}")
    fits = [row for row in table("0 bits, 1 %") if row[0] == name]
    assert list(itertools.islice(anchors.fits((name,)), 1, None)) == fits
    choices = [without_times(row) for row in table("farthest") if row[0] == name]
    assert [without_times(row) for row in itertools.islice(anchors.choices((name,)), 1, None)] == (
        choices
    )
