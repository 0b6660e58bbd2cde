"""High-pass method: quantized delta coordinates and anchors.

O. Sorkine, D. Cohen-Or, S. Toledo, "High-Pass Quantization for Mesh Encoding", SGP 2003;
D. Cohen-Or, O. Sorkine, "Encoding Meshes in Differential Coordinates", SCCG 2006.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from deltamesh._geometry import steps
from deltamesh._geometry.anchor_sections import decode, decode_frame, encode, encode_frame
from deltamesh._geometry.anchoring import anchored
from deltamesh._geometry.deltas import coarse_steps, deltas, step_of
from deltamesh._geometry.importance import largest_distances, without_bits
from deltamesh._geometry.integers import Integers, Quantized
from deltamesh._geometry.positions import all_positions, doubt, fitted, solved
from deltamesh._geometry.prediction import Prediction, origin_of
from deltamesh._geometry.quantize import Rounding, quantize_delta, to_grid
from deltamesh._geometry.systems import Systems
from deltamesh._kernels.mesh import laplacian
from deltamesh._options import Settings
from deltamesh._shape.surface import Surface
from deltamesh._vectors import safe_lengths
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.container import Parameters

# The functions of the method, and of them what the refined method shares.
__all__ = [
    "anchored",
    "coarse_steps",
    "corrected",
    "decode",
    "decode_frame",
    "deltas",
    "encode",
    "encode_frame",
    "origin_of",
    "quantize",
    "reconstruct",
    "step_of",
]


def quantize(
    surface: Surface,
    vertices: Floats,
    isolated: Floats,
    settings: Settings,
    systems: Systems,
    predicted: Prediction | None = None,
) -> Quantized:
    """Choose steps and anchors, and round deltas and anchors."""
    delta = laplacian.apply(*surface.graph, vertices)
    expected: Floats | float = 0.0 if predicted is None else predicted.deltas
    delta -= expected
    step, exponents = steps.chosen(settings, surface, step_of(vertices, delta, settings))
    values = np.zeros((surface.vertex_count, 3), dtype=np.int64)
    integers, none = Integers(values, exponents=exponents), without_bits(settings)
    if step:
        rounding, each = (
            Rounding(tangential=float(settings.diffusion)),
            step * steps.ratios(integers),
        )
        values = quantize_delta(delta, surface.graph, each, rounding, none=none)
        integers = replace(integers, values=values)
    parameters, integers = anchored(
        surface, vertices, isolated, integers, step, settings, systems, predicted
    )
    rounded = deltas(parameters, integers)
    parameters, integers, start = fitted(
        *(delta - rounded, vertices, isolated, parameters, integers, systems),
        origin=origin_of(predicted),
        none=none,
    )
    W = solved(rounded + expected, parameters, integers, systems, start=start)
    return corrected(W, vertices, parameters, integers, settings)


def reconstruct(
    surface: Surface,
    parameters: Parameters,
    integers: Integers,
    systems: Systems,
    predicted: Prediction | None = None,
) -> Floats:
    """Solve [L; S] x = [delta'; c] in the least-squares sense, and add the corrections."""
    delta, start = deltas(parameters, integers), None
    if predicted is not None:
        delta, start = delta + predicted.deltas, predicted.positions.copy()
    W = solved(delta, parameters, integers, systems, start=start)
    return all_positions(W, parameters, integers)


def corrected(
    W: Floats,
    vertices: Floats,
    parameters: Parameters,
    integers: Integers,
    settings: Settings,
) -> Quantized:
    """Correct the solution W, in steps, where it is too far from where the vertices were.

    Raises
    ------
    MeshError
        If a correction takes more than 2^30 steps.
    """
    error = vertices - W
    far = safe_lengths(error) > largest_distances(settings) - doubt(parameters)
    if parameters.step and far.any():
        each = parameters.step * steps.ratios(integers)
        fixes = to_grid(np.where(far[:, None], error, 0.0), np.zeros(3), each)
        if fixes.any():
            integers = replace(integers, corrections=fixes)
    return parameters, integers, all_positions(W, parameters, integers)
