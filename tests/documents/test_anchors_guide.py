"""The tables of docs/anchors.md are what is measured."""

from __future__ import annotations

import importlib
import itertools
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from places import BENCHMARKS, ROOT

from deltamesh._geometry.interpolation import TOLERANCE
from deltamesh._graph.halfedges import ends, pair_halfedges
from deltamesh._options import ANCHOR_METHODS

sys.path.append(str(BENCHMARKS))
corpus, anchors, anchor_picture, spikes = map(
    importlib.import_module, ("corpus", "anchors", "anchor_picture", "spikes")
)

GUIDE = (ROOT / "docs" / "anchors.md").read_text(encoding="utf-8")
TEXT = " ".join(GUIDE.split())
RANGE_MAP = "face000_rangemap.ply"
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


@pytest.mark.parametrize("rows", [anchors.choices(()), anchors.fits(()), spikes.spikes([])])
def test_its_headings_are_those_that_are_printed(rows: Iterator[tuple[str, ...]]) -> None:
    assert next(rows) in [rows[0] for rows in TABLES]


def test_meshes_of_the_tables() -> None:
    for rows in (table("farthest"), table("0 bits, 1 %")):
        assert {row[0] for row in rows[2:]} == set(anchors.NAMES)


def test_its_figure_is_there() -> None:
    (name,) = re.findall(r"\]\((figures/[^)]+)\)", GUIDE)
    assert (ROOT / "docs" / name).read_bytes().startswith(b"\x89PNG")


def rows_of_spikes() -> list[spikes.Row]:
    return table(spikes.DISTANCE)[2:]


def column(name: str, least: int = 0) -> dict[str, float]:
    """The cells of meshes of so many vertices or more."""
    at = spikes.HEADING.index(name)
    rows = [row for row in rows_of_spikes() if int(row[1]) >= least and row[at] != "-"]
    return {row[0]: float(row[at]) for row in rows}


def test_the_largest_are_those_of_the_table() -> None:
    heading, _, *rows = table("median")
    assert [heading, *rows] == list(spikes.summary(rows_of_spikes()))


def test_spikes_have_as_many_meshes_as_it_says() -> None:
    names = [row[0] for row in rows_of_spikes()]
    assert len(names) == 1 + 43 + 12
    assert (names[0], names[-12], names[-1]) == ("torus.ply", "alligator.obj", "woody.obj")
    assert (max(column("components").values()), max(column("valence").values())) == (498, 969)
    vertices = column("vertices")
    largest = max(vertices, key=vertices.__getitem__)
    assert 500_000 < vertices[largest] < 600_000
    assert f"{largest} has {column('anchors')[largest]:.0f} for 498 components" in TEXT


def test_what_it_says_of_spikes_and_distances_is_in_the_tables() -> None:
    distances, least = column(spikes.DISTANCE), spikes.LEAST
    assert max(distances.values()) == distances["comments.off"] <= TOLERANCE / 10
    assert max(column(spikes.DISTANCE, least).values()) < 1e-5
    assert max(column("largest", least).values()) < 1
    assert f"some err up to {max(column('without fit: largest').values()):.0f} times" in TEXT
    assert np.median([*column("deltas", least).values()]) == pytest.approx(1.1, abs=0.05)
    assert max(column("deltas", least), key=column("deltas").__getitem__) == RANGE_MAP
    worst = column("without fit: deltas")
    assert max(worst, key=worst.__getitem__) == corpus.path(anchor_picture.WORST).name
    assert 1.5 < column("deltas")["sphere.off"] < column("deltas")["tank.obj"] < 2


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


def alike(shown: spikes.Row, measured: spikes.Row) -> bool:
    """Whether rows agree but for rounding, and what the solver leaves of its tolerance."""
    at = len(spikes.HEADING) - len(spikes.RATIOS) - 1
    numbers = [[float(cell) for cell in row[at:-1] if cell != "-"] for row in (shown, measured)]
    return (
        shown[:at] == measured[:at]
        and numbers[0] == pytest.approx(numbers[1], abs=0.011)
        and max(float(shown[-1]), float(measured[-1])) <= TOLERANCE
    )


def test_the_spikes_of_our_mesh_are_what_is_measured() -> None:
    assert alike(rows_of_spikes()[0], spikes.row_of(corpus.path(corpus.GENERATED)))


# One with boundaries, many components, a hub, edges of four faces.
SAMPLE = ("fandisk.obj", "fairing_cross_binary.off", "cycloidal.ply", "twin_7081_left.obj")


@pytest.mark.slow
@pytest.mark.parametrize("name", [*SAMPLE, "cube_40k.obj"])
def test_its_spikes_are_what_is_measured(name: str) -> None:
    (shown,) = (row for row in rows_of_spikes() if row[0] == name)
    assert alike(shown, spikes.row_of(file_of(name)))


def file_of(name: str) -> Path:
    found = [file for file in corpus.files() if file.name == name]
    return found[0] if found else pytest.skip(f"no {name} in {corpus.folder()}")


@pytest.mark.slow
def test_anchors_of_the_range_map_err_no_more_than_its_boundaries() -> None:
    one = spikes.file_of(file_of(RANGE_MAP))
    faces, chosen = one.surface.faces, one.integers.anchors
    error, at_boundary = one.errors(one.decoded), np.zeros(len(one.V), dtype=bool)
    alone = pair_halfedges(faces) < 0
    for end in ends(faces):
        at_boundary[end[alone]] = True
    assert at_boundary[chosen].mean() > 0.6
    others = at_boundary.copy()
    others[chosen] = False
    assert (error[others] ** 2).mean() > (error[chosen] ** 2).mean()
