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
from deltamesh._geometry.candidates import candidates, may_pay
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
from deltamesh_formats.errors import MeshError

# Candidates are tried on the whole that take at most so many times the bytes of the smallest.
RIVALS: Final = 1.04
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
        refined, other = _trials(options, bounds, fit)
        grid = other or fit(settings_of(options, CARTESIAN.name))
        if refined is None or grid is None:
            return []
        chance = angles.excess(whole(grid.settings).measured) / angles.excess(grid.measured)
    except (MeshError, ZeroDivisionError):
        return []
    aim = aim_of(close_enough(options.effort, n))
    found = sorted(filter(None, (refined, other)), key=_size)
    result: Foresight = []
    for trial in found:
        excess = chance * angles.excess(trial.measured)
        if trial.settings.layout.anchored:
            excess *= BORDERS
        if not 0 < excess < math.inf:
            return []
        if trial.size <= RIVALS * found[0].size:
            result.append((replace(trial.settings, step=None), trial.step * aim / excess))
    return result


def _trials(
    options: Options, bounds: Bounds, fit: Callable[[Settings, float | None], Trial | None]
) -> tuple[Trial | None, Trial | None]:
    """Return the smallest trials on the sample of methods with anchors and of the one without."""
    found: dict[bool, Trial] = {}
    last: Settings | None = None
    for settings in candidates(options, bounds):
        anchored = settings.layout.anchored
        best = found.get(anchored)
        if may_pay(settings, last, best, bounds.of_angles, options.effort):
            step = None if best is None else best.step * step_ratio(best.settings, settings)
            trial = fit(settings, step)
            if trial is not None and (best is None or trial.size < best.size):
                found[anchored] = trial
        last = settings
    return found.get(True), found.get(False)


def _size(trial: Trial) -> int:
    return trial.size
