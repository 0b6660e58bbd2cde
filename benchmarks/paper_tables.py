"""Table of measurements: its rows are of meshes, which may be missing."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from pages import lines
from paper_models import Model, is_there, model

Row = tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """A table of `docs/paper.md`.

    Attributes
    ----------
    name : str
    heading : tuple of str
        The first is of the meshes.
    rows : callable
        Makes the rows of a mesh, all but the first cell of each.
    quick, slow : tuples of str
        Meshes that tests always measure, and those that take longer or are of the mesh folder.
    """

    name: str
    heading: Row
    rows: Callable[[Model], Iterable[Row]]
    quick: tuple[str, ...]
    slow: tuple[str, ...]

    def measured(self, names: Sequence[str]) -> list[Row]:
        """Return the rows of some meshes, those that are there."""
        return [(name, *row) for name in names if is_there(name) for row in self.rows(model(name))]


def markdown(table: Table, rows: Iterable[Row]) -> str:
    """Return a table as a page has it."""
    return "\n".join(lines([table.heading, *rows]))


def small(x: float) -> str:
    """Return a length over the diagonal, two digits; rounding errors are 0."""
    return f"{x:.1e}" if x > 1e-12 else "0"


def share(x: float) -> str:
    """Return a share in percent."""
    return f"{100 * x:.1f} %"
