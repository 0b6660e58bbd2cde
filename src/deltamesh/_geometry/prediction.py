"""Prediction of a frame from another one that has been decoded."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from deltamesh._geometry.integers import Integers
from deltamesh._geometry.motion import Motion, carried
from deltamesh._geometry.systems import Systems
from deltamesh._kernels.mesh import laplacian
from deltamesh._shape.surface import Surface
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.container import Parameters
from deltamesh_formats.container.method_layouts import METHODS
from deltamesh_formats.container.payload_layout import MAX_FINER

# How much coarser than it should be a grid may be before it is halved.
SLACK: Final = 1.25


@dataclass(frozen=True)
class Reference:
    """A decoded frame that another one is predicted from.

    Attributes
    ----------
    parameters : Parameters
    integers : Integers
    vertices : float64 (n + i, 3)
        Isolated ones come last.
    doubt : float
        How far the vertices of another decoder may be from these.
    """

    parameters: Parameters
    integers: Integers
    vertices: Floats
    doubt: float = 0.0


@dataclass(frozen=True)
class Prediction:
    """What the frame before tells of the next one.

    Attributes
    ----------
    first : Parameters
        Those of frame 0, whose origin and grid all frames have.
    reference : Reference
        The frame before, whose anchors and exponents are those of all frames, too.
    motion : Motion or None
    positions : float64 (n, 3)
        Somewhere near the vertices of the faces, from where a solver may start.
    deltas : float64 (n, 3)
        The deltas to expect; those positions, where there are no anchors.
    """

    first: Parameters
    reference: Reference
    motion: Motion | None
    positions: Floats
    deltas: Floats

    def anchor_step(self, wanted: float) -> float:
        """Return the step of the grid of the anchors, halved until it is about as wanted."""
        step = self.first.anchor_step
        return math.ldexp(step, -halvings(step, SLACK * wanted))


def predicted(
    surface: Surface,
    first: Parameters,
    reference: Reference,
    motion: Motion | None,
    systems: Systems,
) -> Prediction:
    """Return what a decoded frame, and a motion since, tell of another one."""
    positions = reference.vertices[: surface.vertex_count]
    if motion is not None:
        deltas = carried(positions, motion, systems.cells_apart(motion.count))
    elif METHODS[first.method].anchored:
        deltas = laplacian.apply(*surface.graph, positions)
    else:
        deltas = positions
    return Prediction(first, reference, motion, positions, deltas)


def origin_of(predicted: Prediction | None) -> Floats | None:
    """Return the origin of the grids of all frames, float64 (3,), None for the first frame."""
    return None if predicted is None else np.array(predicted.first.origin)


def halvings(step: float, wanted: float) -> int:
    """Return how often a step is to be halved so that it is not above what is wanted."""
    if not 0 < wanted < step:
        return 0
    (m, e), (least, octave) = math.frexp(step), math.frexp(wanted)
    return min(e - octave + (m > least), MAX_FINER)


def finer(first: Parameters, parameters: Parameters) -> int:
    """Return how often the grid of a frame has halved that of frame 0."""
    coarse, fine = _grid(first), _grid(parameters)
    return math.frexp(coarse)[1] - math.frexp(fine)[1]


def at_step(first: Parameters, step: float, coarse: float, finer: int) -> Parameters:
    """Return the parameters of a frame, from those of frame 0."""
    grid = math.ldexp(first.anchor_step, -finer)
    return replace(first, step=step, coarse=coarse, anchor_step=grid)


def _grid(parameters: Parameters) -> float:
    return parameters.anchor_step if METHODS[parameters.method].anchored else parameters.step
