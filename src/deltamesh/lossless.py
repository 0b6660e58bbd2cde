"""The lossless method: positions to the last bit.

The integers of this method are the bit patterns of the positions. How they are spelled, the forms
of `deltamesh.forms`, is up to the encoder and told at the beginning of EXAC. The encoder's
functions and the decoder's are mirrors: quantize / reconstruct, write / read.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh import entropy
from deltamesh.forms import Form, Spelling, spelling, spelling_fault, to_integers, to_values
from deltamesh.geometry import NO_POINTS, NONE, Integers, Quantized, Surface, payload_of
from deltamesh.kernels import exact
from deltamesh.kernels.coder import Coder
from deltamesh.mesh import LARGEST
from deltamesh.options import Settings
from deltamesh.solve import Factor
from deltamesh_formats.errors import FormatError
from deltamesh_formats.layout import Parameters, Section

SINGLE, DOUBLE = 32, 64
_WIDTH: Final = struct.Struct("<B")
# Of an axis: its number of forms and two flags; the grid; then of each form the base, the places,
# the digits and the usual length.
_AXIS: Final = struct.Struct("<Bh")
_FORM: Final = struct.Struct("<BhBB")
_FORMS, _RAW, _ZEROS = 3, 4, 8
# One of our elements, of three numbers of up to 64 + 64 bits, is less than two of others.
_ELEMENTS: Final = 2


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
    errors = _errors(V, *surface.parallelograms[:2])
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
    coder = entropy.encoder(_ELEMENTS * n, *_model(axes))
    _code(coder, surface, axes, width, classes, values)
    return {"EXAC": forms + entropy.finish(coder)}


def read(surface: Surface, parameters: Parameters, sections: Mapping[str, Section]) -> Integers:
    """Return the bit patterns: the mirror of `write`.

    Raises
    ------
    FormatError
    """
    n = surface.vertex_count + surface.isolated_count
    V, shape = np.empty((n, 3)), (n, 3)
    with payload_of(sections["EXAC"]) as payload:
        width, axes, at = unpacked(payload)
        classes, values = np.zeros(shape, dtype=np.int64), np.zeros(shape, dtype=np.int64)
        coder = entropy.decoder(payload[at:], *_model(axes))
        _code(coder, surface, axes, width, classes, values)
        entropy.check_end(coder, at)
        for a, how in enumerate(axes):
            V[:, a] = to_values(classes[:, a], values[:, a], how, width == SINGLE)
        if not (np.abs(V) <= LARGEST).all():
            raise FormatError("a position that no mesh has", at)
        return exactly(V.view(np.int64), bytes(payload[:at]))


def _errors(
    V: NDArray[np.float64], first: NDArray[np.int64], corners: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return how far each parallelogram is off, float64 (p, 3)."""
    apex = np.repeat(np.arange(len(V)), np.diff(first))
    a, b, o = corners.T
    return np.asarray(np.abs(V[a] + V[b] - V[o] - V[apex]))


def _model(axes: list[Spelling]) -> tuple[int, entropy.Mixers]:
    """Return the number of slots, and the mixers."""
    forms = sum(len(how.forms) for how in axes)
    slots = exact.FORMS_AT + forms * exact.FORM_SLOTS
    return slots, 3 * exact.AXIS_MIXERS + forms * exact.FORM_MIXERS


def _code(
    coder: Coder,
    surface: Surface,
    axes: list[Spelling],
    width: int,
    classes: NDArray[np.int64],
    values: NDArray[np.int64],
) -> None:
    corners = surface.parallelograms[:2]
    indptr, indices = surface.graph
    indptr = np.pad(indptr, (0, surface.isolated_count), mode="edge")
    table: list[tuple[int, ...]] = []
    forms: list[tuple[int, ...]] = []
    for how in axes:
        table.append((len(forms), len(how.forms), int(how.raw), int(how.zeros)))
        for form, usual in zip(how.forms, how.usual, strict=True):
            forms.append((form.base, how.grid - form.places, form.digits, usual))
    tables = np.array(table), np.array(forms, dtype=np.int64).reshape(-1, exact.FORM_SIZE)
    exact.code_exact(coder, indptr, indices, *corners, *tables, np.int64(width), classes, values)


def packed(width: int, axes: list[Spelling]) -> bytes:
    """Return the beginning of EXAC; the mirror is `unpacked`."""
    parts = [_WIDTH.pack(width)]
    for how in axes:
        flags = len(how.forms) | _RAW * how.raw | _ZEROS * how.zeros
        parts.append(_AXIS.pack(flags, how.grid))
        for form, usual in zip(how.forms, how.usual, strict=True):
            parts.append(_FORM.pack(form.base, form.places, form.digits, usual))
    return b"".join(parts)


def unpacked(payload: memoryview) -> tuple[int, list[Spelling], int]:
    """Return the width, the spelling of each axis, and where the stream begins.

    Raises
    ------
    FormatError
    """
    (width,), at = _take(payload, 0, _WIDTH)
    if width not in (SINGLE, DOUBLE):
        raise FormatError(f"numbers of {width} bits", 0)
    axes = []
    for _ in range(3):
        start = at
        (flags, grid), at = _take(payload, at, _AXIS)
        forms, usual = [], []
        for _ in range(flags & _FORMS):
            (*form, length), at = _take(payload, at, _FORM)
            forms.append(Form(*form))
            usual.append(length)
        how = Spelling(tuple(forms), tuple(usual), grid, bool(flags & _RAW), bool(flags & _ZEROS))
        fault = "reserved bits are set" if flags > 15 else spelling_fault(how)
        if fault:
            raise FormatError(fault, start)
        axes.append(how)
    return width, axes, at


def _take(payload: memoryview, at: int, fields: struct.Struct) -> tuple[tuple[int, ...], int]:
    if len(payload) < at + fields.size:
        raise FormatError("truncated: the forms of the coordinates", len(payload))
    return fields.unpack_from(payload, at), at + fields.size
