"""How large our file is at a given error: what a comparison with another codec has to ask.

A codec with one free setting, its knob, is a curve of errors and sizes. The size at an error is
that of a file, found by coding until the error is met within 1 %, or is interpolated between coded
points. Errors need not grow all along: a surface so coarse that it is smooth again can have the
dihedral angles of a much finer one. So the curve is walked from its fine end, and it is its first
crossing of the error that counts; and where it never gets so bad, its worst point.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from deltamesh._measures.metrics import diagonal, vertex_errors
from deltamesh._mesh import TriangleMesh
from deltamesh.bench import codec_of

# How far below the error that is asked for a size still counts as one at that error.
CLOSE = 0.99
MOST_TRIES = 12
# Where a curve begins and ends, over the default step: that is a quarter of the diagonal; and the
# ratio of neighbouring settings, in a search and for interpolation.
FINE_END, COARSE_END = 1 / 16, 256
SPACING, CLOSE_SPACING = 2.0, math.sqrt(2)


class Point(NamedTuple):
    """A file: bytes of all of it, RMS over the diagonal, angles in degrees."""

    size: int
    rms: float
    normals: float
    dihedral: float


Curve = Callable[[float], Point]


def point(label: str, mesh: TriangleMesh) -> Point:
    """Code a mesh, decode the file, and compare.

    Raises
    ------
    DeltameshError
    """
    coded = codec_of(label).code(mesh)
    V, W, F = coded.reference.vertices, coded.decoded.vertices, coded.decoded.faces
    errors = vertex_errors(V, W, F)
    unit = diagonal(V) or 1.0
    return Point(coded.size, errors.rms / unit, errors.normal_deviation, errors.dihedral)


def knob(label: str) -> str:
    """Return the option that is free: the step, where a method has one of its own."""
    return "step" if label.split()[0] in ("highpass", "refined", "cartesian") else "normal_error"


# Where a search for a step begins, in diagonals of the bounding box.
FIRST_STEP = 1 / 1000


class Coder:
    """A codec and a mesh as a curve; each point is coded once."""

    def __init__(self, label: str, mesh: TriangleMesh) -> None:
        self.label, self.mesh = label, mesh
        self.points: dict[float, Point] = {}
        scale = FIRST_STEP * diagonal(mesh.vertices)
        self.start = scale if knob(label) == "step" else 1.0

    def __call__(self, setting: float) -> Point:
        """Return the point at a setting of the knob."""
        if setting not in self.points:
            option = f"{knob(self.label)}={setting!r}"
            self.points[setting] = point(f"{self.label} {option}", self.mesh)
        return self.points[setting]


def crossing(coder: Coder, error: str, target: float, spacing: float) -> tuple[float, float]:
    """Return neighbouring settings, the error of the finer within the target, of the other beyond.

    Where the error is never so large, both are the setting at which it is largest.

    Parameters
    ----------
    coder : Coder
    error : {"rms", "normals", "dihedral"}
    target : float
    spacing : float
        The ratio of the settings.

    Raises
    ------
    DeltameshError
        If the codec cannot go so far.
    """
    setting = worst = coder.start * FINE_END
    while getattr(coder(setting), error) > target:
        setting /= spacing
    while setting < coder.start * COARSE_END:
        here = getattr(coder(setting * spacing), error)
        if here > target:
            return setting, setting * spacing
        setting *= spacing
        worst = setting if here > getattr(coder(worst), error) else worst
    return worst, worst


def coded_at(coder: Coder, error: str, target: float) -> Point:
    """Return a point whose error is the target or up to 1 % less; less where the curve jumps.

    The arguments and what is raised are those of `crossing`.
    """
    below, above = crossing(coder, error, target, SPACING)
    aim = math.sqrt(CLOSE) * target
    for _ in range(MOST_TRIES):
        low, high = getattr(coder(below), error), getattr(coder(above), error)
        if low >= CLOSE * target or below == above:
            break
        share = math.log(aim / low) / math.log(high / low) if low > 0 else 0.5
        setting = below * (above / below) ** min(max(share, 0.1), 0.9)
        if getattr(coder(setting), error) <= target:
            below = setting
        else:
            above = setting
    return coder(below)


def interpolated_at(coder: Coder, error: str, target: float) -> Point:
    """Return the point at an error, on a straight line between the logarithms of two coded points.

    The arguments and what is raised are those of `crossing`.
    """
    below, above = crossing(coder, error, target, CLOSE_SPACING)
    if below == above:
        return coder(below)
    logs = np.log(np.maximum([coder(below), coder(above)], 1e-30))
    low, high = logs[:, Point._fields.index(error)]
    share = (math.log(target) - low) / (high - low)
    size, *errors = np.exp(logs[0] + share * (logs[1] - logs[0]))
    return Point(round(size), *map(float, errors))
