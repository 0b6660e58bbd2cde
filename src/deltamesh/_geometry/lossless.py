"""The lossless method: positions to the last bit.

The integers of this method are the bit patterns of the positions. The encoder chooses
the formats of the numbers (`deltamesh._streams.number_formats`) and stores them at the beginning of
EXAC. The encoder's functions and the decoder's are mirrors: quantize / reconstruct, write / read.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from deltamesh._geometry.integers import NO_POINTS, NONE, Integers, Quantized
from deltamesh._geometry.solve import Factor
from deltamesh._mesh import LARGEST
from deltamesh._options import Settings
from deltamesh._shape.surface import Surface
from deltamesh._streams.exact import (
    DOUBLE,
    SINGLE,
    decode_spelled,
    encode_spelled,
    packed,
    parallelogram_errors,
    unpacked,
)
from deltamesh._streams.number_formats import spelling, to_integers, to_values
from deltamesh_formats.container.layout import Parameters, Section
from deltamesh_formats.container.reader import payload_of
from deltamesh_formats.errors import FormatError


def quantize(
    surface: Surface,
    vertices: NDArray[np.float64],
    isolated: NDArray[np.float64],
    settings: Settings,
    factor: Factor,
) -> Quantized:
    """Return the bit patterns of the positions, and choose how to spell them.

    Nothing is lost. The mirror is `reconstruct`.

    Parameters
    ----------
    surface : Surface
    vertices, isolated : float64 (n, 3), (i, 3)
        Positions of the vertices of the faces in coding order, and of the others.
    settings : Settings
    factor : callable
        Not used: there is nothing to solve.
    """
    parameters = Parameters(
        method="lossless",
        diffusion=False,
        anchor_method=None,
        bits=None,
        step=0.0,
        origin=(0.0, 0.0, 0.0),
        anchor_step=0.0,
        seed=0,
        anchor_count=0,
        isolated=surface.isolated_count,
    )
    V = np.concatenate([vertices, isolated])
    with np.errstate(over="ignore"):
        single = bool((V.astype(np.float32) == V).all())
    errors = parallelogram_errors(V, surface.elements)
    axes = [spelling(V[:, a].copy(), errors[:, a], single) for a in range(3)]
    integers = exactly(V.view(np.int64), packed(SINGLE if single else DOUBLE, axes))
    return parameters, integers, V


def exactly(bits: NDArray[np.int64], forms: bytes) -> Integers:
    """Return the integers of bit patterns (n, 3) that are spelled so."""
    told = np.frombuffer(forms, dtype=np.uint8).astype(np.int64)
    return Integers(bits, NONE, NO_POINTS, NO_POINTS, forms=told)


def reconstruct(
    surface: Surface, parameters: Parameters, integers: Integers, factor: Factor
) -> NDArray[np.float64]:
    """Return the positions; isolated vertices come last."""
    return integers.values.view(np.float64)


def write(surface: Surface, parameters: Parameters, integers: Integers) -> dict[str, bytes]:
    """Return the payload of EXAC."""
    forms = integers.forms.astype(np.uint8).tobytes()
    width, axes, _ = unpacked(memoryview(forms))
    n, bits = len(integers.values), integers.values
    classes, values = np.empty((n, 3), dtype=np.int64), np.empty((n, 3), dtype=np.int64)
    for a, how in enumerate(axes):
        one = bits[:, a].copy().view(np.float64)
        classes[:, a], values[:, a] = to_integers(one, how, width == SINGLE)
    stream = encode_spelled(surface.elements, width, axes, classes, values)
    return {"EXAC": forms + stream}


def read(surface: Surface, parameters: Parameters, sections: Mapping[str, Section]) -> Integers:
    """Return the bit patterns: the mirror of `write`.

    Raises
    ------
    FormatError
    """
    elements = surface.elements
    V = np.empty((elements.count, 3))
    with payload_of(sections["EXAC"]) as payload:
        width, axes, at = unpacked(payload)
        classes, values = decode_spelled(payload, at, elements, width, axes)
        for a, how in enumerate(axes):
            V[:, a] = to_values(classes[:, a], values[:, a], how, width == SINGLE)
        if not (np.abs(V) <= LARGEST).all():
            raise FormatError("a position that no mesh has", at)
        return exactly(V.view(np.int64), bytes(payload[:at]))
