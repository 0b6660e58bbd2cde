"""Search for the fewest bytes within bounds on the errors.

It believes measurements only: a trial is quantized, coded and decoded whole, and the file
is the smallest trial within the bounds. Errors are nearly proportional to steps, so that few trials
find a step; a method whose first trials show that it cannot win is given up.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Final

from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.integers import Integers
from deltamesh._measures.metrics import VertexErrors
from deltamesh._methods import AUTO, CARTESIAN, HIGHPASS, METHODS, REFINED
from deltamesh._options import DEFAULT_COARSE, Options, Settings, settings_of
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.container import Parameters
from deltamesh_formats.errors import MeshError, TargetError

# An error within that share of its bound is good enough, by effort.
CLOSE: Final = {1: 0.85, 2: 0.93, 3: 0.97}
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
# How coarse the deltas may be, by effort, the likeliest first.
COARSE: Final = {1: (8.0,), 2: (8.0, 4.0), 3: (8.0, 4.0, 16.0, 2.0)}
# Where a distance, not an angle, would bound the step, four times the anchors divide distances by
# three or so, for 0.15 bits a vertex; but not more of them than that share of the vertices.
MORE_ANCHORS, LESS_DISTANCE = 4, 3
MOST_ANCHORS: Final = 0.016
# With corrections, steps change by this as long as the files shrink.
GROWTH: Final = 1.6


class ScaleError(MeshError):
    """Coordinates too large for a method, whatever its step; for another one they may not be."""


@dataclass(frozen=True)
class Trial:
    """A geometry under some settings: the contents of a file, and what its decoder makes of them.

    Attributes
    ----------
    settings : Settings
    parameters : Parameters
    integers : Integers
    encode : callable
        Makes the payloads, which only a trial within the bounds needs.
    vertices : float64 (n, 3)
        Decoded.
    errors : VertexErrors
    """

    settings: Settings
    parameters: Parameters
    integers: Integers
    encode: Callable[[], dict[str, bytes]]
    vertices: Floats
    errors: VertexErrors

    @cached_property
    def payloads(self) -> dict[str, bytes]:
        """The sections of the geometry, by their ids."""
        return self.encode()

    @property
    def size(self) -> int:
        """Bytes of the payloads."""
        return sum(map(len, self.payloads.values()))


Attempt = Callable[[Settings], Trial]


def smallest(options: Options, bounds: Bounds | None, edge: float, attempt: Attempt) -> Trial:
    """Return the smallest trial within the bounds; without bounds, the trial of the options.

    Parameters
    ----------
    options : Options
    bounds : Bounds, optional
        Without them, "auto" means the errors that method refined has.
    edge : float
        Mean length of the edges.
    attempt : callable

    Raises
    ------
    TargetError
        If no trial is within the bounds.
    """
    if bounds is None:
        return _at_rate(options, edge, attempt)
    attempt = lru_cache(maxsize=1)(attempt)
    best: Trial | None = None
    missed: list[Trial] = []
    for settings in _candidates(options, bounds):
        start = _guess(settings, bounds, edge, best)
        if best is not None and best.settings.method == settings.method:
            settings = replace(settings, anchors=best.settings.anchors)
        elif options.anchors is None and settings.layout.anchored:
            settings = _anchored(settings, bounds, start, attempt)
        if bounds.has_angle:
            settings = replace(settings, largest=bounds.max)
        try:
            found = _fit(settings, bounds, start, options.effort, attempt, best, missed)
        except ScaleError:
            if options.method != AUTO:
                raise
            found = None
        if best is None or (found is not None and found.size < best.size):
            best = found
    if best is None and not missed:
        raise TargetError("no quantization step that fits the mesh is small enough")
    if best is None:
        raise bounds.missed(missed[-1].errors)
    return _with_corrections(best, bounds, attempt)


def _at_rate(options: Options, edge: float, attempt: Attempt) -> Trial:
    """Return the trial at the rate of the options; for "auto", the smallest of equal errors."""
    if options.method != AUTO:
        return attempt(settings_of(options, options.method))
    if options.bits == 0:
        return attempt(settings_of(options, HIGHPASS.name))
    best = attempt(settings_of(options, REFINED.name))
    bounds = Bounds(normal_deviation=best.errors.normal_deviation, dihedral=best.errors.dihedral)
    settings = replace(settings_of(options, CARTESIAN.name), bits=None)
    start = _guess(settings, bounds, edge, None)
    rival = _fit(settings, bounds, start, options.effort, attempt, best, [])
    return best if rival is None or best.size <= rival.size else rival


def _candidates(options: Options, bounds: Bounds) -> Iterator[Settings]:
    """Yield the settings to try, the likeliest first, and the fast ones before the others."""
    if options.method not in (AUTO, REFINED.name):
        yield settings_of(options, options.method)
        return
    refined, cartesian = (settings_of(options, each.name) for each in (REFINED, CARTESIAN))
    coarse = COARSE[options.effort] if options.coarse is None else (options.coarse,)
    if options.method == AUTO and not bounds.has_angle:
        # The error of Cartesian coordinates is white, which keeps distances the smallest.
        yield cartesian
        return
    yield replace(refined, coarse=coarse[0])
    if options.method == AUTO:
        yield cartesian
    for c in coarse[1:]:
        yield replace(refined, coarse=c)


def _anchored(settings: Settings, bounds: Bounds, step: float, attempt: Attempt) -> Settings:
    """Return settings with more anchors where a distance, not an angle, would bound the step."""
    try:
        trial = attempt(replace(settings, step=step))
    except MeshError:  # the step is too small for the mesh: the search will find it as well
        return settings
    distance, angle = bounds.distance_excess(trial.errors), bounds.angle_excess(trial.errors)
    if distance <= angle:
        return settings
    most = max(MOST_ANCHORS * len(trial.vertices) / trial.parameters.anchor_count, 1.0)
    wanted = math.log(distance / angle, LESS_DISTANCE) if angle else math.inf
    times = min(round(min(wanted, 99)), int(math.log(most, MORE_ANCHORS)))
    return replace(settings, anchors=trial.parameters.anchor_count * MORE_ANCHORS**times)


def _guess(settings: Settings, bounds: Bounds, edge: float, best: Trial | None) -> float:
    """Return a step to begin with."""
    # Twice as coarse deltas leave angles alone at steps 1.4 times as small, or nearly.
    finer = math.sqrt(settings.coarse / DEFAULT_COARSE) if settings.layout.coarse else 1.0
    if best is not None and best.settings.method == settings.method:
        return best.parameters.step * math.sqrt(best.settings.coarse / settings.coarse)
    angle = min(bounds.normal_deviation, bounds.dihedral)
    step = METHODS[settings.method].first_step * edge * angle / finer
    return min(step, bounds.rms, bounds.max, edge) or 1.0


def _fit(
    settings: Settings,
    bounds: Bounds,
    step: float,
    effort: int,
    attempt: Attempt,
    rival: Trial | None,
    missed: list[Trial],
) -> Trial | None:
    """Return a trial within the bounds whose step is about the largest; None if it cannot win.

    The last trial that was not good goes to `missed`.
    """
    good: Trial | None = None
    excess: dict[float, float] = {}
    close = CLOSE[effort]
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
        x = excess[step] = bounds.excess(trial.errors)
        if x > 1:
            missed[:] = [trial]
        elif good is None or step > good.parameters.step:
            good = trial
        if close <= x <= 1 or (good is not None and tries >= _tries(excess)):
            break
        if rival is not None and _floor(trial, x) >= rival.size:
            return None
        step = _next(excess, (1 + close) / 2)
    return good


def _tries(excess: dict[float, float]) -> int:
    """Return the trials that are enough, some of them being good."""
    return LOOSE_TRIES if max(x for x in excess.values() if x <= 1) < LOOSE else TRIES


def _floor(trial: Trial, excess: float) -> float:
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
    others = [s for s, x in excess.items() if s != step and x > 0]
    if not others:
        return 1.0
    other = min(others, key=lambda s: abs(math.log(s / step)))
    power = math.log(excess[step] / excess[other]) / math.log(step / other)
    return min(max(power, FLATTEST), 1.0)


def _with_corrections(best: Trial, bounds: Bounds, attempt: Attempt) -> Trial:
    """Return a smaller trial, if there is one, with more or with fewer corrections.

    Where an angle is bounded, the search has corrected from the beginning and found the largest
    step that the angle allows; a smaller one may need fewer corrections. Where none is, the search
    has found the largest step that needs none.
    """
    if not best.settings.layout.corrected or bounds.max == math.inf:
        return best
    change = 1 / GROWTH if bounds.has_angle else GROWTH
    while True:
        step = change * best.parameters.step
        try:
            trial = attempt(replace(best.settings, step=step, largest=bounds.max))
        except MeshError:  # too small a step for the mesh
            return best
        if bounds.excess(trial.errors) > 1 or trial.size >= best.size:
            return best
        best = trial
