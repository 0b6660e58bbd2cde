"""Search for the fewest bytes within bounds on the errors.

It believes measurements only: a trial is quantized, coded and decoded whole, and the file
is the smallest trial within the bounds. A method whose first trials show that it cannot win is
given up.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Final

import numpy as np

from deltamesh._geometry.bounds import NO_BOUNDS, Bounds
from deltamesh._geometry.candidates import BINDING, SMALL, candidates, may_pay
from deltamesh._geometry.foresight import Foresight, foresight
from deltamesh._geometry.last_trials import TINY, luckier, nearer, with_corrections
from deltamesh._geometry.part_search import (
    Components,
    Steps,
    fit_steps,
    steps_near,
    with_fewer_levels,
    with_nearer_base,
)
from deltamesh._geometry.step_search import close_enough, first_step, fit_step, step_ratio
from deltamesh._geometry.trial import Attempt, ScaleError, Trial
from deltamesh._measures.measure import Measured
from deltamesh._methods import AUTO, CARTESIAN, HIGHPASS, REFINED
from deltamesh._options import DEFAULT_EFFORT, Options, Settings, settings_of
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.layout import CELLS
from deltamesh_formats.errors import LimitError, MeshError, TargetError

# Where a distance, not an angle, would bound the step, twice the anchors divide distances by that,
# for 0.08 bits a vertex and more; but not more of them than that share of the vertices. The search
# begins there and goes on from file to file: corrections of a few vertices are often cheaper.
MORE_ANCHORS, LESS_DISTANCE = 2, 1.35
MOST_ANCHORS: Final = 0.016
# Fewer anchors err more, by as much as bounds allow: they have to save more than half a percent.
FEWER_PAY: Final = 0.995
# ... and no component asks for more than so many times two.
MOST_TIMES: Final = 10
# With more anchors, steps are larger by that power of what they allow, to begin with.
CAREFUL: Final = 0.75
# Small meshes go on after a number of anchors that did not pay, up to so many.
SMALL_TRIES: Final = 2
# Other anchors are tried of settings that take at most so many times the bytes of the best ones.
NEARLY: Final = 1.06
# Small meshes are tried with anchors weighed in least squares, which takes the time of two trials,
# if the vectors of cells, which those do without, are more than that share of a file.
CELLS_WEIGH: Final = 0.01
# Up to so many vertices, other steps and systems of other numbers of anchors are tried as well.
FACTORED: Final = 5000


def smallest(
    options: Options,
    bounds: Bounds | None,
    components: Components,
    attempt: Attempt,
    name_of: Callable[[int], str] = str,
    furthest: Bounds = NO_BOUNDS,
    sample: Attempt | None = None,
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
    sample : callable, optional
        Makes trials on a sample of a mesh of one part, whose angles are bounded; see `foresight`.

    Raises
    ------
    TargetError
        If no trial is within the bounds.
    """
    if bounds is None:
        return _at_rate(options, components, attempt, furthest)
    foreseen = None
    if sample is not None:
        foreseen = foresight(
            options, bounds, len(components.of_vertex), float(components.edge[0]), sample, attempt
        )
    attempt = lru_cache(maxsize=1)(attempt)
    best: Trial | None = None
    steps: Steps | None = None
    missed: list[Trial] = []
    last: Settings | None = None
    guessed: Foresight = [(one, None) for one in candidates(options, bounds)]
    for settings, step in foreseen or guessed:
        if not foreseen and not may_pay(settings, last, best, bounds, options.effort):
            continue
        last = settings
        start = _start(settings, bounds, components, best, steps, step)
        if best is not None and best.settings.method == settings.method:
            settings = replace(settings, anchors=best.settings.anchors)
        elif options.anchors is None and settings.layout.anchored:
            first = components.settings(settings, start)
            settings = _anchored(settings, bounds, components, first, attempt)
        if bounds.has_angle:
            settings = replace(settings, largest=bounds.max)
        try:
            rival = None if len(components.of_vertex) <= TINY else best
            found = _fit(settings, bounds, start, components, options, attempt, rival, missed)
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
        best = luckier(best, bounds, options.effort, attempt)
        best = _with_least_squares(best, steps, bounds, components, options, attempt)
        best = nearer(best, bounds, options.effort, attempt)
        return with_corrections(best, bounds, attempt)
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
    """Return the smallest of trials up to about the largest steps; None if it cannot win."""
    if components.alone:
        close = close_enough(options.effort, len(components.of_vertex))
        trial = fit_step(settings, bounds, start.base, close, attempt, best, missed)
        return None if trial is None else (trial, replace(start, base=trial.step))
    effort = options.effort
    tried = fit_steps(settings, bounds, start, components, effort, attempt, best, missed)
    if tried[0] is None and best is not None and best.settings.method != settings.method:
        return None  # fewer levels are finer steps: another method that lost will not win by them
    trial, steps = with_fewer_levels(settings, bounds, tried, components, effort, attempt, best)
    if trial is None:
        return None
    return with_nearer_base(trial.settings, bounds, (trial, steps), components, attempt)


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
    close = close_enough(options.effort, len(best.vertices))
    rival = fit_step(settings, bounds, start.base, close, attempt, rival, [])
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


def _with_other_anchors(
    found: tuple[Trial, Steps],
    bounds: Bounds,
    components: Components,
    options: Options,
    attempt: Attempt,
) -> tuple[Trial, Steps]:
    """Return a smaller trial, if there is one, with fewer or more anchors.

    More are tried where a distance bounds the trial. Fewer are tried where a guess has asked for
    more than the default, and an angle would still bound the trial, or corrections keep a distance.
    """

    def is_far(trial: Trial) -> bool:
        return bounds.distance_over_angle(trial.measured) >= BINDING

    def with_fewer(found: tuple[Trial, Steps]) -> tuple[Trial, Steps]:
        while found[0].settings.anchors is not None:
            trial, steps = found
            count = trial.parameters.anchor_count // MORE_ANCHORS
            is_near = bounds.distance_over_angle(trial.measured) * LESS_DISTANCE <= 1
            if not count or not (is_near or bounds.max < math.inf):
                break
            settings = replace(trial.settings, anchors=count)
            other = _fit(settings, bounds, steps, components, options, attempt, trial, [])
            if other is None or other[0].size >= FEWER_PAY * trial.size:
                break
            found = other
        return found

    def with_more(found: tuple[Trial, Steps]) -> tuple[Trial, Steps]:
        last, tries = found, SMALL_TRIES if len(found[0].vertices) <= SMALL else 1
        while tries and is_far(last[0]):
            trial, steps = last
            k = trial.parameters.anchor_count
            count = min(MORE_ANCHORS * k, int(MOST_ANCHORS * len(trial.vertices)))
            if 2 * count <= 3 * k:
                break
            larger = min(bounds.distance_over_angle(trial.measured), LESS_DISTANCE)
            settings, steps = replace(trial.settings, anchors=count), steps.times(larger**CAREFUL)
            other = _fit(settings, bounds, steps, components, options, attempt, found[0], [])
            if other is None:
                break
            last = other
            if other[0].size < found[0].size:
                found = other
            else:
                tries -= 1
        return found

    least = with_fewer(found)
    return with_more(found) if least is found else least


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
    is_direct = len(best.vertices) <= SMALL and options.effort >= DEFAULT_EFFORT
    is_solved = best.parameters.interpolated and best.parameters.anchor_count > 0
    if not is_direct or options.solution is not None or not is_solved:
        return best
    cells = len(best.payloads.get(CELLS, b""))
    is_far = bounds.distance_over_angle(best.measured) >= BINDING
    if not is_far and cells <= CELLS_WEIGH * best.size:
        return best
    count = best.parameters.anchor_count if options.anchors is None else options.anchors
    settings = replace(best.settings, interpolated=False, anchors=count)
    steps = steps.times(best.step / steps.coarsest)
    try:
        first = attempt(components.settings(settings, steps))
    except (LimitError, MeshError):
        return best
    if first.parameters.interpolated:  # as vertices without importance ask for
        return best
    found: tuple[Trial, Steps] | None = first, steps
    is_over = bounds.excess(first.measured) > 1
    if is_over or len(best.vertices) <= FACTORED:  # the search begins with the first trial
        found = _fit(settings, bounds, steps, components, options, attempt, best, [])
    if found is None or found[0].size >= best.size:
        return best
    if options.anchors is None and len(best.vertices) <= FACTORED:
        found = _with_other_anchors(found, bounds, components, options, attempt)
    return found[0]


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
    foreseen: float | None = None,
) -> Steps:
    """Return the steps to begin with; that for the bounds on angles is `foreseen`, or guessed."""
    if steps is not None and best is not None and best.settings.method == settings.method:
        return steps.times(step_ratio(best.settings, settings))
    edge = components.edge
    with np.errstate(invalid="ignore"):
        step = first_step(settings, bounds, edge) if foreseen is None else np.array([foreseen])
    limits = (bounds.rms, bounds.max, components.largest_rms(bounds), edge)
    wanted: Floats = np.minimum.reduce([step, *np.broadcast_arrays(*limits)])
    return steps_near(np.where(wanted > 0, wanted, 1.0))
