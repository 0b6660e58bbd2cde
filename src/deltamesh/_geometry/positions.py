"""Positions of deltas and anchors: what the decoder solves for, and what the encoder fits to that.

The cells of interpolated anchors have a vector at each stage of a method: what quantization has
taken from the sum of the deltas over the cell, in units that suit the stage.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np

from deltamesh._geometry import steps
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.integers import NO_CELLS, NONE, Integers
from deltamesh._geometry.interpolation import NORMAL_TOLERANCE, TOLERANCE
from deltamesh._geometry.quantize import check_size, from_grid, to_grid
from deltamesh._geometry.systems import Systems
from deltamesh._geometry.weighed_fit import moves
from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.container.container import Parameters

# Units of what a cell has lost, by the stages of a method, in octaves above the step; that of the
# stage which only makes normals may be coarse. Finer ones cost more bits than they save.
UNITS: Final = {"highpass": (-2,), "refined": (5, 1)}


def solved(
    delta: Floats,
    parameters: Parameters,
    integers: Integers,
    systems: Systems,
    stage: int = -1,
    start: Floats | None = None,
    tolerance: float | None = None,
) -> Floats:
    """Return the vertices of the faces that deltas and anchors make.

    Parameters
    ----------
    delta : float64 (n, 3)
        They are used up.
    parameters, integers, systems
    stage : int
        Of the method; the last by default.
    start : float64 (n, 3), optional
        Something near, which saves time where anchors are interpolated, and takes the result.
    tolerance : float, optional
        See `Interpolation.solve`. Default: that of a decoder.
    """
    grid = parameters.anchor_step * steps.anchor_ratios(integers)
    anchors = from_grid(integers.positions, np.array(parameters.origin), grid)
    if not parameters.interpolated:
        return systems.least_squares(integers.anchors).solve(delta, anchors)
    system = systems.interpolation(integers.anchors)
    lost = vectors(parameters, integers, system.cells, stage)
    each = steps.of_vertices(parameters.step, integers)
    is_last = stage in (-1, len(UNITS[parameters.method]) - 1)
    tolerance = tolerance or (TOLERANCE if is_last else NORMAL_TOLERANCE) * systems.precision
    delta = system.cells.completed(delta, lost, out=delta)
    return system.solve(delta, anchors, each, tolerance, start)


def vectors(parameters: Parameters, integers: Integers, cells: Cells, stage: int) -> Floats:
    """Return what is added to the deltas of each cell at a stage, float64 (k, 3)."""
    result = np.zeros((len(cells.anchors), 3))
    if len(integers.cells):
        shared = cells.shared
        unit = _unit(parameters, integers, stage)[shared]
        result[shared] = integers.cells[stage] * unit / cells.sizes[shared]
    return result


def with_vectors(
    y: Floats, parameters: Parameters, integers: Integers, cells: Cells, stage: int
) -> Integers:
    """Return the integers with y, float64 (k, 3), rounded, for the cells at a stage."""
    shared = cells.shared
    integers = replace(integers, units=np.array(UNITS[parameters.method]))
    unit = _unit(parameters, integers, stage)[shared]
    rounded = np.rint(y[shared] * cells.sizes[shared] / unit)
    check_size(rounded, unit)
    found = integers.cells.copy()
    if not len(found):
        found = np.zeros((len(UNITS[parameters.method]), len(shared), 3), dtype=np.int64)
    found[stage] = rounded
    if not found.any():
        return replace(integers, cells=NO_CELLS, units=NONE)
    return replace(integers, cells=found)


def _unit(parameters: Parameters, integers: Integers, stage: int) -> Floats:
    """Return the unit of the vectors of each anchor's cell, float64 (k, 1)."""
    unit = np.ldexp(parameters.step, integers.units[stage])
    return np.asarray(unit * steps.anchor_ratios(integers), dtype=np.float64)


def placed(
    positions: Floats,
    vertices: Floats,
    isolated: Floats,
    parameters: Parameters,
    integers: Integers,
    origin: Floats | None = None,
) -> tuple[Parameters, Integers]:
    """Return both with the positions of the anchors and of the isolated vertices, on grids.

    Parameters
    ----------
    positions : float64 (k, 3)
        Of the anchors.
    vertices, isolated : float64 (n, 3), (i, 3)
    origin : float64 (3,), optional
        Of the grids. Default: the least corner of all.
    """
    grid, extra = parameters.anchor_step, steps.extra_bits(integers.exponents, len(vertices))
    if origin is None:
        origin = _corner(np.concatenate([vertices, isolated]), positions, grid)
    each = grid * steps.anchor_ratios(integers)
    anchors = to_grid(positions, origin, each, extra[integers.anchors, None])
    integers = replace(integers, positions=anchors, isolated=to_grid(isolated, origin, grid))
    x, y, z = map(float, origin)
    return replace(parameters, origin=(x, y, z)), integers


def _corner(vertices: Floats, positions: Floats, grid: float) -> Floats:
    """Return the least corner of vertices and of positions of anchors, which may be outside.

    By whole steps from that of the vertices, it is no result of a solver.
    """
    corner = vertices.min(axis=0)
    if not len(positions):
        return np.asarray(corner)
    return np.asarray(
        corner - grid * np.ceil(np.maximum(corner - positions.min(axis=0), 0.0) / grid)
    )


def fitted(
    left: Floats,
    vertices: Floats,
    isolated: Floats,
    parameters: Parameters,
    integers: Integers,
    systems: Systems,
    origin: Floats | None = None,
    none: Bools | None = None,
) -> tuple[Parameters, Integers, Floats]:
    """Return both with anchors that fit the deltas and, interpolated, vectors of the last stage.

    Parameters
    ----------
    left : float64 (n, 3)
        What quantization has left of the deltas; it is used up.
    vertices, isolated : float64 (n, 3), (i, 3)
    origin : float64 (3,), optional
        See `placed`.
    none : bool (n,), optional
        Vertices without bits, of whose deltas all is left: they do not move the others.

    Returns
    -------
    Parameters, Integers
    float64 (n, 3)
        About where the vertices will be.
    """
    if not len(integers.anchors):
        return parameters, integers, vertices
    anchors, cells = integers.anchors, systems.cells(integers.anchors)
    # Components are apart, and each is fitted in units of its own; of 0 bits, it has none.
    each = parameters.step * steps.ratios(integers)
    scale = cells.least(each) if parameters.step else np.ones_like(each)
    left /= scale
    if parameters.interpolated:
        y, e = systems.fit(anchors).exact(kept(left, none))
        if none is not None:
            further, far = systems.fit(anchors).exact(left)
            y, e = balanced(y, further, left, none, cells), np.where(none[:, None], far, e)
        integers = with_vectors(y * scale[anchors], parameters, integers, cells, -1)
        near = vertices - e * scale
        fit = near[anchors]
    else:
        d, e = moves(systems.least_squares(anchors), cells, kept(left, none))
        near = vertices + e * scale
        fit = vertices[anchors] + d * scale[anchors]
    parameters, integers = placed(fit, vertices, isolated, parameters, integers, origin)
    return parameters, integers, near


def kept(left: Floats, none: Bools | None) -> Floats:
    """Return what is left of deltas, float64 (n, 3), without that of vertices without bits."""
    return left if none is None else np.where(none[:, None], 0.0, left)


def balanced(y: Floats, further: Floats, left: Floats, none: Bools, cells: Cells) -> Floats:
    """Return vectors of the cells with which the deltas of each component have no mean.

    A decoder takes that off everywhere, and what vertices without bits lack would be felt by all.

    Parameters
    ----------
    y, further : float64 (k, 3)
        Those of the cells if nothing is left where there are no bits; and if all is: of anchors
        there.
    left : float64 (n, 3)
    none : bool (n,)
    cells : Cells
    """
    has_none = none[cells.anchors]
    y = np.where(has_none[:, None], further, y)
    sums = cells.sums(left) - y * cells.sizes
    count = np.bincount(cells.of, none, len(cells.anchors))
    of_component = cells.labels[cells.anchors]

    def total(x: Floats) -> Floats:
        return np.stack([np.bincount(of_component, c)[of_component] for c in x.T], axis=1)

    own = np.where(has_none, count, 0.0)[:, None]
    share = np.where(total(own) > 0, own, count[:, None])
    return y + total(sums) * share / np.maximum(total(share), 1) / cells.sizes


def smoothed(
    left: Floats,
    parameters: Parameters,
    integers: Integers,
    systems: Systems,
    none: Bools | None = None,
) -> Integers:
    """Return the integers with vectors of the first stage that need no solve; see `fitted`."""
    fit, cells = systems.fit(integers.anchors), systems.cells(integers.anchors)
    y = fit.smooth(kept(left, none))
    if none is not None:
        y = balanced(y, fit.smooth(left), left, none, cells)
    return with_vectors(y, parameters, integers, cells, 0)


def doubt(parameters: Parameters) -> float:
    """Return how far the vertices of another decoder may be from those of this one.

    Where anchors are weighed in least squares that is a share of the diagonal, see `bounds`.
    """
    solved = parameters.interpolated and parameters.anchor_count
    return math.sqrt(3) * TOLERANCE * parameters.step if solved else 0.0


def all_positions(vertices: Floats, parameters: Parameters, integers: Integers) -> Floats:
    """Return the solution with its corrections, then the isolated vertices."""
    if len(integers.corrections):
        vertices = vertices + parameters.step * steps.ratios(integers) * integers.corrections
    isolated = from_grid(integers.isolated, np.array(parameters.origin), parameters.anchor_step)
    return np.concatenate([vertices, isolated])


def grid_points(vertices: Floats, parameters: Parameters, integers: Integers) -> Floats:
    """Return where each vertex would be as an anchor, float64 (n, 3)."""
    if not len(vertices):
        return vertices
    origin, ratios = vertices.min(axis=0), steps.ratios(integers)
    extra: Ints = steps.extra_bits(integers.exponents, len(vertices))
    each = parameters.anchor_step * ratios
    return from_grid(to_grid(vertices, origin, each, extra[:, None]), origin, each)
