"""Sections of the methods with anchors: ANCH and DELT, and where they are needed CELL and FIXS."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from deltamesh._geometry import steps
from deltamesh._geometry.anchors import computed
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.integers import NO_POINTS, Integers
from deltamesh._geometry.positions import UNITS
from deltamesh._graph.adjacency import without_edges
from deltamesh._kernels.coding import points
from deltamesh._kernels.coding.coder import Coder
from deltamesh._shape.surface import Surface
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh._streams.vectors import decode_vectors, encode_vectors
from deltamesh_formats.array_types import Ints
from deltamesh_formats.container import layout
from deltamesh_formats.container.container import Parameters, Section
from deltamesh_formats.container.fields import take
from deltamesh_formats.container.payload_layout import LEAST_UNIT, MOST_UNIT
from deltamesh_formats.container.sections import payload_of
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.permutations import distinct


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
        payloads[layout.CELLS] = bytes((integers.units - LEAST_UNIT).tolist()) + stream
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
        units = np.array(take(payload, 0, stages), dtype=np.int64) + LEAST_UNIT
        if units.max() > MOST_UNIT:
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
            anchors = computed(surface, str(parameters.anchor_method), k, parameters.seed)
        labels = surface.labels
        if len(distinct(labels[anchors])) <= labels.max(initial=-1) or len(anchors) != k:
            raise FormatError("a component without an anchor", 3)
        points.code_points(coder, positions, bits, extra[anchors])
        if len(isolated) and not points.code_sorted_points(coder, isolated, bits):
            raise FormatError("an isolated vertex outside the grid", 3)
        return anchors, positions, isolated

    return decode_with(points.MODEL, payload[3:], run, 3)
