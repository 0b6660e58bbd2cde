"""How large our file is at a given error: what a comparison with another codec has to ask.

A codec with one free setting, its knob, is a curve of sizes over errors. The size at an error is
that of a file, found by coding until the error is met within 1 %, or is interpolated between coded
points.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from deltamesh.bench import codec_of
from deltamesh.mesh import Mesh
from deltamesh.metrics import diagonal, vertex_errors
from deltamesh.options import DEFAULT_HIGHPASS_STEP

# How far below the error that is asked for a size still counts as one at that error.
CLOSE = 0.99
MOST_TRIES = 12
# Neighbouring points of a curve: knobs in this ratio.
SPACING = math.sqrt(2)
WIDEST = 40


class Point(NamedTuple):
    """A file: bytes of all of it, RMS over the diagonal, angles in degrees."""

    size: int
    rms: float
    normals: float
    dihedral: float


Curve = Callable[[float], Point]


def point(label: str, mesh: Mesh) -> Point:
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


class Coder:
    """A codec and a mesh as a curve; each point is coded once."""

    def __init__(self, label: str, mesh: Mesh) -> None:
        self.label, self.mesh = label, mesh
        self.points: dict[float, Point] = {}
        scale = DEFAULT_HIGHPASS_STEP * diagonal(mesh.vertices)
        self.start = scale if knob(label) == "step" else 1.0

    def __call__(self, setting: float) -> Point:
        """Return the point at a setting of the knob."""
        if setting not in self.points:
            option = f"{knob(self.label)}={setting!r}"
            self.points[setting] = point(f"{self.label} {option}", self.mesh)
        return self.points[setting]


def coded_at(coder: Coder, error: str, target: float) -> Point:
    """Return a point whose error is the target or up to 1 % less, where the curve has one.

    Curves jump here and there; then it is the smallest of the files that are no worse.

    Parameters
    ----------
    coder : Coder
    error : {"rms", "normals", "dihedral"}
    target : float

    Raises
    ------
    LookupError
        If all files were worse.
    DeltameshError
        If the codec cannot go so far.
    """
    setting = coder.start if not coder.points else _nearest(coder, error, target)
    for _ in range(MOST_TRIES):
        here = coder(setting)
        if CLOSE * target <= getattr(here, error) <= target:
            return here
        setting = _next(coder, error, math.sqrt(CLOSE) * target, setting)
    good = [one for one in coder.points.values() if getattr(one, error) <= target]
    if not good:
        raise LookupError(f"{coder.label}: no {error} error of {target:g}")
    return min(good)


def _nearest(coder: Coder, error: str, target: float) -> float:
    return min(coder.points, key=lambda x: abs(math.log(getattr(coder.points[x], error) / target)))


def _next(coder: Coder, error: str, target: float, setting: float) -> float:
    """Return a setting between the closest on both sides, or beyond all of them."""
    errors = {x: getattr(p, error) for x, p in coder.points.items()}
    below = max((x for x, e in errors.items() if e <= target), default=None)
    above = min((x for x, e in errors.items() if e > target), default=None)
    if below is None or above is None or above <= below:
        return setting * min(max(target / errors[setting], 1 / 8), 8)
    share = math.log(target / errors[below]) / math.log(errors[above] / errors[below])
    return float(below * (above / below) ** min(max(share, 0.05), 0.95))


def interpolated_at(coder: Coder, error: str, target: float) -> Point:
    """Return the point at an error, on straight lines between the logarithms of coded points.

    Raises
    ------
    LookupError
        If the curve does not reach so far.
    DeltameshError
        If the codec cannot go so far.
    """
    for direction, beyond in ((SPACING, max), (1 / SPACING, min)):
        setting = beyond(coder.points, default=coder.start)
        for _ in range(WIDEST):
            reached = getattr(coder(setting), error)
            if (reached >= target) if beyond is max else (reached <= target):
                break
            setting *= direction
        else:
            raise LookupError(f"{coder.label}: no {error} error of {target:g}")
    order = sorted(coder.points.values(), key=lambda p: getattr(p, error))
    logs = np.log(np.maximum(np.array(order, dtype=np.float64), 1e-30))
    where = logs[:, Point._fields.index(error)]
    size, *errors = (math.exp(np.interp(math.log(target), where, one)) for one in logs.T)
    return Point(round(size), *errors)
