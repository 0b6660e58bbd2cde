"""Refined method: coarse delta coordinates, and a fine correction along the normals.

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

from deltamesh._geometry import highpass, steps
from deltamesh._geometry.importance import without_bits
from deltamesh._geometry.integers import Integers, Quantized, without_deltas
from deltamesh._geometry.normals import vertex_normals
from deltamesh._geometry.positions import all_positions, fitted, smoothed, solved
from deltamesh._geometry.prediction import Prediction
from deltamesh._geometry.quantize import Rounding, quantize_delta
from deltamesh._geometry.systems import Systems
from deltamesh._kernels.coding import residual
from deltamesh._kernels.coding.delta import code_refinements
from deltamesh._kernels.mesh import laplacian
from deltamesh._options import Settings
from deltamesh._shape.surface import Surface
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh_formats.array_types import Floats, Shorts
from deltamesh_formats.container.container import Parameters, Section
from deltamesh_formats.container.layout import NORMALS
from deltamesh_formats.container.sections import payload_of

# Rounding of the coarse deltas, and of the refinements. Sizes at equal normals of 1 and 4 degrees,
# and at both angles of Draco's files of 10 and 12 bits, are means over six meshes: nearest
# integers, with a dead zone of 0.05 alone, make them 8 % larger. An error of the coarse stage along
# the normal costs bits in the fine one, and bends what that goes along: weights of 1, 1.8, 2.5 and
# 8 cost 4, 1.5, 0.5 and 3 % more than 3.2. Pulls of 0.15 and 0.5 in the coarse stage cost 1 %, and
# so does one of 0.1 in the fine stage.
# The coarse stage hands on a part of what the fine one corrects: where deltas are a fraction of a
# step long across the surface, handing on none costs 10 to 30 %, since the surface would bend until
# normals mislead; where they are steps long that is the best, and 0.65 costs 1 to 4 %. The share is
# `normal` over (1 + m)^2, where m is their mean length in steps. The fine stage hands on what it
# cannot correct, for a neighbour whose normal points elsewhere; all of it would pile up where none
# does, and costs 3 %.
COARSE = Rounding(zone=0.05, pull=0.25, weight=3.2, tangential=1.0, normal=0.9)
FINE = Rounding(pull=0.2, tangential=0.9, normal=0.8)
# Both are less where what deltas have across the surface varies from neighbour to neighbour by less
# than that share: of equal numbers they make noise, and a sphere a quarter larger.
VARIED = 0.1
# The tolerance of normals that only steer what is rounded, in steps.
ROUGHLY = 0.03


def quantize(
    surface: Surface,
    vertices: Floats,
    isolated: Floats,
    settings: Settings,
    systems: Systems,
    predicted: Prediction | None = None,
) -> Quantized:
    """Quantize as `highpass.quantize` does, coarsely; then the remainder along the normals."""
    graph, origin = surface.graph, highpass.origin_of(predicted)
    delta = laplacian.apply(*graph, vertices)
    if predicted is not None:
        delta -= predicted.deltas
    step = highpass.step_of(vertices, delta, settings)
    step, exponents = steps.chosen(settings, surface, step)
    integers = Integers(np.zeros_like(delta, dtype=np.int64), exponents=exponents)
    none = without_bits(settings)
    each = step * steps.ratios(integers)
    N = vertex_normals(vertices, surface.faces, each)
    coarse_step = settings.coarse * each
    roundings = [
        one if settings.diffusion else replace(one, tangential=0.0, normal=0.0)
        for one in (_coarse_rounding(delta, graph, coarse_step, N), FINE)
    ]
    values = quantize_delta(delta, graph, coarse_step, roundings[0], normals=N, none=none)
    integers = replace(integers, values=values)
    parameters, integers = highpass.anchored(
        surface, vertices, isolated, integers, step, settings, systems, predicted
    )
    parameters = replace(parameters, dead_zone=COARSE.zone, normal_dead_zone=FINE.zone)
    delta -= highpass.deltas(parameters, integers)
    left = delta
    if parameters.interpolated:
        integers = smoothed(left, parameters, integers, systems, none)
    W, N = _bent(surface, systems, parameters, integers, predicted, vertices.copy(), ROUGHLY)
    fine = quantize_delta(left, graph, each, roundings[1], normals=N, along=True, none=none)
    integers = replace(integers, refinements=fine)
    left -= np.multiply(each * fine, N, out=N)
    del N  # what the fit does not need makes room for it
    parameters, integers, near = fitted(
        left, vertices, isolated, parameters, integers, systems, origin, none
    )
    # The anchors have moved a little, and the normals with them.
    _, N = _bent(surface, systems, parameters, integers, predicted, W)
    W = near
    coarse = _coarse(parameters, integers, predicted)
    coarse += np.multiply(each * fine, N, out=N)
    W = solved(coarse, parameters, integers, systems, start=W)
    return highpass.corrected(W, vertices, parameters, integers, settings)


def _coarse_rounding(
    delta: Floats, graph: tuple[Shorts, Shorts], step: Floats, normals: Floats
) -> Rounding:
    """Return the rounding of deltas, float64 (n, 3), by steps (n, 1)."""
    if not len(delta):
        return COARSE
    across = (delta * normals).sum(axis=1, keepdims=True)
    change = laplacian.apply(*graph, across) / np.diff(graph[0])[:, None]
    size = float(np.abs(across).mean())
    share = min(float(np.abs(change).mean()) / (VARIED * size), 1.0) if size else 1.0
    weight = 1 + share * (COARSE.weight - 1)
    normal = share * COARSE.normal / (1 + float(np.abs(across / step).mean())) ** 2
    return replace(COARSE, weight=weight, normal=normal)


def reconstruct(
    surface: Surface,
    parameters: Parameters,
    integers: Integers,
    systems: Systems,
    predicted: Prediction | None = None,
) -> Floats:
    """Solve for the coarse deltas, correct them along the normals, and solve again."""
    start = None if predicted is None else predicted.positions.copy()
    W, fine = _bent(surface, systems, parameters, integers, predicted, start)
    fine *= parameters.step * steps.ratios(integers) * integers.refinements
    fine += _coarse(parameters, integers, predicted)
    integers = without_deltas(integers)
    W = solved(fine, parameters, integers, systems, start=W)
    return all_positions(W, parameters, integers)


def _bent(
    surface: Surface,
    systems: Systems,
    parameters: Parameters,
    integers: Integers,
    predicted: Prediction | None,
    start: Floats | None = None,
    tolerance: float | None = None,
) -> tuple[Floats, Floats]:
    """Return the surface that the coarse deltas make, and its normals; see `solved`."""
    coarse = _coarse(parameters, integers, predicted)
    W = solved(coarse, parameters, integers, systems, stage=0, start=start, tolerance=tolerance)
    return W, vertex_normals(W, surface.faces, highpass.coarse_steps(parameters, integers))


def _coarse(parameters: Parameters, integers: Integers, predicted: Prediction | None) -> Floats:
    """Return the deltas before any refinement."""
    coarse = highpass.deltas(parameters, integers)
    if predicted is not None:
        coarse += predicted.deltas
    return coarse


def encode(surface: Surface, parameters: Parameters, integers: Integers) -> dict[str, bytes]:
    """Return the payloads of the high-pass method, and of NORM."""
    payloads = highpass.encode(surface, parameters, integers)
    return {**payloads, NORMALS: _encode_refinements(surface, integers)}


def encode_frame(surface: Surface, parameters: Parameters, integers: Integers) -> dict[str, bytes]:
    """Return the payloads of a further frame, as `anchor_sections.encode_frame` does."""
    payloads = highpass.encode_frame(surface, parameters, integers)
    return {**payloads, NORMALS: _encode_refinements(surface, integers)}


def _encode_refinements(surface: Surface, integers: Integers) -> bytes:
    values = integers.refinements.copy()
    return encode_with(
        residual.MODEL,
        surface.vertex_count,
        lambda coder: code_refinements(coder, *surface.graph, integers.values, values),
    )


def decode(surface: Surface, parameters: Parameters, sections: Mapping[str, Section]) -> Integers:
    """Return the integers of the high-pass method, and the refinements."""
    return _with_refinements(surface, sections, highpass.decode(surface, parameters, sections))


def decode_frame(
    surface: Surface, parameters: Parameters, sections: Mapping[str, Section], first: Integers
) -> Integers:
    """Return the integers of a further frame: the mirror of `encode_frame`."""
    integers = highpass.decode_frame(surface, parameters, sections, first)
    return _with_refinements(surface, sections, integers)


def _with_refinements(
    surface: Surface, sections: Mapping[str, Section], integers: Integers
) -> Integers:
    refinements = np.zeros((surface.vertex_count, 1), dtype=np.int64)
    with payload_of(sections[NORMALS]) as payload:
        decode_with(
            residual.MODEL,
            payload,
            lambda coder: code_refinements(coder, *surface.graph, integers.values, refinements),
        )
    return replace(integers, refinements=refinements)
