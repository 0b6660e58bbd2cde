"""Anchoring of a surface: how many vertices are anchors, which, and on which grid they are."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from deltamesh._geometry import anchors as choice
from deltamesh._geometry import greedy_anchors
from deltamesh._geometry.deltas import deltas
from deltamesh._geometry.importance import holding, without_bits
from deltamesh._geometry.integers import Integers
from deltamesh._geometry.positions import grid_points, placed
from deltamesh._geometry.prediction import Prediction, origin_of
from deltamesh._geometry.systems import Systems
from deltamesh._options import Settings
from deltamesh._shape.surface import Surface
from deltamesh._vectors import sides
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.container import Parameters
from deltamesh_formats.container.layout import FARTHEST, GREEDY, RANDOM
from deltamesh_formats.container.payload_layout import MAX_GRID_BITS
from deltamesh_formats.errors import OptionError

# The grid of the anchors is that much finer than the step of the deltas: with diffusion, the
# error of the surface between anchors is about a fifth of that step, and theirs should not show.
ANCHOR_REFINEMENT = 8
# ... and at least as fine as that fraction of the longest side; or as another one of 0 bits, where
# the surface errs by far more.
ANCHOR_GRID_BITS, BARE_GRID_BITS = 16, 14


def anchored(
    surface: Surface,
    vertices: Floats,
    isolated: Floats,
    integers: Integers,
    step: float,
    settings: Settings,
    systems: Systems,
    predicted: Prediction | None = None,
) -> tuple[Parameters, Integers]:
    """Choose the anchors of quantized deltas, and round their positions.

    Those of a predicted frame are the same as in the frame before, on its grid or a finer one.
    Where vertices have no bits, there are further ones around, and all are listed.
    """
    if predicted is not None:
        grid = predicted.anchor_step(step / ANCHOR_REFINEMENT)
        parameters = replace(
            predicted.first, step=step, coarse=_coarse_of(settings), anchor_step=grid
        )
        integers = replace(integers, anchors=predicted.reference.integers.anchors)
        origin, where = origin_of(predicted), vertices[integers.anchors]
        return placed(where, vertices, isolated, parameters, integers, origin)
    anchor_method, k = _how_many(surface, settings)
    parameters = Parameters(
        method=settings.method,
        diffusion=settings.diffusion,
        anchor_method=anchor_method,
        bits=settings.bits,
        step=step,
        anchor_step=_anchor_step(np.concatenate([vertices, isolated]), step),
        seed=settings.seed if anchor_method == RANDOM else 0,
        isolated=surface.isolated_count,
        coarse=_coarse_of(settings),
        interpolated=settings.interpolated,
    )
    anchors, none = (
        _choose(surface, vertices, parameters, integers, k, systems),
        without_bits(settings),
    )
    if none is not None:
        anchors = np.union1d(anchors, holding(surface, none, settings.interpolated))
        parameters = replace(parameters, anchor_method=GREEDY, seed=0)
    integers = replace(integers, anchors=anchors)
    parameters = replace(parameters, anchor_count=len(anchors))
    return placed(vertices[anchors], vertices, isolated, parameters, integers)


def _coarse_of(settings: Settings) -> float:
    return settings.coarse if settings.layout.coarse else 1.0


def _anchor_step(vertices: Floats, step: float) -> float:
    """Return the step of the grid of the anchors."""
    extent = float(sides(vertices).max())
    if not step:
        return extent / 2.0**BARE_GRID_BITS or 1.0
    coarsest = extent / 2.0**ANCHOR_GRID_BITS or math.inf  # a point is on any grid
    finest = extent / 2.0 ** (MAX_GRID_BITS - 1)
    return max(min(coarsest, step / ANCHOR_REFINEMENT), finest)


def _choose(
    surface: Surface,
    vertices: Floats,
    parameters: Parameters,
    integers: Integers,
    k: int,
    systems: Systems,
) -> Ints:
    """Return k anchors, ascending where their indices are stored."""
    if parameters.anchor_method == FARTHEST:
        return systems.farthest(k)
    if parameters.anchor_method != GREEDY:
        return choice.computed(surface, str(parameters.anchor_method), k, parameters.seed)
    delta, fixed = deltas(parameters, integers), grid_points(vertices, parameters, integers)
    system = systems.of_choice
    return np.sort(greedy_anchors.greedy(surface.graph, vertices, delta, k, fixed, system))


def _how_many(surface: Surface, settings: Settings) -> tuple[str, int]:
    """Return how anchors are chosen, and how many."""
    n, components = surface.vertex_count, int(surface.labels.max(initial=-1)) + 1
    try:
        k = choice.count_anchors(settings.anchors, n, components)
    except ValueError as error:
        raise OptionError(str(error)) from None
    return choice.method_of(settings, n, components, k), k
