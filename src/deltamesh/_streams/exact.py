"""Floats to the last bit, three columns at once: what EXAC and the attributes code alike.

How each column is spelled, the forms of `forms`, is told first; then follows a stream.
"""

from __future__ import annotations

import struct
from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding import exact
from deltamesh._kernels.coding.coder import Coder
from deltamesh._streams import entropy
from deltamesh._streams.number_formats import Form, Spelling, spelling_fault
from deltamesh_formats.errors import FormatError

SINGLE, DOUBLE = 32, 64
_WIDTH: Final = struct.Struct("<B")
# Of an axis: its number of forms and two flags; the grid; then of each form the base, the places,
# the digits and the usual length.
_AXIS: Final = struct.Struct("<Bh")
_FORM: Final = struct.Struct("<BhBB")
_FORMS, _RAW, _ZEROS = 3, 4, 8
# One of our elements, of three numbers of up to 64 + 64 bits, is less than two of others.
_ELEMENTS: Final = 2


def encode_spelled(
    elements: Elements,
    width: int,
    axes: list[Spelling],
    classes: NDArray[np.int64],
    values: NDArray[np.int64],
) -> bytes:
    """Return the stream of numbers in their forms.

    Parameters
    ----------
    elements : Elements
    width : int
        Bits of a raw number.
    axes : list of 3 Spelling
    classes, values : int64 (n, 3)
        As of `forms.to_integers`.
    """
    coder = entropy.encoder(_ELEMENTS * elements.count, *_model(axes))
    _code(coder, elements, axes, width, classes.copy(), values.copy())
    return entropy.finish(coder)


def decode_spelled(
    payload: memoryview, at: int, elements: Elements, width: int, axes: list[Spelling]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return classes and values, of the stream from `at` on: the mirror of `encode_spelled`.

    Raises
    ------
    FormatError
    """
    shape = (elements.count, 3)
    classes, values = np.zeros(shape, dtype=np.int64), np.zeros(shape, dtype=np.int64)
    coder = entropy.decoder(payload[at:], *_model(axes))
    _code(coder, elements, axes, width, classes, values)
    entropy.check_end(coder, at)
    return classes, values


def parallelogram_errors(V: NDArray[np.float64], elements: Elements) -> NDArray[np.float64]:
    """Return how far each parallelogram is off, float64 (p, 3)."""
    apex = np.repeat(np.arange(len(V)), np.diff(elements.first))
    a, b, o = elements.corners.T
    return np.asarray(np.abs(V[a] + V[b] - V[o] - V[apex]))


def _model(axes: list[Spelling]) -> tuple[int, entropy.Mixers]:
    """Return the number of slots, and the mixers."""
    forms = sum(len(how.forms) for how in axes)
    slots = exact.FORMS_AT + forms * exact.FORM_SLOTS
    return slots, 3 * exact.AXIS_MIXERS + forms * exact.FORM_MIXERS


def _code(
    coder: Coder,
    elements: Elements,
    axes: list[Spelling],
    width: int,
    classes: NDArray[np.int64],
    values: NDArray[np.int64],
) -> None:
    e = elements
    table: list[tuple[int, ...]] = []
    forms: list[tuple[int, ...]] = []
    for how in axes:
        table.append((len(forms), len(how.forms), int(how.raw), int(how.zeros)))
        for form, usual in zip(how.forms, how.usual, strict=True):
            forms.append((form.base, how.grid - form.places, form.digits, usual))
    tables = np.array(table), np.array(forms, dtype=np.int64).reshape(-1, exact.FORM_SIZE)
    around = e.indptr, e.indices, e.first, e.corners
    exact.code_exact(coder, *around, *tables, np.int64(width), classes, values)


def packed(width: int, axes: list[Spelling]) -> bytes:
    """Return what is told of the forms; the mirror is `unpacked`."""
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
