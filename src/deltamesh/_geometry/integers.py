"""The integers of a geometry, exactly as they are entropy-coded."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.container.container import Parameters


@dataclass(frozen=True)
class Integers:
    """The integers of a geometry, exactly as they are entropy-coded.

    Attributes
    ----------
    values : int64 (n, 3)
        Quantized delta coordinates; or grid points, or bit patterns of binary64, with the isolated
        vertices last.
    anchors : int64 (k,)
    positions : int64 (k, 3)
        Grid points of the anchors.
    isolated : int64 (i, 3)
        Grid points of the isolated vertices.
    refinements : int64 (n, 1)
        Of the deltas along the normals; empty where there are none.
    corrections : int64 (n, 3)
        Of the positions, in steps; empty where there are none.
    forms : int64 (k,)
        Bytes that tell how bit patterns are spelled; empty where there are none.
    """

    values: NDArray[np.int64]
    anchors: NDArray[np.int64]
    positions: NDArray[np.int64]
    isolated: NDArray[np.int64]
    refinements: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 1), np.int64))
    corrections: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 3), np.int64))
    forms: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))


# What quantizing returns: what goes into the file, and what a decoder will make of it.
Quantized = tuple[Parameters, Integers, NDArray[np.float64]]


NONE = np.zeros(0, dtype=np.int64)


NO_POINTS = np.zeros((0, 3), dtype=np.int64)
