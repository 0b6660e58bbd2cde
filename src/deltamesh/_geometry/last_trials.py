"""Last trials of a search: other steps of the smallest one."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.candidates import FEW_BYTES, SMALL
from deltamesh._geometry.trial import Attempt, Trial
from deltamesh._measures.metrics import diagonal
from deltamesh._options import DEFAULT_EFFORT
from deltamesh_formats.errors import MeshError

# So many trials of a small mesh bring the errors as near as this to their bounds, if they are
# further: a percent of the step is up to half a percent of the bytes.
TRIES: Final = 2
NEAREST, NEAR = 0.995, 1.01
# The least that bounds on distances have to leave then, in diagonals of the mesh.
DIGITS: Final = 2.0**-30
# Meshes of so few vertices are tried with steps of so many sixteenths of an octave above the best
# one, those of few bits with some below.
TINY: Final = 100
LARGER, SMALLER = range(1, 17), range(-3, 0)
# With corrections, steps change by this as long as the files shrink.
GROWTH: Final = 1.6


def nearer(best: Trial, bounds: Bounds, effort: int, attempt: Attempt) -> Trial:
    """Return a smaller trial, if there is one, whose errors are nearer to their bounds.

    Where a distance is as small as the digits of positions far away, it is left alone: a writer
    needs what it leaves, to round them.
    """
    if not TINY < len(best.vertices) <= SMALL or effort < DEFAULT_EFFORT:
        return best
    left = (1 - NEAREST) * min(bounds.rms, bounds.max)
    if left < DIGITS * diagonal(best.vertices) and bounds.distance_over_angle(best.measured) > 1:
        return best
    excess = bounds.excess(best.measured)
    reach = NEAREST / excess if excess else math.inf
    for _ in range(TRIES):
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


def luckier(best: Trial, bounds: Bounds, effort: int, attempt: Attempt) -> Trial:
    """Return a smaller trial, if there is one, where bytes go up and down with the step.

    They do so where vertices are few, or have a few bits, as on regular grids.
    """
    n = len(best.vertices)
    is_flat = n <= SMALL and best.size < FEW_BYTES * n
    if effort < DEFAULT_EFFORT or not (n <= TINY or is_flat):
        return best
    step = best.step
    for rung in LARGER if n <= TINY else SMALLER:
        try:
            trial = attempt(replace(best.settings, step=step * 2 ** (rung / 16)))
        except MeshError:
            break
        if bounds.excess(trial.measured) <= 1 and trial.size < best.size:
            best = trial
    return best


def with_corrections(best: Trial, bounds: Bounds, attempt: Attempt) -> Trial:
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
