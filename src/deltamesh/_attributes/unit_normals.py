"""The section of unit normals: which predictions they are coded with, and their payload.

They are relative to the normals of the decoded surface, which they often are; or, where positions
are too coarse for that, or normals were made up, by themselves, as numbers like those around.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes.element_normals import WEIGHTS, Surroundings, surface_normals
from deltamesh._attributes.octahedral import (
    ABSOLUTE,
    LEAST_BITS,
    MOST_BITS,
    RELATIVE,
    ZERO,
    half,
    quantized,
    restored,
)
from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding import delta, parallelogram, residual
from deltamesh._kernels.coding.coder import Coder
from deltamesh._streams import entropy
from deltamesh_formats.errors import FormatError

_Ints = NDArray[np.int64]
_Floats = NDArray[np.float64]

# Instead of weights, where surface and normals have little in common. Codes of neighbours are alike
# then, or equal.
NONE: Final = len(WEIGHTS)

# What the stream is: vectors whose magnitudes are like those around; numbers like those around.
DELTAS, NUMBERS = 0, 1
_MIXERS: Final = (residual.MIXERS, parallelogram.MIXERS)


@dataclass(frozen=True)
class Normals:
    """Normals as they are entropy-coded.

    Attributes
    ----------
    codes : int64 (k, 3)
        State, and two coordinates in -half(bits) .. half(bits).
    bits : int
        Of a coordinate.
    weights : int
        Of `element_normals.WEIGHTS`: what predicts them; or NONE, and all are coded by themselves.
    """

    codes: _Ints
    bits: int
    weights: int


def smallest(
    values: _Floats,
    V: _Floats,
    around: Surroundings,
    elements: Elements,
    bits: int,
    tolerance: float,
) -> tuple[Normals, bytes]:
    """Return normals with the weights that make their payload the smallest, and that payload.

    Parameters
    ----------
    values : float64 (k, 3)
        For which `is_unit` holds.
    V : float64 (n, 3)
        The positions that a decoder makes.
    around : element_normals.Surroundings
    elements : Elements
    bits : int
        Of a coordinate, LEAST_BITS to MOST_BITS.
    tolerance : float
        How far apart the positions of two decoders may be, in the unit of V.
    """
    made = [_normals_of(values, V, around, w, bits, tolerance) for w in (*WEIGHTS, NONE)]
    guess = min(made[:-1], key=lambda n: float(np.log2(1 + 2 * np.abs(n.codes[:, 1:])).sum()))
    payloads = [(n, encode_normals(n, elements)) for n in (guess, made[-1])]
    return min(payloads, key=lambda pair: len(pair[1]))


def _normals_of(
    values: _Floats, V: _Floats, around: Surroundings, weights: int, bits: int, tolerance: float
) -> Normals:
    if weights == NONE:
        predicted, doubt = np.zeros_like(values), np.full(len(values), np.inf)
    else:
        predicted, doubt = surface_normals(V, around, weights, tolerance)
    return Normals(quantized(values, predicted, doubt, bits), bits, weights)


def values_of(normals: Normals, V: _Floats, around: Surroundings) -> _Floats:
    """Return the vectors, float64 (k, 3), of length 1 or 0: what `smallest` was given, nearly."""
    if normals.weights == NONE:
        predicted = np.zeros((len(normals.codes), 3))
    else:
        predicted, _ = surface_normals(V, around, normals.weights, 0.0)
    return restored(normals.codes, predicted, normals.bits)


def encode_normals(normals: Normals, elements: Elements) -> bytes:
    """Return the payload of normals (SPEC.md 5.17), the smaller one of two.

    Parameters
    ----------
    normals : Normals
    elements : Elements
    """
    payloads = []
    for coding in (DELTAS, NUMBERS):
        coder = entropy.encoder(len(normals.codes), residual.SLOTS, _MIXERS[coding])
        _code(coder, coding, elements, normals.codes.copy())
        head = bytes((normals.bits, 4 * coding + normals.weights))
        payloads.append(head + entropy.finish(coder))
    return min(payloads, key=len)


def decode_normals(payload: bytes | memoryview, elements: Elements) -> Normals:
    """Return the normals: the mirror of `encode_normals`.

    Raises
    ------
    FormatError
        With an offset into the payload.
    """
    if len(payload) < 2:
        raise FormatError("normals that end before their stream", len(payload))
    bits, plan = payload[0], payload[1]
    if not LEAST_BITS <= bits <= MOST_BITS:
        raise FormatError(f"normals of {bits} bits", 0)
    if plan > 4 * NUMBERS + NONE:
        raise FormatError(f"unknown plan of normals: {plan}", 1)
    coding, weights = divmod(plan, 4)
    codes = np.zeros((elements.count, 3), dtype=np.int64)
    coder = entropy.decoder(payload[2:], residual.SLOTS, _MIXERS[coding])
    _code(coder, coding, elements, codes)
    entropy.check_end(coder, 2)
    state, grid = codes[:, 0], np.abs(codes[:, 1:])
    lowest = ABSOLUTE if weights == NONE else RELATIVE
    wrong = (state < lowest) | (state > ZERO) | (grid > half(bits)).any(axis=1)
    wrong |= (state == ZERO) & grid.any(axis=1)
    if wrong.any():
        raise FormatError(f"normal {int(np.argmax(wrong))} is no point of its grid", 2)
    return Normals(codes, bits, weights)


def _code(coder: Coder, coding: int, elements: Elements, codes: _Ints) -> None:
    e = elements
    if coding == DELTAS:
        delta.code_deltas(coder, e.indptr, e.indices, codes)
    else:
        parallelogram.code_positions(
            coder, e.indptr, e.indices, e.first, e.corners, e.within, codes
        )
