"""The refined method: coarse delta coordinates, and a fine correction along the normals.

An error along the surface only slides a vertex within it; normals and dihedral angles feel the
error across it. So the deltas are quantized with `coarse` times the step, the surface is
reconstructed, and along its normals, which the decoder has as well, what is left of the deltas is
quantized with the step itself. Both reconstructions share one factorization. The corrections are
coded in the light of integers alone: the normals, floats, never steer the decoder.

Coarser tangential components are an old idea for residuals in local frames (P. Alliez, M. Desbrun,
"Progressive Compression for Lossless Transmission of Triangle Meshes", SIGGRAPH 2001, section 4).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from deltamesh import entropy, highpass
from deltamesh.geometry import Integers, Surface, payload_of
from deltamesh.kernels import delta as kernels
from deltamesh.kernels import residual
from deltamesh.laplacian import adjacency_laplacian
from deltamesh.normals import vertex_normals
from deltamesh.options import Options
from deltamesh.quantize import quantize_delta
from deltamesh.solve import LeastSquares
from deltamesh_formats.layout import Parameters, Section


def quantize(
    surface: Surface,
    vertices: NDArray[np.float64],
    isolated: NDArray[np.float64],
    options: Options,
) -> tuple[Parameters, Integers]:
    """Quantize as `highpass.quantize` does, coarsely; then what is left along the normals."""
    parameters, integers = highpass.quantize(surface, vertices, isolated, options)
    L = adjacency_laplacian(*surface.graph)
    system = LeastSquares(L, integers.anchors, options.solver, options.threads)
    coarse, N = _stage(surface, system, parameters, integers)
    left = ((L @ vertices - coarse) * N).sum(axis=1, keepdims=True)
    zone = parameters.normal_dead_zone
    refinements = quantize_delta(left, surface.graph, parameters.step, options.diffusion, zone)
    return parameters, replace(integers, refinements=refinements)


def reconstruct(
    surface: Surface,
    parameters: Parameters,
    integers: Integers,
    solver: str,
    threads: int | None,
) -> NDArray[np.float64]:
    """Solve for the coarse deltas, correct them along the normals, and solve again.

    Raises
    ------
    SolveError
    """
    system = LeastSquares(adjacency_laplacian(*surface.graph), integers.anchors, solver, threads)
    coarse, N = _stage(surface, system, parameters, integers)
    fine = coarse + (parameters.step * integers.refinements) * N
    vertices = system.solve(fine, highpass.anchor_positions(parameters, integers))
    return highpass.with_isolated(vertices, parameters, integers)


def _stage(
    surface: Surface, system: LeastSquares, parameters: Parameters, integers: Integers
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the coarse deltas, and the normals of the surface that they make."""
    coarse = highpass.deltas(parameters, integers)
    vertices = system.solve(coarse, highpass.anchor_positions(parameters, integers))
    step = parameters.coarse * parameters.step
    return coarse, vertex_normals(vertices, surface.faces, step)


def write(surface: Surface, parameters: Parameters, integers: Integers) -> dict[str, bytes]:
    """Return the payloads of ANCH, DELT and NORM."""
    coder = entropy.encoder(surface.vertex_count, residual.SLOTS, residual.MIXERS)
    values = integers.refinements.copy()
    kernels.code_refinements(coder, *surface.graph, integers.values, values)
    return {**highpass.write(surface, parameters, integers), "NORM": entropy.finish(coder)}


def read(surface: Surface, parameters: Parameters, sections: Mapping[str, Section]) -> Integers:
    """Return the integers: the mirror of `write`.

    Raises
    ------
    FormatError
    """
    integers = highpass.read(surface, parameters, sections)
    refinements = np.zeros((surface.vertex_count, 1), dtype=np.int64)
    with payload_of(sections["NORM"]) as payload:
        coder = entropy.decoder(payload, residual.SLOTS, residual.MIXERS)
        kernels.code_refinements(coder, *surface.graph, integers.values, refinements)
        entropy.check_end(coder, 0)
    return replace(integers, refinements=refinements)
