"""Numbers of docs/paper.md: tables are what is measured now, and its sentences quote the tables.

Numbers in tables may differ by one in their last digit: machines and solvers round differently.
"""

from __future__ import annotations

import importlib
import re
import shlex
import sys
from itertools import zip_longest
from pathlib import Path

import pytest
from places import BENCHMARKS, ROOT

from deltamesh_cli.program import cli

sys.path.append(str(BENCHMARKS))
pages, paper, paper_models, renderings = map(
    importlib.import_module, ("pages", "paper", "paper_models", "renderings")
)

PAGE = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
NUMBER = re.compile(r"-?\d[\d,]*(?:\.\d+)?(?:e[-+]\d+)?")
# What a sentence may only quote: numbers with a point, an exponent or a thousands' comma, shares.
QUOTED = re.compile(r"(?<![\w./])[\u2212-]?\d+(?:,\d{3})*(?:\.\d+)?(?:e-\d+)?(?: %)?(?![\w.,]*\d)")
# Quoted from elsewhere: bits and counts that commands have, and are defined by.
GIVEN = {"1 %", "2 %", "0.1 %", "5,280", "1e-12"}
QUICK = [(name, mesh) for name, table in paper.TABLES.items() for mesh in table.quick]
SLOW = [(name, mesh) for name, table in paper.TABLES.items() for mesh in table.slow]


def rows(name: str) -> list[list[str]]:
    lines = pages.shown(PAGE, name).splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def same(shown: str, measured: str) -> bool:
    """Whether two cells have the same words, and numbers that differ by one digit at most."""
    if NUMBER.sub("#", shown) != NUMBER.sub("#", measured):
        return False
    pairs = zip(NUMBER.findall(shown), NUMBER.findall(measured), strict=True)
    return all(abs(value(one) - value(other)) <= 1.01 * unit(one) for one, other in pairs)


def value(number: str) -> float:
    return float(number.replace(",", ""))


def unit(number: str) -> float:
    """One in the last digit of a number; whole numbers are exact, unless they are large."""
    mantissa, _, exponent = number.replace(",", "").partition("e")
    places = len(mantissa.partition(".")[2])
    if not places and not exponent:
        return max(0.0, value(number) * 2e-3) if len(mantissa) > 3 else 0.5
    return float(10.0 ** (int(exponent or 0) - places))


def check(name: str, mesh: str) -> None:
    table = paper.TABLES[name]
    if not paper_models.is_there(mesh):
        pytest.skip(f"no {mesh} in the mesh folder")
    heading, _, *shown = rows(name)
    assert heading == list(table.heading)
    shown = [row for row in shown if row[0] == mesh]
    assert shown
    for row, measured in zip_longest(shown, table.measured([mesh]), fillvalue=()):
        assert len(row) == len(measured)
        faults = [pair for pair in zip(row, measured, strict=True) if not same(*pair)]
        assert not faults


@pytest.mark.parametrize(("name", "mesh"), QUICK)
def test_tables_are_what_is_measured(name: str, mesh: str) -> None:
    check(name, mesh)


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize(("name", "mesh"), SLOW)
def test_tables_are_what_is_measured_of_large_meshes(name: str, mesh: str) -> None:
    check(name, mesh)


@pytest.mark.parametrize("name", paper.TABLES)
def test_tables_are_of_their_meshes(name: str) -> None:
    table = paper.TABLES[name]
    assert table.quick
    assert list(dict.fromkeys(row[0] for row in rows(name)[2:])) == [*table.quick, *table.slow]


def quoted(text: str) -> set[str]:
    """The numbers of a section's sentences, those that it may only quote."""
    prose = re.sub(r"```.*?```|^[|>!][^\n]*$|`[^`]*`", "", text, flags=re.DOTALL | re.MULTILINE)
    found = {one.lstrip("\u2212-") for one in QUOTED.findall(" ".join(prose.split()))}
    return {one for one in found if re.search(r"[.,%e]", one)}


def sections() -> list[tuple[str, str]]:
    return re.findall(r"^## (.*?)\n(.*?)(?=^## |\Z)", PAGE, re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize(("title", "text"), sections())
def test_sentences_quote_the_tables(title: str, text: str) -> None:
    cells = " ".join(re.findall(r"^\|.*$", text, re.MULTILINE))
    known = {one.lstrip("-") for one in QUOTED.findall(cells)} | GIVEN
    assert quoted(text) <= known, f"{title}: {sorted(quoted(text) - known)}"


def test_there_are_many_quotes() -> None:
    assert sum(len(quoted(text)) for _, text in sections()) > 40


def test_sections_have_tables_figures_and_commands_that_are_there() -> None:
    assert sorted(re.findall(r"^<!-- table: (.*) -->$", PAGE, re.MULTILINE)) == sorted(paper.TABLES)
    files = re.findall(r"^!\[.+\]\(figures/(.+)\.png\)$", PAGE, re.MULTILINE)
    assert {*renderings.PAPER} <= {*files}
    for file in files:
        assert (ROOT / "docs" / "figures" / f"{file}.png").is_file()
    for file in renderings.PAPER:
        assert (ROOT / "docs" / "figures" / f"{file}.png").stat().st_size < 60_000
    for link in re.findall(r"\]\(([^)#]+)[^)]*\)", PAGE):
        assert (ROOT / "docs" / link).exists(), link
    lines = "\n".join(re.findall(r"^```sh\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE))
    for line in filter(None, lines.splitlines()):
        program, name, *arguments = shlex.split(line)
        if program == "deltamesh":
            command = cli.get_command(None, name)
        else:
            command = importlib.import_module(Path(name).stem).command
        command.make_context(name, arguments)


def test_a_command_prints_what_the_page_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    from click.testing import CliRunner

    monkeypatch.setenv("DELTAMESH_MESHES", str(ROOT / "docs"))  # where no mesh is
    done = CliRunner().invoke(paper.command, ["topology", "--quick"])
    assert done.exit_code == 0
    for line in done.output.strip().splitlines()[2:]:
        assert line in PAGE
    done = CliRunner().invoke(paper.command, ["weights"])
    assert done.stderr.splitlines() == [
        f"weights: skipped, no {name}" for name in ("camelhead", "screwdriver")
    ]


def test_a_table_is_replaced_alone() -> None:
    other = pages.replaced(PAGE, "modes", "| a |\n| --- |")
    assert pages.shown(other, "modes") == "| a |\n| --- |"
    assert pages.shown(other, "rows") == pages.shown(PAGE, "rows")
    assert pages.replaced(other, "modes", pages.shown(PAGE, "modes")) == PAGE


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        ("3.5e-04 (48,448)", True),
        ("3.6e-04 (48,450)", True),
        ("3.7e-04 (48,448)", False),
        ("3.5e-04 (49,448)", False),
        ("3.5e-05 (48,448)", False),
        ("3.5e-04 of 48,448", False),
    ],
)
def test_what_counts_as_the_same(other: str, expected: bool) -> None:
    assert same("3.5e-04 (48,448)", other) is expected
