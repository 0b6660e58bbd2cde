"""Lossless method: positions to the last bit.

The integers of this method are the bit patterns of the positions. The encoder chooses
the formats of the numbers (`deltamesh._streams.number_formats`), and what they were converted by,
and stores both at the beginning of EXAC.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from deltamesh._geometry.integers import Integers, Quantized
from deltamesh._geometry.systems import Systems
from deltamesh._mesh import LARGEST
from deltamesh._methods import LOSSLESS
from deltamesh._options import Settings
from deltamesh._shape.surface import Surface
from deltamesh._streams.column_choice import choose_columns, numbers_of
from deltamesh._streams.exact import (
    DOUBLE,
    SINGLE,
    decode_numbers,
    encode_numbers,
    pack_formats,
    unpack_formats,
)
from deltamesh._streams.number_formats import from_indices, raw_bits
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.container import Parameters, Section
from deltamesh_formats.container.layout import EXACT
from deltamesh_formats.container.sections import payload_of
from deltamesh_formats.errors import FormatError


def quantize(
    surface: Surface,
    vertices: Floats,
    isolated: Floats,
    settings: Settings,
    systems: Systems,
) -> Quantized:
    """Return the bit patterns of the positions, and choose their number formats."""
    parameters = Parameters(method=LOSSLESS.name, isolated=surface.isolated_count)
    V = np.concatenate([vertices, isolated])
    with np.errstate(over="ignore"):
        single = bool((V.astype(np.float32) == V).all())
    raw, usable = raw_bits(V, single), np.ones(V.shape, dtype=bool)
    axes = choose_columns(surface.elements, V, usable, raw, single)
    integers = exactly(V.view(np.int64), pack_formats(SINGLE if single else DOUBLE, axes))
    return parameters, integers, V


def exactly(bits: Ints, formats: bytes) -> Integers:
    """Return the integers of bit patterns (n, 3) in these number formats."""
    return Integers(bits, formats=np.frombuffer(formats, dtype=np.uint8).astype(np.int64))


def reconstruct(
    surface: Surface, parameters: Parameters, integers: Integers, systems: Systems
) -> Floats:
    """Return the positions that the bit patterns are."""
    return integers.values.view(np.float64)


def encode(surface: Surface, parameters: Parameters, integers: Integers) -> dict[str, bytes]:
    """Return the payload of EXAC."""
    formats = integers.formats.astype(np.uint8).tobytes()
    width, axes, _ = unpack_formats(memoryview(formats))
    single, V = width == SINGLE, integers.values.view(np.float64)
    usable = np.ones(V.shape, dtype=bool)
    numbers = numbers_of(V, usable, raw_bits(V, single), axes, single)
    return {EXACT: formats + encode_numbers(surface.elements, width, axes, *numbers)}


def decode(surface: Surface, parameters: Parameters, sections: Mapping[str, Section]) -> Integers:
    """Return the bit patterns."""
    elements = surface.elements
    V = np.empty((elements.count, 3))
    with payload_of(sections[EXACT]) as payload:
        width, axes, at = unpack_formats(payload)
        choices, indices, deviations = decode_numbers(payload, at, elements, width, axes)
        for a, column in enumerate(axes):
            known = choices[:, a], indices[:, a], deviations[:, a]
            V[:, a] = from_indices(*known, column, width == SINGLE)
        if not (np.abs(V) <= LARGEST).all():
            raise FormatError("a position that no mesh has", at)
        return exactly(V.view(np.int64), bytes(payload[:at]))
