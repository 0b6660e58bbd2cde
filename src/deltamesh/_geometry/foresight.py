"""Foresight of a search: candidates that are worth trials on the whole, and steps to begin with.

It is a search on a sample. What a sample has by chance, more relief or less of it than the rest,
shows in the errors of a grid, which are fast to measure on the whole as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Final, TypeAlias

import numpy as np

from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.candidates import CHEAP, candidates, may_pay
from deltamesh._geometry.step_search import (
    CLOSE,
    aim_of,
    close_enough,
    first_step,
    fit_step,
    step_ratio,
)
from deltamesh._geometry.trial import Attempt, Trial
from deltamesh._methods import CARTESIAN
from deltamesh._options import Options, Settings, settings_of
from deltamesh_formats.errors import LimitError, MeshError, SolveError

# Candidates are tried on the whole that take at most so many times the bytes of the smallest.
RIVALS: Final = 1.04
# ... and coarse factors of one method, where a trial of the whole is fast, that take so many times
# those of the best: samples are no surer than that.
NEAR: Final = 1.03
# Bytes a vertex that an octave of the step takes, about.
OCTAVE: Final = 0.3
# Angles of methods with anchors on the whole, over those on a sample: its borders are free.
BORDERS: Final = 0.96

# Candidates, and the steps with which angles are about where a search is content, if known.
Foresight: TypeAlias = list[tuple[Settings, float | None]]


def foresight(
    options: Options,
    bounds: Bounds,
    n: int,
    edge: float,
    sample: Attempt,
    whole: Attempt,
) -> Foresight:
    """Return what to try, the smallest first; nothing where a sample does not tell.

    Parameters
    ----------
    options : Options
    bounds : Bounds
        Of which one is on an angle.
    n : int
        The vertices of the whole.
    edge : float
        The mean length of its edges.
    sample, whole : callable
        They make trials on the sample, and on the whole.
    """
    angles = bounds.of_angles

    def fit(settings: Settings, step: float | None = None) -> Trial | None:
        step = step or float(first_step(settings, angles, np.array([edge]))[0])
        return fit_step(settings, angles, step, CLOSE[1], sample, None, [])

    try:
        found = _trials(options, bounds, fit)
        grid = found.get(CARTESIAN.name, [None])[0] or fit(settings_of(options, CARTESIAN.name))
        if not found or grid is None:
            return []
        chance = angles.excess(whole(grid.settings).measured) / angles.excess(grid.measured)
    except (LimitError, MeshError, SolveError, ZeroDivisionError):
        return []
    every = [trial for of_method in found.values() for trial in of_method]
    if not all(0 < chance * angles.excess(trial.measured) < math.inf for trial in every):
        return []
    likely = [trial for of_method in found.values() for trial in _likeliest(of_method, angles, n)]
    likely.sort(key=lambda trial: _size(trial, angles))
    most = RIVALS * _size(likely[0], angles)
    aim = aim_of(close_enough(options.effort, n)) / chance
    result: Foresight = []
    for trial in likely:
        if _size(trial, angles) <= most:
            borders = BORDERS if trial.settings.layout.anchored else 1.0
            step = trial.step * aim / (borders * angles.excess(trial.measured))
            result.append((replace(trial.settings, step=None), step))
    return result


def _trials(
    options: Options, bounds: Bounds, fit: Callable[[Settings, float | None], Trial | None]
) -> dict[str, list[Trial]]:
    """Return trials on the sample, by methods."""
    found: dict[str, list[Trial]] = {}
    last: Settings | None = None
    for settings in candidates(options, bounds):
        best = min(found.get(settings.method, []), key=lambda trial: trial.size, default=None)
        if may_pay(settings, last, best, None, options.effort):
            step = None if best is None else best.step * step_ratio(best.settings, settings)
            if (trial := fit(settings, step)) is not None:
                found.setdefault(settings.method, []).append(trial)
        last = settings
    return found


def _likeliest(trials: list[Trial], angles: Bounds, n: int) -> list[Trial]:
    """Return the trials of one method that may be the smallest on the whole of n vertices."""
    least = min(trials, key=lambda trial: _size(trial, angles))
    most = NEAR * _size(least, angles) if n <= CHEAP else 0.0
    return [trial for trial in trials if trial is least or _size(trial, angles) <= most]


def _size(trial: Trial, angles: Bounds) -> float:
    """Return the bytes that a trial would take if an angle were at its bound."""
    octaves = math.log2(1 / angles.excess(trial.measured))
    return trial.size - OCTAVE * octaves * len(trial.vertices)
