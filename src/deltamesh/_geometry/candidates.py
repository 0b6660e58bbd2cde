"""Candidates of a search: methods, and how coarse their deltas are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.trial import Trial
from deltamesh._methods import AUTO, CARTESIAN, REFINED
from deltamesh._options import DEFAULT_EFFORT, Options, Settings, settings_of
from deltamesh_formats.container.layout import DELTAS, NORMALS

# How coarse the deltas may be, by effort, the likeliest first.
COARSE: Final = {1: (4.5,), 2: (4.5, 3.0, 7.0), 3: (4.5, 3.0, 7.0, 2.0)}
# Of effort 2, another one: finer deltas pay where they take few bytes beside the refinements, and
# coarser ones, rarely, where they take many or next to none, or where a file has a few bits a
# vertex, as of exact spheres, whose anchors weigh as much: that is tried where a trial takes no
# second. Limits of the bytes of deltas over those of refinements; small meshes, whose trials take
# 0.1 s, try more of them, and finer ones where a distance bounds the step.
FEW, MANY, NONE = 1.2, 2.9, 0.5
SMALL_FEW, SMALL_MANY, SMALL_NONE = 2.0, 2.0, 1.0
FEW_BYTES: Final = 0.4
CHEAP: Final = 60_000
SMALL: Final = 25_000
# A distance bounds the step if it is so many times nearer to its bound than an angle.
BINDING: Final = 1.04


def candidates(options: Options, bounds: Bounds) -> Iterator[Settings]:
    """Yield the settings to try: the method that takes no time first, then the likeliest."""
    if options.method not in (AUTO, REFINED.name):
        yield settings_of(options, options.method)
        return
    refined, cartesian = (settings_of(options, each.name) for each in (REFINED, CARTESIAN))
    coarse = COARSE[options.effort] if options.coarse is None else (options.coarse,)
    if options.method == AUTO and not bounds.has_angle:
        # The error of Cartesian coordinates is white, which keeps distances the smallest.
        yield cartesian
        return
    if options.method == AUTO:
        yield cartesian
    for c in coarse:
        yield replace(refined, coarse=c)


def may_pay(
    settings: Settings,
    last: Settings | None,
    best: Trial | None,
    bounds: Bounds | None,
    effort: int,
) -> bool:
    """Return whether settings are worth a trial, from those of the last and the bytes of the best.

    That is in question for another coarse factor of the same method. Without `bounds`, of a sample,
    the limits are those of large meshes.
    """
    if last is None or last.method != settings.method or effort > DEFAULT_EFFORT:
        return True
    if best is None or best.settings.method != settings.method:
        return False
    deltas, normals = (len(best.payloads.get(name, b"")) for name in (DELTAS, NORMALS))
    n = len(best.vertices)
    few, many, none, is_far = FEW, MANY, NONE, False
    if bounds is not None and n <= SMALL:
        few, many, none = SMALL_FEW, SMALL_MANY, SMALL_NONE
        is_far = bounds.distance_over_angle(best.measured) >= BINDING
    if settings.coarse < best.settings.coarse:
        return is_far or deltas < few * normals
    is_extreme = deltas > many * normals or deltas < none * normals
    is_extreme |= best.size < FEW_BYTES * n
    return is_extreme and not is_far and n <= CHEAP
