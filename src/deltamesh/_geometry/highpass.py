"""High-pass method: quantized delta coordinates and anchors.

O. Sorkine, D. Cohen-Or, S. Toledo, "High-Pass Quantization for Mesh Encoding", SGP 2003;
D. Cohen-Or, O. Sorkine, "Encoding Meshes in Differential Coordinates", SCCG 2006.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from deltamesh._geometry import anchors as choice
from deltamesh._geometry import steps
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.importance import holding, largest_distances, without_bits
from deltamesh._geometry.integers import NO_POINTS, Integers, Quantized
from deltamesh._geometry.positions import (
    UNITS,
    all_positions,
    doubt,
    fitted,
    grid_points,
    placed,
    solved,
)
from deltamesh._geometry.prediction import Prediction
from deltamesh._geometry.quantize import Rounding, delta_step, quantize_delta, to_delta, to_grid
from deltamesh._geometry.systems import Systems
from deltamesh._graph.adjacency import without_edges
from deltamesh._kernels.coding import points
from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.mesh import laplacian
from deltamesh._options import Settings
from deltamesh._shape.surface import Surface
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh._streams.vectors import decode_vectors, encode_vectors
from deltamesh._vectors import safe_lengths, sides
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container import layout
from deltamesh_formats.container.container import Parameters, Section
from deltamesh_formats.container.reader import payload_of, take
from deltamesh_formats.errors import FormatError, OptionError
from deltamesh_formats.polymesh.permutations import distinct

# The grid of the anchors is that much finer than the step of the deltas: with diffusion, the
# error of the surface between anchors is about a fifth of that step, and theirs should not show.
ANCHOR_REFINEMENT = 8
# ... and at least as fine as that fraction of the longest side; or as another one of 0 bits, where
# the surface errs by far more.
ANCHOR_GRID_BITS, BARE_GRID_BITS = 16, 14


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
        seed=settings.seed if anchor_method == layout.RANDOM else 0,
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
        parameters = replace(parameters, anchor_method=layout.GREEDY, seed=0)
    integers = replace(integers, anchors=anchors)
    parameters = replace(parameters, anchor_count=len(anchors))
    return placed(vertices[anchors], vertices, isolated, parameters, integers)


def origin_of(predicted: Prediction | None) -> Floats | None:
    """Return the origin of the grids of all frames, float64 (3,), None for the first frame."""
    return None if predicted is None else np.array(predicted.first.origin)


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


def deltas(parameters: Parameters, integers: Integers) -> Floats:
    """Return the delta coordinates as they were quantized, before any refinement."""
    return to_delta(integers.values, coarse_steps(parameters, integers))


def coarse_steps(parameters: Parameters, integers: Integers) -> Floats:
    """Return the step of the deltas of each vertex, float64 (n, 1)."""
    return parameters.coarse * (parameters.step * steps.ratios(integers))


def step_of(vertices: Floats, delta: Floats, settings: Settings) -> float:
    """Return the quantization step of the settings, 0 for 0 bits."""
    if settings.bits is not None:
        return delta_step(delta, settings.bits) if settings.bits else 0.0
    assert settings.step is not None
    return settings.step


def _coarse_of(settings: Settings) -> float:
    return settings.coarse if settings.layout.coarse else 1.0


def _anchor_step(vertices: Floats, step: float) -> float:
    """Return the step of the grid of the anchors."""
    extent = float(sides(vertices).max())
    if not step:
        return extent / 2.0**BARE_GRID_BITS or 1.0
    coarsest = extent / 2.0**ANCHOR_GRID_BITS or math.inf  # a point is on any grid
    finest = extent / 2.0 ** (layout.MAX_GRID_BITS - 1)
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
    if parameters.anchor_method == layout.FARTHEST:
        return systems.farthest(k)
    if parameters.anchor_method != layout.GREEDY:
        return _computed(surface, str(parameters.anchor_method), k, parameters.seed)
    delta, fixed = deltas(parameters, integers), grid_points(vertices, parameters, integers)
    system = systems.of_choice
    return np.sort(choice.greedy(surface.graph, vertices, delta, k, fixed, system))


def _how_many(surface: Surface, settings: Settings) -> tuple[str, int]:
    """Return how anchors are chosen, and how many."""
    n, components = surface.vertex_count, int(surface.labels.max(initial=-1)) + 1
    try:
        k = choice.count_anchors(settings.anchors, n, components)
    except ValueError as error:
        raise OptionError(str(error)) from None
    return choice.method_of(settings, n, components, k), k


def _computed(surface: Surface, method: str, k: int, seed: int) -> Ints:
    """Return the anchors that follow from connectivity and seed."""
    if method == layout.RANDOM:
        return choice.random(surface.labels, k, seed)
    return choice.farthest(*surface.graph, surface.labels, k)


def encode(surface: Surface, parameters: Parameters, integers: Integers) -> dict[str, bytes]:
    """Return the payloads of the sections that both methods with anchors have.

    They are ANCH and DELT; STEP, where steps differ; CELL, where cells have lost anything; FIXS, if
    positions are corrected.
    """
    return {
        **steps.encode(surface, integers.exponents),
        layout.ANCHORS: _encode_anchors(surface, parameters, integers),
        **_encode_vectors(surface, parameters, integers),
    }


def encode_frame(surface: Surface, parameters: Parameters, integers: Integers) -> dict[str, bytes]:
    """Return the payloads of a further frame, whose positions are relative to another's."""
    points = np.concatenate([integers.positions, integers.isolated])
    return {
        layout.ANCHORS: encode_vectors(*without_edges(len(points)), points),
        **_encode_vectors(surface, parameters, integers),
    }


def _encode_vectors(
    surface: Surface, parameters: Parameters, integers: Integers
) -> dict[str, bytes]:
    payloads = {
        layout.DELTAS: encode_vectors(*surface.graph, integers.values) if parameters.step else b"",
    }
    if len(integers.cells):
        rows = integers.cells.reshape(-1, 3)
        stream = encode_vectors(*without_edges(len(rows)), rows)
        payloads[layout.CELLS] = bytes((integers.units - layout.LEAST_UNIT).tolist()) + stream
    if len(integers.corrections):
        payloads[layout.CORRECTIONS] = encode_vectors(*surface.graph, integers.corrections)
    return payloads


def decode(surface: Surface, parameters: Parameters, sections: Mapping[str, Section]) -> Integers:
    """Return exponents, anchors, deltas and corrections."""
    exponents = steps.decode(surface, parameters, sections)
    extra = steps.extra_bits(exponents, surface.vertex_count)
    with payload_of(sections[layout.ANCHORS]) as payload:
        anchors, positions, isolated = _decode_anchors(surface, parameters, payload, extra)
    still = Integers(NO_POINTS, anchors, positions, isolated, exponents=exponents)
    return _decode_vectors(surface, parameters, sections, still)


def decode_frame(
    surface: Surface, parameters: Parameters, sections: Mapping[str, Section], first: Integers
) -> Integers:
    """Return the integers of a further frame, with anchors and exponents of the first one."""
    k = len(first.anchors)
    with payload_of(sections[layout.ANCHORS]) as payload:
        points = decode_vectors(*without_edges(k + len(first.isolated)), payload)
    still = Integers(NO_POINTS, first.anchors, points[:k], points[k:], exponents=first.exponents)
    return _decode_vectors(surface, parameters, sections, still)


def _decode_vectors(
    surface: Surface, parameters: Parameters, sections: Mapping[str, Section], still: Integers
) -> Integers:
    """Return the integers with deltas, vectors of cells, and corrections."""
    values = np.zeros((surface.vertex_count, 3), dtype=np.int64)
    if layout.DELTAS in sections:  # which a prefix may lack
        with payload_of(sections[layout.DELTAS]) as payload:
            if parameters.step:
                values = decode_vectors(*surface.graph, payload)
            elif len(payload):
                raise FormatError("deltas in a file of 0 bits", 0)
    integers = replace(still, values=values)
    if layout.CELLS in sections:
        units, cells = _decode_cells(surface, parameters, still.anchors, sections[layout.CELLS])
        integers = replace(integers, units=units, cells=cells)
    if layout.CORRECTIONS not in sections:
        return integers
    with payload_of(sections[layout.CORRECTIONS]) as payload:
        if not parameters.step:
            raise FormatError("corrections in a file of 0 bits", 0)
        return replace(integers, corrections=decode_vectors(*surface.graph, payload))


def _decode_cells(
    surface: Surface, parameters: Parameters, anchors: Ints, section: Section
) -> tuple[Ints, Ints]:
    shared = Cells(surface.graph, surface.labels, anchors).shared
    stages = len(UNITS[str(parameters.method)])
    with payload_of(section) as payload:
        if not (parameters.interpolated and len(shared)):
            raise FormatError("vectors of cells that have none", 0)
        units = np.array(take(payload, 0, stages), dtype=np.int64) + layout.LEAST_UNIT
        if units.max() > layout.MOST_UNIT:
            raise FormatError(f"a unit of 2^{units.max()} steps", int(np.argmax(units)))
        values = decode_vectors(
            *without_edges(stages * len(shared)), payload[stages:], offset=stages
        )
        if not values.any():
            raise FormatError("no cell has lost anything", stages)
    return units, values.reshape(stages, len(shared), 3)


def _encode_anchors(surface: Surface, parameters: Parameters, integers: Integers) -> bytes:
    extra = steps.extra_bits(integers.exponents, surface.vertex_count)[integers.anchors]
    bits = steps.grid_bits(integers.positions, extra, integers.isolated)

    def run(coder: Coder) -> None:
        if parameters.anchor_method == layout.GREEDY:
            points.code_gaps(coder, integers.anchors.copy(), surface.vertex_count)
        points.code_points(coder, integers.positions.copy(), np.array(bits), extra)
        if len(integers.isolated):  # most meshes have none, and need not wait for this kernel
            points.code_sorted_points(coder, integers.isolated.copy(), np.array(bits))

    count = len(integers.positions) + len(integers.isolated)
    return bytes(bits) + encode_with(points.MODEL, count, run)


def _decode_anchors(
    surface: Surface, parameters: Parameters, payload: memoryview, extra: Ints
) -> tuple[Ints, Ints, Ints]:
    bits = steps.read_grid_bits(payload)
    k, n = parameters.anchor_count, surface.vertex_count

    def run(coder: Coder) -> tuple[Ints, Ints, Ints]:
        anchors = np.zeros(k, dtype=np.int64)
        positions = np.zeros((k, 3), dtype=np.int64)
        isolated = np.zeros((surface.isolated_count, 3), dtype=np.int64)
        if parameters.anchor_method == layout.GREEDY:
            if not points.code_gaps(coder, anchors, n):
                raise FormatError("an anchor beyond the last vertex", 3)
        else:
            anchors = _computed(surface, str(parameters.anchor_method), k, parameters.seed)
        labels = surface.labels
        if len(distinct(labels[anchors])) <= labels.max(initial=-1) or len(anchors) != k:
            raise FormatError("a component without an anchor", 3)
        points.code_points(coder, positions, bits, extra[anchors])
        if len(isolated) and not points.code_sorted_points(coder, isolated, bits):
            raise FormatError("an isolated vertex outside the grid", 3)
        return anchors, positions, isolated

    return decode_with(points.MODEL, payload[3:], run, 3)
