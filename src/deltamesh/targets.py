"""Finding the step for a quality: a search that believes only what it has measured."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Final

from deltamesh.metrics import VertexErrors
from deltamesh.options import DEFAULT_HIGHPASS_STEP, Options
from deltamesh_formats.errors import MeshError, TargetError

# By how much positions may differ between machines and solvers, over the diagonal.
TOLERANCE: Final = 1e-9

# A step whose error is within that share of the bound is good enough.
CLOSE: Final = 0.9
# What the next guess aims at: errors are not quite proportional to steps.
AIM: Final = 0.95
# Measurements once some step is good, and to find one at all. Each is a quantization and a
# reconstruction, about half of an encode.
TRIES, MOST_TRIES = 5, 16
# How far one guess may go beyond what has been measured.
FURTHEST: Final = 32.0


def aim(options: Options, scale: float, errors_with: Callable[[Options], VertexErrors]) -> Options:
    """Return options that ask for a step, where those given ask for a quality.

    Parameters
    ----------
    options : Options
    scale : float
        Diagonal of the bounding box.
    errors_with : callable
        What a decoder will make of the mesh under options that ask for a step.

    Raises
    ------
    TargetError
    """
    plain = replace(options, normal_error=None, max_error=None, max_error_rel=None)

    def normal(step: float) -> float:
        return errors_with(replace(plain, step=step)).normal_deviation

    def largest(step: float) -> float:
        return errors_with(replace(plain, step=step)).max + TOLERANCE * scale

    start = DEFAULT_HIGHPASS_STEP * (scale or 1.0)
    if options.normal_error is not None:
        return replace(plain, step=find_step(normal, options.normal_error, start))
    if options.max_error is not None:
        return replace(plain, step=find_step(largest, options.max_error, start))
    if options.max_error_rel is not None:
        return replace(plain, step=find_step(largest, options.max_error_rel * scale, start))
    return options


def find_step(measure: Callable[[float], float], bound: float, start: float) -> float:
    """Return a step, as large as can be had cheaply, whose error is within a bound.

    Parameters
    ----------
    measure : callable
        The error at a step; about proportional to it, but for the noise of rounding. It may raise
        MeshError for a step that is too small.
    bound : float
        The largest error that is allowed, above 0.
    start : float
        The first guess.

    Raises
    ------
    TargetError
        If no step was found; the message tells the smallest error that was.
    """
    good, bad = 0.0, math.inf
    errors: dict[float, float] = {}
    step = start
    for tries in range(1, MOST_TRIES + 1):
        try:
            errors[step] = measure(step)
        except MeshError:
            break
        if errors[step] <= bound:
            good = max(good, step)
            if errors[step] >= CLOSE * bound:
                break
        else:
            bad = min(bad, step)
        if good and (tries >= TRIES or bad <= good):
            break
        step = _next(step, errors, good, bad, AIM * bound)
    if not good:
        least = min(errors.values(), default=math.inf)
        raise TargetError(f"an error of {bound:g} cannot be met: {least:g} is the least there was")
    return good


def _next(step: float, errors: dict[float, float], good: float, bad: float, aim: float) -> float:
    """Return the next step to try."""
    if good and bad < math.inf:
        low, high = errors[good], errors[bad]
        share = math.log(aim / low) / math.log(high / low) if 0 < low < aim < high else 0.5
        return float(good * (bad / good) ** min(max(share, 0.1), 0.9))
    factor = aim / errors[step] if errors[step] > 0 else FURTHEST
    return step * min(max(factor, 1 / FURTHEST), FURTHEST)
