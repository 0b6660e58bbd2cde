"""Report of what became of the shape of a mesh: its worst part, and faces that it has lost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from deltamesh._measures.measure import Measured
from deltamesh._measures.named_parts import NamedParts
from deltamesh_formats.array_types import Bools, Ints


@dataclass(frozen=True)
class WorstPart:
    """The part that is kept worst; see `parts.PartErrors.worst`.

    Attributes
    ----------
    name : str
    normal_deviation : float
        In degrees.
    relative_rms : float
        RMS distance over the part's own diagonal.
    """

    name: str
    normal_deviation: float
    relative_rms: float


@dataclass(frozen=True)
class Report:
    """Report of what became of the shape of a mesh.

    Attributes
    ----------
    parts : int
        Number of parts.
    worst : WorstPart or None
        None for a mesh of one part.
    lost, turned : int64 (k,)
        The polygon of each triangle that had an area and has lost it, or that has turned over;
        ascending.
    area : float
        Of the surface, over what it was.
    """

    parts: int
    worst: WorstPart | None
    lost: Ints
    turned: Ints
    area: float


def report_of(measured: Measured, named: NamedParts) -> Report:
    """Return the report of what was measured."""
    parts, worst = measured.parts, None
    if parts is not None and len(parts.diagonal) > 1:
        i = parts.worst
        rms = float(parts.relative_rms[i])
        worst = WorstPart(named.name(i), float(parts.normal_deviation[i]), rms)
    return Report(
        parts=1 if parts is None else len(parts.diagonal),
        worst=worst,
        lost=_polygons(named.polygons, measured.lost),
        turned=_polygons(named.polygons, measured.turned),
        area=measured.area,
    )


def _polygons(polygons: Ints, which: Bools | None) -> Ints:
    return np.sort(polygons[which]) if which is not None else polygons[:0]
