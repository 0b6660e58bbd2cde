"""Cartesian method: positions on a grid, predicted by parallelograms.

For CAD parts and very coarse meshes, and the baseline of every comparison.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from deltamesh._geometry.integers import Integers, Quantized
from deltamesh._geometry.quantize import from_grid, grid_step, to_grid
from deltamesh._geometry.solve import Factor
from deltamesh._methods import CARTESIAN
from deltamesh._options import DEFAULT_CARTESIAN_BITS, Settings
from deltamesh._shape.surface import Surface
from deltamesh._streams.columns import decode_three, encode_three
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container import layout
from deltamesh_formats.container.container import Parameters, Section
from deltamesh_formats.container.reader import payload_of


def quantize(
    surface: Surface,
    vertices: Floats,
    isolated: Floats,
    settings: Settings,
    factor: Factor,
) -> Quantized:
    """Choose the grid, and round to its points."""
    everything = np.concatenate([vertices, isolated])
    origin = everything.min(axis=0)
    bits = settings.bits if settings.bits or settings.step else DEFAULT_CARTESIAN_BITS
    step = settings.step or grid_step(everything, bits or 1)
    grid, last = to_grid(vertices, origin, step), to_grid(isolated, origin, step)
    parameters = Parameters(
        method=CARTESIAN.name,
        bits=bits,
        step=step,
        origin=(float(origin[0]), float(origin[1]), float(origin[2])),
        isolated=surface.isolated_count,
    )
    integers = Integers(np.concatenate([grid, last]))
    return parameters, integers, reconstruct(surface, parameters, integers, factor)


def reconstruct(
    surface: Surface, parameters: Parameters, integers: Integers, factor: Factor
) -> Floats:
    """Return the grid points; there is nothing to solve."""
    return from_grid(integers.values, np.array(parameters.origin), parameters.step)


def encode(surface: Surface, parameters: Parameters, integers: Integers) -> dict[str, bytes]:
    """Return the payload of CART."""
    return {layout.CARTESIAN: encode_three(surface.elements, integers.values)}


def decode(surface: Surface, parameters: Parameters, sections: Mapping[str, Section]) -> Integers:
    """Return the grid points."""
    with payload_of(sections[layout.CARTESIAN]) as payload:
        return Integers(decode_three(payload, surface.elements))
