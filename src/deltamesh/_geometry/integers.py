"""Integers of a geometry, exactly as they are entropy-coded."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.container import Parameters

NONE: Final = np.zeros(0, dtype=np.int64)
NO_POINTS: Final = np.zeros((0, 3), dtype=np.int64)
NO_CELLS: Final = np.zeros((0, 0, 3), dtype=np.int64)


@dataclass(frozen=True)
class Integers:
    """The integers of a geometry, exactly as they are entropy-coded.

    Attributes
    ----------
    values : int64 (n, 3)
        Quantized delta coordinates; or, without anchors, grid points or bit patterns of binary64,
        with the isolated vertices last.
    anchors : int64 (k,)
    positions : int64 (k, 3)
        Grid points of the anchors.
    isolated : int64 (i, 3)
        Grid points of the isolated vertices, where there are anchors.
    cells : int64 (s, c, 3)
        Of interpolated anchors, at each of s stages, what the cells of c anchors have lost; see
        `cells`.
    units : int64 (s,)
        Of these, in octaves above the step.
    refinements : int64 (n, 1)
        Of the deltas along the normals.
    corrections : int64 (n, 3)
        Of the positions, in steps.
    formats : int64 (k,)
        Bytes of the number formats of the bit patterns.
    exponents : int64 (n,)
        Of the steps of the vertices of the faces, in quarters of an octave, where steps differ; see
        `steps`.

    All but the values are empty in a method that has none of them.
    """

    values: Ints
    anchors: Ints = field(default_factory=lambda: NONE)
    positions: Ints = field(default_factory=lambda: NO_POINTS)
    isolated: Ints = field(default_factory=lambda: NO_POINTS)
    cells: Ints = field(default_factory=lambda: NO_CELLS)
    units: Ints = field(default_factory=lambda: NONE)
    refinements: Ints = field(default_factory=lambda: NONE.reshape(0, 1))
    corrections: Ints = field(default_factory=lambda: NO_POINTS)
    formats: Ints = field(default_factory=lambda: NONE)
    exponents: Ints = field(default_factory=lambda: NONE)


def without_deltas(integers: Integers) -> Integers:
    """Return integers whose deltas and refinements are zeros that take no memory."""
    shapes = integers.values.shape, integers.refinements.shape
    values, refinements = (np.broadcast_to(np.int64(0), shape) for shape in shapes)
    return replace(integers, values=values, refinements=refinements)


# Parameters and integers of a file, and the positions that a decoder will make of them.
Quantized = tuple[Parameters, Integers, Floats]
