"""Quantized delta coordinates: their coding, and the diffusion of their quantization error.

Vertices come in coding order; a neighbour j of i is known when j < i. The contexts are the
magnitudes and signs around. See `src/core/delta.c`.
"""

from __future__ import annotations

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.core import call, floats, floats_out, graph, ints, ints_out
from deltamesh_formats.array_types import Floats, Ints, Shorts


def code_deltas(c: Coder, indptr: Shorts, indices: Shorts, values: Ints) -> None:
    """Code `values` (n, 3), filled in place when decoding; for the graph, see `adjacency`."""
    n = len(values)
    call("dm_code_deltas", c.pointer, *graph(indptr, indices, n), ints_out(values, n, 3))


def code_refinements(c: Coder, indptr: Shorts, indices: Shorts, deltas: Ints, values: Ints) -> None:
    """Code `values` (n, 1), filled in place when decoding, where the `deltas` (n, 3) are known."""
    n = len(values)
    around = *graph(indptr, indices, n), ints(deltas, n, 3)
    call("dm_code_refinements", c.pointer, *around, ints_out(values, n, 1))


def diffuse(
    indptr: Shorts,
    indices: Shorts,
    delta: Floats,
    normals: Floats,
    steps: Floats,
    zone: float,
    pull: float,
    weight: float,
    tangential: float,
    normal: float,
    out: Ints,
) -> None:
    """Round delta / step into `out` (n, 3), or its component along `normals` into `out` (n, 1).

    Each vertex has its own of the `steps` (n,). See `quantize.Rounding` for the other numbers. The
    error is passed on, in equal parts, to the neighbours that are still to come, into `delta`
    (n, 3), which is used up: the share `normal` of its component along the normal, the share
    `tangential` of the rest.
    """
    n, columns = out.shape
    vectors = floats_out(delta, n, 3), floats(normals, n, 3), floats(steps, n)
    rule = float(zone), float(pull), float(weight), float(tangential), float(normal)
    given = *graph(indptr, indices, n), *vectors, *rule, columns
    call("dm_diffuse", *given, ints_out(out, n, columns))
