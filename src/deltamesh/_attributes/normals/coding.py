"""Unit normals of an attribute: the choice of their prediction, and their payload; SPEC.md 5.17.

They are coded relative to the normals of the decoded surface, which they often equal. Where
positions are too coarse for that, or normals have little in common with the surface, they are coded
by themselves, as numbers like those around.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes.domains import Domains
from deltamesh._attributes.normals.octahedral import (
    ABSOLUTE,
    RELATIVE,
    ZERO,
    half,
    quantize_normals,
    restore_normals,
)
from deltamesh._attributes.normals.surface import WEIGHTS, Surroundings, surface_normals
from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding import delta, parallelogram, residual
from deltamesh._kernels.coding.coder import Coder
from deltamesh._streams.columns import code_three
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh._vectors import angles
from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.container.attribute_entry import Entry
from deltamesh_formats.container.payload_layout import (
    MAX_NORMAL_BITS,
    MIN_NORMAL_BITS,
    NORMAL_CODING_AT,
    NORMAL_CODINGS,
    NORMAL_WEIGHTS,
)
from deltamesh_formats.errors import FormatError, located

_Any = NDArray[Any]

# No weights: normals are coded by themselves. Codes of neighbours are then alike, or equal.
NONE: Final = NORMAL_WEIGHTS["none"]

# Codings of the stream: vectors whose magnitudes are like those around; numbers like those around.
DELTAS: Final = NORMAL_CODINGS["deltas"]
NUMBERS: Final = NORMAL_CODINGS["numbers"]
_MODELS: Final = {DELTAS: residual.MODEL, NUMBERS: parallelogram.MODEL}


@dataclass(frozen=True)
class Normals:
    """Normals as they are entropy-coded.

    Attributes
    ----------
    codes : int64 (k, 3)
        State, and two coordinates in -half(bits) .. half(bits).
    bits : int
        Bits of a coordinate.
    weights : int
        One of `surface.WEIGHTS`, the prediction; or NONE, and all are coded by themselves.
    """

    codes: Ints
    bits: int
    weights: int


def surroundings_of(entry: Entry, owner: Ints, count: int, domains: Domains) -> Surroundings:
    """Return the polygons around the owners of an attribute.

    Parameters
    ----------
    entry : Entry
    owner : int64
        The owner of each element of the domain.
    count : int
        Number of owners.
    domains : Domains
    """
    vertices, polygons = domains.vertex_of_corners, domains.polygon_of_corners
    at_corners = {"vertex": vertices, "corner": owner, "face": polygons}
    return Surroundings(vertices, domains.polygons.offsets, at_corners[entry.domain], count)


def encode_attribute_normals(
    entry: Entry,
    values: _Any,
    has: Bools,
    elements: Elements,
    around: Surroundings,
    V: Floats,
    tolerance: float,
) -> tuple[Entry, Normals, bytes]:
    """Return the entry with its largest error, the normals as they are coded, and their stream.

    Parameters
    ----------
    entry : Entry
    values : (values, 3)
        Normals of the owners that have one.
    has : bool (owners,)
    elements : Elements
        The owners.
    around : Surroundings
    V : float64 (n, 3)
        Decoded positions.
    tolerance : float
        The largest distance between the positions that two decoders make.
    """
    dense = np.zeros((elements.count, 3))
    dense[has] = values
    normals, stream = choose_normals(dense, V, around, elements, entry.bits, tolerance)
    found = vectors_of(normals, V, around).astype(entry.dtype)[has]
    error = angles(values.astype(np.float64), found.astype(np.float64)).max(initial=0.0)
    return replace(entry, error=float(error)), normals, stream


def decode_attribute_normals(
    payload: memoryview, stream: tuple[int, int], entry: Entry, elements: Elements
) -> Normals:
    """Return the normals as they are coded: the mirror of `encode_attribute_normals`.

    Raises
    ------
    FormatError
    """
    begin, end = stream
    with located(begin):
        normals = decode_normals(payload[begin:end], elements)
    if normals.bits != entry.bits:
        reason = f"normals of {normals.bits} bits, where the table has {entry.bits}"
        raise FormatError(reason, begin)
    return normals


def choose_normals(
    values: Floats,
    V: Floats,
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
    around : Surroundings
    elements : Elements
    bits : int
        Bits of a coordinate, MIN_NORMAL_BITS to MAX_NORMAL_BITS.
    tolerance : float
        The largest distance between the positions that two decoders make, in the unit of V.
    """
    made = [_normals_of(values, V, around, w, bits, tolerance) for w in (*WEIGHTS, NONE)]
    guess = min(made[:-1], key=lambda n: float(np.log2(1 + 2 * np.abs(n.codes[:, 1:])).sum()))
    payloads = [(n, encode_normals(n, elements)) for n in (guess, made[-1])]
    return min(payloads, key=lambda pair: len(pair[1]))


def _normals_of(
    values: Floats, V: Floats, around: Surroundings, weights: int, bits: int, tolerance: float
) -> Normals:
    if weights == NONE:
        predicted, doubt = np.zeros_like(values), np.full(len(values), np.inf)
    else:
        predicted, doubt = surface_normals(V, around, weights, tolerance)
    return Normals(quantize_normals(values, predicted, doubt, bits), bits, weights)


def vectors_of(normals: Normals, V: Floats, around: Surroundings) -> Floats:
    """Return the vectors of normals, float64 (k, 3), of length 1 or 0."""
    if normals.weights == NONE:
        predicted = np.zeros((len(normals.codes), 3))
    else:
        predicted, _ = surface_normals(V, around, normals.weights, 0.0)
    return restore_normals(normals.codes, predicted, normals.bits)


def encode_normals(normals: Normals, elements: Elements) -> bytes:
    """Return the payload of normals (SPEC.md 5.17), the smaller one of two.

    Parameters
    ----------
    normals : Normals
    elements : Elements
    """
    payloads = []
    for coding in (DELTAS, NUMBERS):
        codes = normals.codes.copy()
        run = partial(_code, coding=coding, elements=elements, codes=codes)
        stream = encode_with(_MODELS[coding], len(codes), run)
        plan = coding << NORMAL_CODING_AT | normals.weights
        payloads.append(bytes((normals.bits, plan)) + stream)
    return min(payloads, key=len)


def decode_normals(payload: bytes | memoryview, elements: Elements) -> Normals:
    """Return the normals: the mirror of `encode_normals`.

    Raises
    ------
    FormatError
        With an offset into the payload.
    """
    if len(payload) < 2:
        raise FormatError("truncated: the header of the normals", len(payload))
    bits, plan = payload[0], payload[1]
    if not MIN_NORMAL_BITS <= bits <= MAX_NORMAL_BITS:
        limits = f"{MIN_NORMAL_BITS}..{MAX_NORMAL_BITS}"
        raise FormatError(f"normals of {bits} bits, outside {limits}", 0)
    if plan >> NORMAL_CODING_AT not in _MODELS:
        raise FormatError(f"unknown prediction or coding of normals: {plan}", 1)
    coding, weights = divmod(plan, 1 << NORMAL_CODING_AT)
    codes = np.zeros((elements.count, 3), dtype=np.int64)
    run = partial(_code, coding=coding, elements=elements, codes=codes)
    decode_with(_MODELS[coding], payload[2:], run, offset=2)
    state, grid = codes[:, 0], np.abs(codes[:, 1:])
    lowest = ABSOLUTE if weights == NONE else RELATIVE
    wrong = (state < lowest) | (state > ZERO) | (grid > half(bits)).any(axis=1)
    wrong |= (state == ZERO) & grid.any(axis=1)
    if wrong.any():
        raise FormatError(f"normal {int(np.argmax(wrong))} is outside its grid", 2)
    return Normals(codes, bits, weights)


def _code(coder: Coder, coding: int, elements: Elements, codes: Ints) -> None:
    if coding == DELTAS:
        delta.code_deltas(coder, elements.indptr, elements.indices, codes)
    else:
        code_three(coder, elements, codes)
