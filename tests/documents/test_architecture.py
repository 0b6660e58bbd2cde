"""Pages for those who change the code: their paths exist, and their floors are enforced."""

from __future__ import annotations

import re
import tomllib

import pytest
from places import ROOT

PAGES = ("docs/architecture.md", "CONTRIBUTING.md")
PATH = re.compile(r"`((?:src|formats|cli|tests|docs|benchmarks)/[\w./-]+)`")


def text(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


@pytest.mark.parametrize("page", PAGES)
def test_every_path_leads_somewhere(page: str) -> None:
    paths = [path for path in PATH.findall(text(page)) if "NAME" not in path]
    assert len(paths) > 10
    assert [path for path in paths if not (ROOT / path).exists()] == []


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page: str) -> None:
    links = [link for link in re.findall(r"\]\(([^)]+)\)", text(page)) if "://" not in link]
    assert links
    for link in links:
        assert ((ROOT / page).parent / link.partition("#")[0]).exists(), link


def drawn(picture: str) -> list[set[str]]:
    """The names on each floor of a picture; a line without a number goes on with its floor."""
    floors: list[set[str]] = []
    for line in picture.splitlines():
        if line[:2].strip():
            floors.append(set())
        floors[-1] |= set(line[4:50].split())
    return floors


@pytest.mark.parametrize(
    ("package", "top"),
    [
        ("deltamesh", "plugins"),
        ("deltamesh_formats", "container"),
        ("deltamesh_cli", "program"),
    ],
)
def test_the_floors_are_those_of_the_contracts(package: str, top: str) -> None:
    contracts = tomllib.loads(text("pyproject.toml"))["tool"]["importlinter"]["contracts"]
    (layers,) = (c["layers"] for c in contracts if c.get("containers") == [package])
    (picture,) = re.findall(
        rf"```text\n( ?\d+  {top} .*?)```", text("docs/architecture.md"), re.DOTALL
    )
    assert drawn(picture) == [set(layer.split(" | ")) for layer in layers]


def test_the_glossary_is_in_order_and_has_no_word_twice() -> None:
    rows = re.findall(r"^\| ([^|]+) \| [^|]+ \|$", text("docs/architecture.md"), re.MULTILINE)
    words = rows[rows.index("anchor") :]
    assert len(words) >= 55
    assert words == sorted(set(words), key=str.lower)
