"""Rows of an attribute as the integers that are coded, and back."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh._streams.floats import bits_of, from_bits
from deltamesh_formats.container.attribute_table import MAX_LIMB_BITS, Entry
from deltamesh_formats.errors import FormatError

_Ints = NDArray[np.int64]
_Any = NDArray[Any]

_WORD: Final = 1 << 64
BYTE: Final = 8
# Steps a unit of a colour in 0 .. 1 that was one of 256.
COLOUR_DENSITY: Final = 255.0


def to_codes(entry: Entry, values: _Any) -> _Ints:
    """Return the integers (r, c) that rows of values (r, width) become.

    Those of unit normals only tell which are equal; what these become depends on the surface.
    """
    if entry.coding == "exact":
        return bits_of(values)
    if entry.coding == "octahedral":
        return bits_of(values + values.dtype.type(0))  # -0.0 is 0.0
    if entry.coding == "grid":
        origin = np.array(entry.origin, dtype=np.float64)
        return np.rint((values.astype(np.float64) - origin) * entry.density).astype(np.int64)
    above = (_words(values) - np.uint64(int(entry.origin[0]) % _WORD)).T
    shifts = np.arange(entry.limbs, dtype=np.uint64) * np.uint64(entry.bits)
    limbs = (above[:, None] >> shifts[:, None]) & np.uint64((1 << entry.bits) - 1)
    return limbs.reshape(entry.columns, len(values)).T.astype(np.int64)


def to_values(entry: Entry, codes: _Ints) -> _Any:
    """Return the values, whatever the codes; `check_codes` has seen them."""
    if entry.coding == "exact":
        return from_bits(codes, entry.dtype)
    if entry.coding == "grid":
        origin = np.array(entry.origin, dtype=np.float64)
        return (origin + codes / entry.density).astype(entry.dtype)
    words = _joined(entry, codes)
    if entry.dtype.kind == "i":
        return words.view(np.int64).astype(entry.dtype)
    return words.astype(entry.dtype)


def check_codes(entry: Entry, codes: _Ints) -> None:
    """Refuse integers that no value becomes.

    Raises
    ------
    FormatError
    """
    if entry.coding == "exact":
        return
    most = MAX_LIMB_BITS if entry.coding == "grid" else entry.bits
    if ((codes < 0) | (codes >> most > 0)).any():
        raise FormatError("an integer of an attribute that is out of its range", 0)
    if entry.coding != "integer":
        return
    left = 64 - entry.bits * (entry.limbs - 1)
    highest = codes[:, entry.limbs - 1 :: entry.limbs]
    if entry.limbs > 1 and left < entry.bits and (highest >> left).any():
        raise FormatError("a number of an attribute of more than 64 bits", 0)
    values = to_values(entry, codes)
    if (_words(values) != _joined(entry, codes)).any():
        raise FormatError(f"a number of an attribute that is no {entry.dtype}", 0)


def mixed(columns: _Ints) -> _Ints:
    """Return columns of which the first and the third are differences to the second."""
    result = columns.copy()
    result[:, [0, 2]] -= columns[:, 1:2]
    return result


def unmixed(columns: _Ints) -> _Ints:
    """Return the columns: the mirror of `mixed`."""
    result = columns.copy()
    result[:, [0, 2]] += columns[:, 1:2]
    return result


def _words(values: _Any) -> NDArray[np.uint64]:
    """Return integers or booleans modulo 2^64, (r, k)."""
    if values.dtype.kind == "i":
        return values.astype(np.int64).view(np.uint64)
    return values.astype(np.uint64)


def _joined(entry: Entry, codes: _Ints) -> NDArray[np.uint64]:
    limbs = codes.reshape(len(codes), entry.numbers, entry.limbs).astype(np.uint64)
    shifts = np.arange(entry.limbs, dtype=np.uint64) * np.uint64(entry.bits)
    words = (limbs << shifts).sum(axis=2, dtype=np.uint64)
    return np.asarray(words + np.uint64(int(entry.origin[0]) % _WORD))


def integer_entries(entry: Entry, values: _Any) -> list[Entry]:
    """Return how integers may be cut: in as few limbs as can be, and in bytes where that helps."""
    low = int(values.min()) if values.size else 0
    span = (int(values.max()) if values.size else 0) - low
    wide = span.bit_length()
    bits = min(max(wide, 1), MAX_LIMB_BITS)
    found = [
        replace(entry, coding="integer", origin=(low,), bits=bits, limbs=-(-wide // bits) or 1)
    ]
    if wide > 2 * BYTE:
        info = np.iinfo(entry.dtype)
        start = int(info.min) if low < 0 else 0
        limbs = -(-(int(values.max()) - start).bit_length() // BYTE)
        found.append(replace(entry, coding="integer", origin=(start,), bits=BYTE, limbs=limbs))
    return found


def grid_entry(entry: Entry, values: _Any, bits: int) -> Entry | None:
    """Return the grid of the largest extent over 2^bits - 1 steps, None if it does not fit."""
    V = values.astype(np.float64)
    if not V.size or not np.isfinite(V).all():
        return None
    extent = float(np.ptp(V, axis=0).max())
    density = ((1 << bits) - 1) / extent if extent > 0 else 1.0
    if not (0 < density < np.inf and np.isfinite(extent)):
        return None
    origin = tuple(V.min(axis=0).tolist())
    found = replace(entry, coding="grid", origin=origin, density=density, bits=bits)
    return _measured(found, values, 0.51 / density)


def colour_entry(entry: Entry, values: _Any) -> Entry | None:
    """Return the grid of 256 levels from 0 to 1; None if not all values lie there."""
    if not values.size or not ((values >= 0) & (values <= 1)).all():
        return None
    origin = (0.0,) * entry.width
    found = replace(entry, coding="grid", origin=origin, density=COLOUR_DENSITY, bits=BYTE)
    return _measured(found, values, 0.51 / COLOUR_DENSITY)


def _measured(entry: Entry, values: _Any, bound: float) -> Entry | None:
    """Return the entry with its largest error; None if that is beyond the bound."""
    back = to_values(entry, to_codes(entry, values)).astype(np.float64)
    error = float(np.abs(back - values.astype(np.float64)).max())
    return replace(entry, error=error) if error <= bound else None


def is_lossless(entry: Entry, values: _Any) -> bool:
    """Tell whether all values come back bit for bit."""
    back = to_values(entry, to_codes(entry, values))
    return back.tobytes() == np.ascontiguousarray(values).tobytes()
