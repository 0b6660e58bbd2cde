"""Last trials of a search: other steps of the smallest one."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.candidates import SMALL
from deltamesh._geometry.trial import Attempt, Trial
from deltamesh._options import DEFAULT_EFFORT
from deltamesh_formats.errors import MeshError

# So many trials of a small mesh bring the errors as near as this to their bounds, if they are
# further: a percent of the step is up to half a percent of the bytes.
TRIES: Final = 2
NEAREST, NEAR = 0.995, 1.01
# Of meshes of so few vertices, errors and bytes go up and down with the step: so many steps are
# tried, up to twice as large.
TINY: Final = 100
RUNGS: Final = 16
# With corrections, steps change by this as long as the files shrink.
GROWTH: Final = 1.6


def nearer(best: Trial, bounds: Bounds, effort: int, attempt: Attempt) -> Trial:
    """Return a smaller trial, if there is one, whose errors are nearer to their bounds."""
    if len(best.vertices) > SMALL or effort < DEFAULT_EFFORT:
        return best
    if len(best.vertices) <= TINY:
        return _of_ladder(best, bounds, attempt)
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


def _of_ladder(best: Trial, bounds: Bounds, attempt: Attempt) -> Trial:
    """Return the smallest trial within the bounds, and of some steps above that of the best."""
    step = best.step
    for rung in range(1, RUNGS + 1):
        try:
            trial = attempt(replace(best.settings, step=step * 2 ** (rung / RUNGS)))
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
