"""Steps, grids and rounding.

The step of the papers: the range of the quantized values over 2^B, for B bits a coordinate
(O. Sorkine, D. Cohen-Or, S. Toledo, "High-Pass Quantization for Mesh Encoding", SGP 2003).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh._graph.adjacency import Graph
from deltamesh._kernels.coding import delta as kernels
from deltamesh._vectors import largest, sides
from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.container.payload_layout import MAX_GRID_BITS
from deltamesh_formats.errors import MeshError

# The entropy coder takes |value| < 2^31; a bit is to spare for diffused errors.
MOST_STEPS: Final = 1 << MAX_GRID_BITS


@dataclass(frozen=True)
class Rounding:
    """Rule by which numbers of steps are rounded, and shares of the error that go on.

    Each number is rounded up or down, so that what the numbers of a vertex cost together is the
    least: the squares of their errors, in steps, and what their bits are worth. By default that is
    the nearest integer.

    Attributes
    ----------
    zone : float
        Dead zone: what the first step of a number costs is as if it were rounded to 0 up to
        0.5 + zone steps.
    pull : float
        What each step costs more, in the same way, where the neighbours before are 0: that over
        1 + m, where their mean magnitude is m. A step costs the more bits, the smaller they are.
    weight : float
        How often the square of the error along the normal counts, where 3 numbers are rounded.
    tangential, normal : float
        The shares of the error that are handed on along the surface and across it; without normals,
        the first. Zeros are no diffusion.
    """

    zone: float = 0.0
    pull: float = 0.0
    weight: float = 1.0
    tangential: float = 0.0
    normal: float = 0.0


def delta_step(delta: Floats, bits: int) -> float:
    """Return range / 2^bits of the coordinate with the largest range; 1 when all are constant."""
    return float(sides(delta).max()) / 2.0**bits or 1.0


def grid_step(vertices: Floats, bits: int) -> float:
    """Return the longest side of the bounding box / (2^bits - 1); 1 when there is no extent."""
    return float(sides(vertices).max()) / (2.0**bits - 1) or 1.0


def to_grid(vertices: Floats, origin: Floats, step: float | Floats, extra: int | Ints = 0) -> Ints:
    """Return the nearest grid points, int64 (n, 3).

    Parameters
    ----------
    vertices : float64 (n, 3)
    origin : float64 (3,)
    step : float, or float64 (n, 1)
        Of all vertices, or of each.
    extra : int, or int64 (n, 1)
        Bits that a coordinate may take beyond `MAX_GRID_BITS`.

    Raises
    ------
    MeshError
        If a step is too small for the extent: a file holds up to 2^30 steps.
    """
    with np.errstate(divide="ignore", invalid="ignore"):  # a step below the least number is 0
        grid = np.rint((vertices - origin) / step)
    check_size(np.ldexp(grid, -extra), step)
    return grid.astype(np.int64)


def from_grid(grid: Ints, origin: Floats, step: float | Floats) -> Floats:
    """Return the positions of grid points, float64 (n, 3)."""
    return np.asarray(origin + grid * step, dtype=np.float64)


def to_delta(values: Ints, step: float | Floats) -> Floats:
    """Return the delta coordinates that quantized ones stand for, float64 (n, 3)."""
    return np.asarray(values * step, dtype=np.float64)


def quantize_delta(
    delta: Floats,
    graph: Graph,
    step: float | Floats,
    rounding: Rounding,
    *,
    normals: Floats | None = None,
    along: bool = False,
    none: Bools | None = None,
) -> Ints:
    """Round delta / step, or its component along the normals, diffusing the error.

    Diffusion visits the vertices in their order and hands the error of each on, in equal parts,
    to its neighbours that are still to come; the sum of the errors over any region then nearly
    vanishes, and with it the error in low frequencies. The decoder is the same.

    Parameters
    ----------
    delta : float64 (n, 3)
    graph : pair of int32 arrays
        Neighbours, from `adjacency.adjacency`.
    step : float, or float64 (n, 1)
        Of all vertices, or of each.
    rounding : Rounding
    normals : float64 (n, 3), optional
    along : bool
        Whether to round the component along the normals alone.
    none : bool (n,), optional
        Vertices that are rounded to 0, and hand no error on.

    Returns
    -------
    int64 (n, 3), or (n, 1) along the normals

    Raises
    ------
    MeshError
        If a step is too small for the deltas: a file holds up to 2^30 steps.
    """
    delta = delta.copy()
    if none is not None:
        delta[none] = 0
    with np.errstate(divide="ignore", invalid="ignore"):
        check_size(delta / step, step)
    N = np.zeros_like(delta) if normals is None else normals
    steps = np.broadcast_to(step, (len(delta), 1))[:, 0].copy()
    out = np.empty((len(delta), 1 if along else 3), dtype=np.int64)
    r = rounding
    rule = r.zone, r.pull, r.weight, r.tangential, r.normal
    kernels.diffuse(*graph, delta, N, steps, *rule, out)
    if none is not None:  # what others have handed on to them
        out[none] = 0
    return out


def check_size(steps: Floats | Ints, step: float | Floats) -> None:
    """Refuse numbers of steps that the entropy coder does not take.

    Raises
    ------
    MeshError
    """
    if not largest(steps) < MOST_STEPS:
        raise MeshError(f"a quantization step of {np.min(step):g} is too small for this mesh")
