"""Search for the fewest bytes within bounds on the errors.

It believes measurements only: a trial is quantized, coded and decoded whole, and the file
is the smallest trial within the bounds. A method whose first trials show that it cannot win is
given up.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import lru_cache
from typing import Final

import numpy as np

from deltamesh._geometry.bounds import NO_BOUNDS, Bounds
from deltamesh._geometry.part_search import (
    Components,
    Steps,
    fit_steps,
    steps_near,
    with_fewer_levels,
)
from deltamesh._geometry.step_search import fit_step
from deltamesh._geometry.trial import Attempt, ScaleError, Trial
from deltamesh._measures.measure import Measured
from deltamesh._methods import AUTO, CARTESIAN, HIGHPASS, METHODS, REFINED
from deltamesh._options import DEFAULT_COARSE, DEFAULT_EFFORT, Options, Settings, settings_of
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.layout import CELLS, DELTAS, NORMALS
from deltamesh_formats.errors import LimitError, MeshError, TargetError

# How coarse the deltas may be, by effort, the likeliest first.
COARSE: Final = {1: (4.5,), 2: (4.5, 3.0, 7.0), 3: (4.5, 3.0, 7.0, 2.0)}
# Of effort 2, another one: finer deltas pay where they take few bytes beside the refinements, and
# coarser ones, rarely, where they take many or next to none, or where a file has a few bits a
# vertex, as of exact spheres, whose anchors weigh as much: that is tried where a trial takes no
# second. Bytes of deltas over those of refinements; of small meshes, whose trials take 0.1 s, more
# may be tried, finer ones also where a distance bounds the step.
LIMITS: Final = (1.2, 2.9, 0.5)
SMALL_LIMITS: Final = (2.0, 2.0, 1.0)
FEW_BYTES: Final = 0.4
CHEAP: Final = 60_000
SMALL: Final = 25_000
# Small meshes are tried without the vectors of cells, with the anchors weighed in least squares,
# which takes the time of two trials, if those are more than that share of a file.
CELLS_WEIGH: Final = 0.01
# ... and as often as that, errors are brought as near as this to their bounds, if they are further.
LAST_TRIES: Final = 2
NEAREST, NEAR = 0.995, 1.01
# Other numbers of anchors are tried where a coarse factor is no more than that many times as large
# as the best.
NEARLY: Final = 1.02
# Where a distance, not an angle, would bound the step, twice the anchors divide distances by that,
# for 0.08 bits a vertex and more; but not more of them than that share of the vertices. The search
# begins there and goes on from file to file: corrections of a few vertices are often cheaper.
MORE_ANCHORS, LESS_DISTANCE = 2, 1.35
MOST_ANCHORS: Final = 0.016
# ... with steps larger by that power of what they allow.
CAREFUL: Final = 0.75
# Fewer anchors err more, by as much as bounds allow: they have to save more than half a percent.
FEWER_PAY: Final = 0.995
# ... and no component asks for more than so many times two.
MOST_TIMES: Final = 10
# A distance bounds the step if it is so many times nearer to its bound than an angle.
BINDING: Final = 1.04
# With corrections, steps change by this as long as the files shrink.
GROWTH: Final = 1.6


def smallest(
    options: Options,
    bounds: Bounds | None,
    components: Components,
    attempt: Attempt,
    name_of: Callable[[int], str] = str,
    furthest: Bounds = NO_BOUNDS,
) -> Trial:
    """Return the smallest trial within the bounds; without bounds, the trial of the options.

    Where a method is named, no bound is given, and the default quality is beyond it, the best trial
    that was found is returned.

    Parameters
    ----------
    options : Options
    bounds : Bounds, optional
        Without them, "auto" means the errors that method refined has.
    components : Components
    attempt : callable
    name_of : callable
        The name of a part, for messages.
    furthest : Bounds
        Distances beyond which "auto" at a rate is not refined.

    Raises
    ------
    TargetError
        If no trial is within the bounds.
    """
    if bounds is None:
        return _at_rate(options, components, attempt, furthest)
    attempt = lru_cache(maxsize=1)(attempt)
    best: Trial | None = None
    steps: Steps | None = None
    missed: list[Trial] = []
    for settings in _candidates(options, bounds):
        if best is not None and not _may_pay(settings, best, bounds, options.effort):
            continue
        start = _start(settings, bounds, components, best, steps)
        if best is not None and best.settings.method == settings.method:
            settings = replace(settings, anchors=best.settings.anchors)
        elif options.anchors is None and settings.layout.anchored:
            first = components.settings(settings, start)
            settings = _anchored(settings, bounds, components, first, attempt)
        if bounds.has_angle:
            settings = replace(settings, largest=bounds.max)
        try:
            found = _fit(settings, bounds, start, components, options, attempt, best, missed)
            is_near = found is not None and (best is None or found[0].size < NEARLY * best.size)
            if found is not None and is_near and options.anchors is None:
                found = _with_other_anchors(found, bounds, components, options, attempt)
        except ScaleError:
            if options.method != AUTO:
                raise
            found = None
        if found is not None and (best is None or found[0].size < best.size):
            best, steps = found
    if best is not None and steps is not None:
        best = _with_least_squares(best, steps, bounds, components, options, attempt)
        best = _nearer(best, bounds, options, attempt)
        return _with_corrections(best, bounds, attempt)
    if not missed:
        raise TargetError("no quantization step that fits the mesh is small enough")
    if options.method != AUTO and not options.is_bounded:
        return missed[-1]
    raise missed_bounds(bounds, missed[-1].measured, name_of)


def missed_bounds(bounds: Bounds, measured: Measured, name_of: Callable[[int], str]) -> TargetError:
    """Return the error to raise where no trial has smaller errors than these."""
    one = bounds.binding(measured)
    where = "" if one.part is None else f" in {name_of(one.part)}"
    message = f"{one.name} {one.bound:g} cannot be met{where}: the least found is {one.error:g}"
    return TargetError(message)


def _fit(
    settings: Settings,
    bounds: Bounds,
    start: Steps,
    components: Components,
    options: Options,
    attempt: Attempt,
    best: Trial | None,
    missed: list[Trial],
) -> tuple[Trial, Steps] | None:
    """Return a trial within the bounds whose steps are about the largest; None if it cannot win."""
    if components.alone:
        trial = fit_step(settings, bounds, start.base, options.effort, attempt, best, missed)
        return None if trial is None else (trial, replace(start, base=trial.step))
    effort = options.effort
    tried = fit_steps(settings, bounds, start, components, effort, attempt, best, missed)
    trial, steps = with_fewer_levels(settings, bounds, tried, components, effort, attempt, best)
    return None if trial is None else (trial, steps)


def _at_rate(options: Options, components: Components, attempt: Attempt, furthest: Bounds) -> Trial:
    """Return the trial at the rate of the options; for "auto", the smallest of no larger errors.

    Deltas drift where there are few vertices: a method without drift replaces refined where that
    would move them further than the `furthest` bounds, too, whatever the size.
    """
    if options.method != AUTO:
        return attempt(settings_of(options, options.method))
    if options.bits == 0:
        return attempt(settings_of(options, HIGHPASS.name))
    best = attempt(settings_of(options, REFINED.name))
    drifts = furthest.excess(best.measured) > 1
    bounds = _errors_of(best.measured)
    if drifts:
        bounds = bounds.within(furthest)
    settings = replace(settings_of(options, CARTESIAN.name), bits=None, step=None)
    start = _start(settings, bounds, components, None, None)
    rival = None if drifts else best
    rival = fit_step(settings, bounds, start.base, options.effort, attempt, rival, [])
    if rival is None or (best.size <= rival.size and not drifts):
        return best
    return rival


def _errors_of(measured: Measured) -> Bounds:
    """Return bounds that no error may be larger than these."""
    whole, parts = measured.errors, measured.parts
    bounds = Bounds(**vars(whole))
    if parts is None:
        return bounds
    return replace(
        bounds,
        part_rms=float(parts.relative_rms.max()),
        part_normal=float(parts.normal_deviation.max()),
        part_dihedral=float(parts.dihedral.max()),
    )


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


def _with_other_anchors(
    found: tuple[Trial, Steps],
    bounds: Bounds,
    components: Components,
    options: Options,
    attempt: Attempt,
) -> tuple[Trial, Steps]:
    """Return a smaller trial, if there is one, with fewer or more anchors.

    More are tried where a distance bounds the trial; else, fewer where a guess has asked for more
    than the default.
    """
    has_more = _is_far(found[0], bounds)
    while _is_far(found[0], bounds) == has_more:
        trial, steps = found
        count, share = trial.parameters.anchor_count // MORE_ANCHORS, FEWER_PAY
        if has_more:
            count, share = MORE_ANCHORS * trial.parameters.anchor_count, 1.0
            # The errors become smaller: angles may take the place of distances at a larger step.
            larger = min(_distance_over_angle(trial, bounds), LESS_DISTANCE)
            steps = steps.times(larger**CAREFUL)
        is_guessed = has_more or trial.settings.anchors is not None
        if not (is_guessed and 0 < count <= MOST_ANCHORS * len(trial.vertices)):
            break
        settings = replace(trial.settings, anchors=count)
        other = _fit(settings, bounds, steps, components, options, attempt, trial, [])
        if other is None or other[0].size >= share * trial.size:
            break
        found = other
    return found


def _is_far(trial: Trial, bounds: Bounds) -> bool:
    """Return whether a distance, not an angle, bounds a trial."""
    return _distance_over_angle(trial, bounds) >= BINDING


def _distance_over_angle(trial: Trial, bounds: Bounds) -> float:
    """Return how many times nearer to its bound the distance of a trial is than its angle."""
    distance, angle = (float(each.max()) for each in bounds.part_excess(trial.measured))
    return distance / angle if angle else math.inf


def _with_least_squares(
    best: Trial,
    steps: Steps,
    bounds: Bounds,
    components: Components,
    options: Options,
    attempt: Attempt,
) -> Trial:
    """Return a smaller trial, if there is one, whose anchors are weighed in least squares.

    They have no vectors of cells, which weigh where vertices have few bits.
    """
    cells = len(best.payloads.get(CELLS, b""))
    is_direct = len(best.vertices) <= SMALL and options.effort >= DEFAULT_EFFORT
    if not is_direct or options.solution is not None or cells <= CELLS_WEIGH * best.size:
        return best
    settings = replace(best.settings, interpolated=False)
    try:
        attempt(components.settings(settings, steps))  # which the search goes on with
    except (LimitError, MeshError):
        return best
    found = _fit(settings, bounds, steps, components, options, attempt, best, [])
    if found is None or found[0].size >= best.size:
        return best
    if options.anchors is None:
        found = _with_other_anchors(found, bounds, components, options, attempt)
    return found[0]


def _nearer(best: Trial, bounds: Bounds, options: Options, attempt: Attempt) -> Trial:
    """Return a smaller trial, if there is one, whose errors are nearer to their bounds."""
    if len(best.vertices) > SMALL or options.effort < DEFAULT_EFFORT or best.is_bare:
        return best
    reach = NEAREST / bounds.excess(best.measured)
    for _ in range(LAST_TRIES):
        if not NEAR <= reach < math.inf:
            break
        try:
            trial = attempt(replace(best.settings, step=reach * best.step))
        except MeshError:
            break
        excess = bounds.excess(trial.measured)
        if excess <= 1 and trial.size < best.size:
            best, reach = trial, NEAREST / excess
        else:
            reach = math.sqrt(reach)
    return best


def _may_pay(settings: Settings, best: Trial, bounds: Bounds, effort: int) -> bool:
    """Return whether another coarse factor is worth a trial, from the bytes of the best one."""
    if settings.method != REFINED.name or effort > DEFAULT_EFFORT:
        return True
    if best.settings.method != REFINED.name:
        return False
    deltas, normals = (len(best.payloads.get(name, b"")) for name in (DELTAS, NORMALS))
    is_small = len(best.vertices) <= SMALL
    is_far = is_small and _is_far(best, bounds)
    few, many, none = SMALL_LIMITS if is_small else LIMITS
    if settings.coarse < best.settings.coarse:
        return is_far or deltas < few * normals
    is_extreme = deltas > many * normals or deltas < none * normals
    is_extreme |= best.size < FEW_BYTES * len(best.vertices)
    return is_extreme and not is_far and len(best.vertices) <= CHEAP


def _anchored(
    settings: Settings,
    bounds: Bounds,
    components: Components,
    first: Settings,
    attempt: Attempt,
) -> Settings:
    """Return settings with more anchors where a distance, not an angle, would bound the step.

    The `first` settings are those of the first trial.
    """
    try:
        trial = attempt(first)
    except MeshError:  # the step is too small for the mesh: the search will find it as well
        return settings
    if not trial.parameters.anchor_count:  # a mesh of isolated vertices
        return settings
    distance, angle = map(components.excess, bounds.part_excess(trial.measured))
    with np.errstate(divide="ignore", invalid="ignore"):
        times = np.log(distance / angle) / math.log(LESS_DISTANCE)
    times = np.clip(np.nan_to_num(times), -MOST_TIMES, MOST_TIMES)
    wanted = max(float(times[components.of_vertex].mean()), 0.0)
    most = max(MOST_ANCHORS * len(trial.vertices) / trial.parameters.anchor_count, 1.0)
    by = min(round(wanted), int(math.log(most, MORE_ANCHORS)))
    if not by:
        return settings
    return replace(settings, anchors=trial.parameters.anchor_count * MORE_ANCHORS**by)


def _start(
    settings: Settings,
    bounds: Bounds,
    components: Components,
    best: Trial | None,
    steps: Steps | None,
) -> Steps:
    """Return the steps to begin with."""
    if steps is not None and best is not None and best.settings.method == settings.method:
        return steps.times(math.sqrt(best.settings.coarse / settings.coarse))
    # Twice as coarse deltas leave angles alone at steps 1.4 times as small, or nearly.
    finer = math.sqrt(settings.coarse / DEFAULT_COARSE) if settings.layout.coarse else 1.0
    angle = min(bounds.normal_deviation, bounds.dihedral)
    edge = components.edge
    with np.errstate(invalid="ignore"):
        step = METHODS[settings.method].first_step * edge * angle / finer
    limits = (bounds.rms, bounds.max, components.largest_rms(bounds), edge)
    wanted: Floats = np.minimum.reduce([step, *np.broadcast_arrays(*limits)])
    return steps_near(np.where(wanted > 0, wanted, 1.0))


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
        step = change * best.step
        try:
            trial = attempt(replace(best.settings, step=step, largest=bounds.max))
        except MeshError:  # too small a step for the mesh
            return best
        if bounds.excess(trial.measured) > 1 or trial.size >= best.size:
            return best
        best = trial
