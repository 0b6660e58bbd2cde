"""Report of `deltamesh bench`: measurements, their curves, and the meshes at equal bytes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from deltamesh._measures.table import METRICS
from deltamesh._page.filling import PageFile
from deltamesh._page.reports import Column, CurveColumns, ReportRow, Travelling, report_page
from deltamesh.bench import PEER_NAMES
from deltamesh_cli.failures import attempt
from deltamesh_formats.places import status

if TYPE_CHECKING:
    from deltamesh.bench import Coded, Measurement, Views

_ERRORS: Final = tuple(
    Column(f"{one.title} / diagonal" if one.is_length else f"{one.title}, °") for one in METRICS
)
_COLUMNS: Final = (
    Column("mesh", "text"),
    Column("codec", "text"),
    Column("bytes"),
    Column("bits/vertex"),
    *_ERRORS,
    Column("encode, s"),
    Column("decode, s"),
)
_CURVES: Final = CurveColumns(0, (2, 3), tuple(range(4, 4 + len(_ERRORS))))


@dataclass
class BenchReport:
    """Report of measurements, made mesh by mesh, since no two meshes are kept at a time.

    Attributes
    ----------
    meshes : int
        How many are still to come; all get the same share of the room in the page.
    """

    meshes: int
    rows: list[ReportRow] = field(default_factory=list)
    travelling: Travelling = field(default_factory=lambda: Travelling())
    views: Views | None = None
    measured: list[tuple[Measurement, PageFile | None]] = field(default_factory=list)

    @contextmanager
    def mesh(self, name: str, path: str) -> Iterator[None]:
        """Take the measurements of a mesh inside, from a file of this path."""
        from deltamesh.bench import Views

        with attempt(path, "cannot read"):
            self.views, self.measured = Views(name, status(path)[0]), []
        yield
        with attempt(path, "cannot show"):
            self._end()

    def add(self, measurement: Measurement, coded: Coded) -> None:
        """Add a measurement of the mesh."""
        assert self.views is not None
        self.measured.append((measurement, self.views.file(measurement.codec, coded)))

    def _end(self) -> None:
        """End with a mesh: as many of its files travel as its share has room for."""
        assert self.views is not None
        share = Travelling(self.travelling.files, most=0)
        share.most = self.travelling.most - self.travelling.room
        share.most += self.travelling.room // max(self.meshes, 1)
        self.meshes -= 1
        original = share.add(self.views.original()) if self.measured else None
        sizes = [one.bytes for one, _ in self.measured]
        names = [one.codec.split()[0] for one, _ in self.measured]
        own = [i for i, name in enumerate(names) if name not in PEER_NAMES]
        order = [j for i in own for j in (i, *_nearest(i, sizes, names))]
        order = list(dict.fromkeys([*order, *range(len(names))]))
        numbers = {i: share.add(self.measured[i][1]) for i in order}
        self.travelling.left += share.left
        held = [i for i, number in numbers.items() if number is not None]
        first = len(self.rows)
        for i, (one, file) in enumerate(self.measured):
            beside = _nearest(i, sizes, names, held) if i in held else []
            seen = [original, *(numbers[j] for j in sorted([i, *beside]))]
            number = numbers[i]
            self.rows.append(
                ReportRow(
                    _cells(one),
                    files=[] if number is None else [j for j in seen if j is not None],
                    thumbnail=number,
                    without="" if file is None else "left out",
                    series=names[i],
                    beside=[first + j for j in beside],
                )
            )

    def page(self) -> str:
        """Return the page."""
        meshes = {row.cells[0] for row in self.rows}
        summary = [("meshes", "measurements"), (f"{len(meshes)}", f"{len(self.rows)}")]
        return report_page(
            "deltamesh bench", summary, _COLUMNS, self.rows, self.travelling, _CURVES
        )


def _cells(one: Measurement) -> list[str | float]:
    errors = [getattr(one, metric.column) for metric in METRICS]
    seconds = one.encode_seconds, one.decode_seconds
    return [one.mesh, one.codec, one.bytes, one.bpv, *errors, *seconds]


def _nearest(
    i: int, sizes: list[int], names: list[str], among: Iterable[int] | None = None
) -> list[int]:
    """Return of each peer the one that is nearest in size to ours; of a peer, the one of ours."""
    others = range(len(sizes)) if among is None else among
    is_peer = names[i] in PEER_NAMES
    best: dict[str, int] = {}
    for j in others:
        if (names[j] in PEER_NAMES) == is_peer:
            continue
        kind = names[j] if not is_peer else ""
        if kind not in best or _apart(sizes[j], sizes[i]) < _apart(sizes[best[kind]], sizes[i]):
            best[kind] = j
    return list(best.values())


def _apart(size: int, other: int) -> float:
    return abs(math.log(max(size, 1) / max(other, 1)))
