"""Quantization as the codec does it: of deltas, plain or diffused, and of Cartesian coordinates."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from deltamesh._geometry import quantize
from deltamesh._options import MAX_BITS
from deltamesh._streams.vectors import encode_vectors
from deltamesh.differential._graphs import graph_of, integers_of, numbers_of, rows_of
from deltamesh_formats.arguments import require_number, require_whole
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.errors import OptionError

if TYPE_CHECKING:
    from deltamesh.differential._graphs import Sparse


def step_of(values: ArrayLike, bits: int) -> float:
    """Return the step of so many bits: the longest side of the box around rows (n, c) / 2^bits.

    1 if all are the same. O. Sorkine, D. Cohen-Or, S. Toledo, "High-Pass Quantization for Mesh
    Encoding", SGP 2003.

    Raises
    ------
    OptionError
        If the values are no such rows, or bits are not in 1 to 30.
    """
    require_whole("bits", bits, 1, MAX_BITS)
    return quantize.delta_step(rows_of(values, None, "values"), bits)


def quantized_deltas(
    L: Sparse, delta: ArrayLike, step: float | ArrayLike, diffusion: float = 1.0
) -> Ints:
    """Return the integers whose products with the step stand for deltas.

    Parameters
    ----------
    L : csr_array (n, n)
        From `laplacian`.
    delta : float array (n, 3)
    step : float, or float array (n,)
        Of all vertices, or of each; positive, in the unit of the deltas.
    diffusion : float
        Share of the rounding error of a vertex that goes on, in equal parts, to its neighbours of
        higher numbers. 0 is plain rounding, as in the papers; 1 is what method "highpass" does.

    Returns
    -------
    int64 (n, 3)

    Raises
    ------
    OptionError
        If the shapes do not agree.
    MeshError
        If a step is so small that numbers would not fit a file.
    """
    graph = graph_of(L)
    n = len(graph[0]) - 1
    require_number("diffusion", diffusion, 0, 1)
    steps = numbers_of(step, "steps")
    if steps.shape not in ((), (n,)) or not ((steps > 0) & (steps < math.inf)).all():
        raise OptionError("steps are no positive number, nor one for each vertex")
    each = steps.reshape(-1, 1) if steps.ndim else float(steps)
    rows = rows_of(delta, n, "deltas", 3)
    return quantize.quantize_delta(rows, graph, each, quantize.Rounding(tangential=diffusion))


def coded_size(L: Sparse, values: Ints) -> int:
    """Return the bytes that the codec takes for quantized deltas, int64 (n, 3).

    Vertices in coding order, that of a decoded file, take the fewest.
    """
    rows = integers_of(values, "values")
    graph = graph_of(L)
    if rows.shape != (len(graph[0]) - 1, 3):
        raise OptionError(f"values have shape {rows.shape}, not ({len(graph[0]) - 1}, 3)")
    return len(encode_vectors(*graph, rows))


def quantized_positions(vertices: ArrayLike, bits: int) -> Floats:
    """Return positions on the grid of the Cartesian method, float64 (n, 3).

    Its step is the longest side of the bounding box over 2^bits - 1; ends of that side stay where
    they are.

    Raises
    ------
    OptionError
        If the vertices have another shape, or bits are not in 1 to 30.
    """
    require_whole("bits", bits, 1, MAX_BITS)
    V = rows_of(vertices, None, "vertices", 3)
    if not len(V):
        return V
    origin, step = V.min(axis=0), quantize.grid_step(V, bits)
    return quantize.from_grid(quantize.to_grid(V, origin, step), origin, step)
