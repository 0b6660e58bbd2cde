"""Cartesian method: positions on a grid, predicted by parallelograms.

For CAD parts and very coarse meshes, and the baseline of every comparison. Where steps differ, they
do so from component to component: the first vertex of each, its *root*, is stored beside the stream
of all vertices, which has the others as seen from there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from deltamesh._geometry import steps
from deltamesh._geometry.integers import NONE, Integers, Quantized
from deltamesh._geometry.prediction import Prediction, halvings
from deltamesh._geometry.quantize import check_size, from_grid, grid_step, to_grid
from deltamesh._geometry.systems import Systems
from deltamesh._graph.adjacency import lowest
from deltamesh._kernels.coding import points
from deltamesh._kernels.coding.coder import Coder
from deltamesh._methods import CARTESIAN
from deltamesh._options import Settings
from deltamesh._shape.surface import Surface
from deltamesh._streams.columns import decode_three, encode_three
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container import layout
from deltamesh_formats.container.container import Parameters, Section
from deltamesh_formats.container.fields import read_varint, take, write_varint
from deltamesh_formats.container.sections import payload_of
from deltamesh_formats.errors import FormatError


def quantize(
    surface: Surface,
    vertices: Floats,
    isolated: Floats,
    settings: Settings,
    systems: Systems,
    predicted: Prediction | None = None,
) -> Quantized:
    """Choose the grid, and round to its points.

    Each component has the finest of the steps of its vertices, and the step of the parameters is
    that of the coarsest component, or of more than one. A predicted frame has the grid of the first
    one, halved until its step is not above that of the settings.
    """
    everything = np.concatenate([vertices, isolated])
    if predicted is not None:
        return _on_grid(surface, everything, settings, systems, predicted)
    origin = everything.min(axis=0)
    step = settings.step or grid_step(everything, settings.bits or 1)
    step, exponents = steps.chosen(settings, surface, step)
    exponents, coarsest = _of_components(surface, exponents)
    step *= float(steps.RATIOS[coarsest])
    integers = Integers(np.zeros((len(everything), 3), dtype=np.int64), exponents=exponents)
    extra = steps.extra_bits(exponents, len(everything))[:, None]
    grid = to_grid(everything, origin, step * steps.ratios(integers), extra)
    parameters = Parameters(
        method=CARTESIAN.name,
        bits=settings.bits,
        step=step,
        origin=(float(origin[0]), float(origin[1]), float(origin[2])),
        isolated=surface.isolated_count,
    )
    integers = Integers(grid, exponents=exponents)
    check_size(from_roots(surface, integers), step * steps.ratios(integers))
    return parameters, integers, reconstruct(surface, parameters, integers, systems)


def _on_grid(
    surface: Surface,
    everything: Floats,
    settings: Settings,
    systems: Systems,
    predicted: Prediction,
) -> Quantized:
    """Round the vertices of a predicted frame to points of its grid."""
    first, exponents = predicted.first, predicted.reference.integers.exponents
    step = math.ldexp(first.step, -halvings(first.step, settings.step or first.step))
    parameters = replace(first, step=step)
    extra = steps.extra_bits(exponents, len(everything))[:, None]
    each = step * steps.ratios(predicted.reference.integers)
    integers = Integers(
        to_grid(everything, np.array(first.origin), each, extra), exponents=exponents
    )
    return parameters, integers, reconstruct(surface, parameters, integers, systems)


def _of_components(surface: Surface, exponents: Ints) -> tuple[Ints, int]:
    """Return the largest exponent of each vertex's component, less the least of these, and that."""
    if not len(exponents):
        return NONE, 0
    largest = np.zeros(len(exponents), dtype=np.int64)
    np.maximum.at(largest, surface.labels, exponents)
    exponents = largest[surface.labels]
    coarsest = int(exponents.min())
    exponents = exponents - coarsest
    return exponents if exponents.any() else NONE, coarsest


def reconstruct(
    surface: Surface,
    parameters: Parameters,
    integers: Integers,
    systems: Systems,
    predicted: Prediction | None = None,
) -> Floats:
    """Return the grid points; there is nothing to solve."""
    each = parameters.step * steps.ratios(integers)
    return from_grid(integers.values, np.array(parameters.origin), each)


def encode(surface: Surface, parameters: Parameters, integers: Integers) -> dict[str, bytes]:
    """Return the payload of CART, and of STEP where steps differ."""
    roots = _encode_roots(surface, integers) if len(integers.exponents) else b""
    stream = encode_three(surface.elements, from_roots(surface, integers))
    return {**steps.encode(surface, integers.exponents), layout.CARTESIAN: roots + stream}


def decode(surface: Surface, parameters: Parameters, sections: Mapping[str, Section]) -> Integers:
    """Return exponents and grid points."""
    exponents = _decode_exponents(surface, parameters, sections)
    with payload_of(sections[layout.CARTESIAN]) as payload:
        if not len(exponents):
            return Integers(decode_three(payload, surface.elements))
        roots, at = _decode_roots(surface, exponents, payload)
        values = decode_three(payload[at:], surface.elements, at)
        if values[lowest(surface.labels)].any():
            raise FormatError("the first vertex of a component is not where its root is", at)
        values[: surface.vertex_count] += roots[surface.labels]
        return Integers(values, exponents=exponents)


def encode_frame(surface: Surface, parameters: Parameters, integers: Integers) -> dict[str, bytes]:
    """Return the payload of a further frame, whose grid points are relative to another's."""
    return {layout.CARTESIAN: encode_three(surface.elements, integers.values)}


def decode_frame(
    surface: Surface, parameters: Parameters, sections: Mapping[str, Section], first: Integers
) -> Integers:
    """Return the grid points of a further frame, with the exponents of the first one."""
    with payload_of(sections[layout.CARTESIAN]) as payload:
        values = decode_three(payload, surface.elements)
    return Integers(values, exponents=first.exponents)


def _decode_exponents(
    surface: Surface, parameters: Parameters, sections: Mapping[str, Section]
) -> Ints:
    """Return the exponents, which are alike within each component."""
    exponents = steps.decode(surface, parameters, sections)
    if len(exponents) and (exponents != exponents[lowest(surface.labels)][surface.labels]).any():
        with payload_of(sections[layout.STEPS]):
            raise FormatError("steps that differ within a component of a Cartesian file", 0)
    return exponents


def from_roots(surface: Surface, integers: Integers) -> Ints:
    """Return the values, where steps differ as seen from the roots of their components."""
    values = integers.values.copy()
    if len(integers.exponents):
        values[: surface.vertex_count] -= values[lowest(surface.labels)][surface.labels]
    return values


def _encode_roots(surface: Surface, integers: Integers) -> bytes:
    first = lowest(surface.labels)
    roots, extra = integers.values[first], _extra(surface, integers.exponents)
    bits = steps.grid_bits(roots, extra)

    def run(coder: Coder) -> None:
        points.code_points(coder, roots.copy(), np.array(bits), extra)

    stream = encode_with(points.MODEL, len(roots), run)
    return bytes(bits) + write_varint(len(stream)) + stream


def _decode_roots(surface: Surface, exponents: Ints, payload: memoryview) -> tuple[Ints, int]:
    """Return the roots, int64 (c, 3), and where the stream of all vertices begins."""
    bits = steps.read_grid_bits(payload)
    size, at = read_varint(payload, 3)
    extra = _extra(surface, exponents)

    def run(coder: Coder) -> Ints:
        roots = np.zeros((len(extra), 3), dtype=np.int64)
        points.code_points(coder, roots, bits, extra)
        return roots

    take(payload, at, size)
    return decode_with(points.MODEL, payload[at : at + size], run, at), at + size


def _extra(surface: Surface, exponents: Ints) -> Ints:
    """Return the extra bits of the root of each component."""
    return steps.extra_bits(exponents, surface.vertex_count)[lowest(surface.labels)]
