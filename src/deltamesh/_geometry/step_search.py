"""Search for the largest step of a mesh that keeps the bounds.

Errors are nearly proportional to steps, so that few trials find it.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.trial import Attempt, ScaleError, Trial
from deltamesh._methods import METHODS
from deltamesh._options import DEFAULT_COARSE, DEFAULT_EFFORT, Settings
from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import MeshError

# An error within that share of its bound is good enough, by effort.
CLOSE: Final = {1: 0.85, 2: 0.93, 3: 0.97}
# Vertices from which a trial takes a quarter of a minute or more: there, the default effort is
# content with that share.
LARGE: Final = 2_000_000
CLOSE_IF_LARGE: Final = 0.88
# Trials of one method: as long as no step is good, or what is good leaves much to be had, or more
# than that effort calls near enough.
MOST_TRIES, LOOSE_TRIES, TRIES = 16, 8, 4
LOOSE: Final = 0.75
# The largest factor from a measured step to the next guess.
FURTHEST: Final = 32.0
# The least power of the step that errors are taken to grow with.
FLATTEST: Final = 0.25
# Bytes a vertex that halving the errors costs, at most: a bit for each of four numbers.
PER_OCTAVE: Final = 0.5


def first_step(settings: Settings, bounds: Bounds, edge: Floats) -> Floats:
    """Return the steps with which angles are about at their bounds, from mean edges, (c,)."""
    angle = min(bounds.normal_deviation, bounds.dihedral)
    return METHODS[settings.method].first_step * edge * angle * step_ratio(None, settings)


def step_ratio(known: Settings | None, settings: Settings) -> float:
    """Return the step of settings over that of others of the same method, or of the defaults.

    Twice as coarse deltas leave angles alone at steps 1.4 times as small, or nearly.
    """
    if not settings.layout.coarse:
        return 1.0
    return math.sqrt((known.coarse if known else DEFAULT_COARSE) / settings.coarse)


def close_enough(effort: int, n: int) -> float:
    """Return the share of a bound at which the search for a step of n vertices ends."""
    if effort == DEFAULT_EFFORT and n >= LARGE:
        return CLOSE_IF_LARGE
    return CLOSE[effort]


def aim_of(close: float) -> float:
    """Return the share of a bound that the next step aims at, where `close` is enough."""
    return (1 + close) / 2


def fit_step(
    settings: Settings,
    bounds: Bounds,
    step: float,
    close: float,
    attempt: Attempt,
    rival: Trial | None,
    missed: list[Trial],
) -> Trial | None:
    """Return the smallest of trials up to about the largest step within the bounds.

    It is None if it cannot win. The search ends at a share of the bounds that is `close`. The last
    trial that was not good goes to `missed`.
    """
    good: Trial | None = None
    excess: dict[float, float] = {}
    for tries in range(1, MOST_TRIES + 1):
        try:
            trial = attempt(replace(settings, step=step))
        except ScaleError:
            if good is None:
                raise
            break
        except MeshError:  # 2^30 steps are not enough for the mesh
            if excess:
                break
            step *= FURTHEST  # so that an error can name the least bound that can be met
            continue
        x = bounds.excess(trial.measured)
        is_same = x > 0 and x in excess.values()  # all numbers are 0, whatever the step
        excess[step] = x
        if x > 1:
            missed[:] = [trial]
        elif good is None or trial.size <= good.size:
            good = trial
        if close <= x <= 1 or (good is not None and (is_same or tries >= _tries(excess))):
            break
        if rival is not None and floor_of(trial, x) >= rival.size:
            return None if good is None or good.size >= rival.size else good
        step = _next(excess, aim_of(close))
    return good


def _tries(excess: dict[float, float]) -> int:
    """Return the trials that are enough, some of them being good."""
    return LOOSE_TRIES if max(x for x in excess.values() if x <= 1) < LOOSE else TRIES


def floor_of(trial: Trial, excess: float) -> float:
    """Return a size below which no trial like this one will come, at the bounds."""
    octaves = math.log2(1 / excess) if 0 < excess < 1 else 0.0 if excess else math.inf
    return trial.size - octaves * PER_OCTAVE * len(trial.vertices)


def _next(excess: dict[float, float], aim: float) -> float:
    """Return the step to try next, from the excess at those that were."""
    good = max((s for s, x in excess.items() if x <= 1), default=0.0)
    bad = min((s for s, x in excess.items() if x > 1 and s > good), default=math.inf)
    if good and bad < math.inf:
        low, high = excess[good], excess[bad]
        share = math.log(aim / low) / math.log(high / low) if 0 < low < aim else 0.5
        return float(good * (bad / good) ** min(max(share, 0.1), 0.9))
    step = good or bad
    factor = FURTHEST
    if excess[step] > 0:
        factor = (aim / excess[step]) ** (1 / _power(excess, step))
    return step * min(max(factor, 1 / FURTHEST), FURTHEST)


def _power(excess: dict[float, float], step: float) -> float:
    """Return the power of the step that errors grow with, from the step measured next to it.

    It is 1 but where slivers have lost their normals: there, errors fall slowly at first.
    """
    others = [s for s, x in excess.items() if s != step and 0 < x < math.inf]
    if not others or excess[step] == math.inf:
        return 1.0
    other = min(others, key=lambda s: abs(math.log(s / step)))
    power = math.log(excess[step] / excess[other]) / math.log(step / other)
    return min(max(power, FLATTEST), 1.0)
