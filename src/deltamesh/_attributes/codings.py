"""Candidate codings of an attribute, and its values as the integers that are coded."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes.normals.octahedral import half, is_unit
from deltamesh._measures.margins import SHARE
from deltamesh._streams.floats import bits_of, from_bits
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.attribute_table import Entry
from deltamesh_formats.container.layout import MAX_LIMB_BITS
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import Attribute

_Any = NDArray[Any]

_WORD: Final = 1 << 64
BYTE: Final = 8
# Grid points a unit of a colour in 0 .. 1 that has 256 levels.
COLOUR_DENSITY: Final = 255.0


@dataclass(frozen=True)
class AttributeSettings:
    """Settings of the coding of attributes, and the positions that normals are predicted from.

    Attributes
    ----------
    bits_uv : int
        Bits of the largest extent of texture coordinates.
    bits_normal : int
        Bits of each of both coordinates of a normal.
    lossless : bool
        Whether every number is to come back bit for bit.
    positions : float64 (n, 3)
        Positions of the vertices as a decoder makes them.
    tolerance : float
        The largest distance between the positions that two decoders make.
    """

    bits_uv: int
    bits_normal: int
    lossless: bool
    positions: Floats
    tolerance: float


def candidate_codings(
    attribute: Attribute, values: _Any, settings: AttributeSettings
) -> Iterator[Entry]:
    """Yield the codings that may suit the values (r, width) of an attribute.

    At least one of them is lossless. Texture coordinates and unit normals, and colours within
    0 .. 1, may lose something; the meaning of other values is unknown.
    """
    a = attribute
    entry = Entry(a.name, a.domain, a.role, values.dtype, a.width, a.normalized, "exact")
    colours = a.role == "colour" and a.width >= 3
    for candidate in _unmixed_codings(entry, values, settings):
        yield candidate
        if colours and candidate.coding in ("integer", "grid") and candidate.limbs == 1:
            yield replace(candidate, mixed=True)


def _unmixed_codings(entry: Entry, values: _Any, settings: AttributeSettings) -> Iterator[Entry]:
    if values.dtype.kind in "bui":
        yield from _integer_codings(entry, values)
        return
    yield entry
    if values.dtype.kind == "c" or not values.size:
        return
    if entry.role == "colour":
        levels = _colour_coding(entry, values)
        if levels is not None and (not settings.lossless or _is_lossless(levels, values)):
            yield levels
    if entry.role == "uv" and not settings.lossless:
        grid = _grid_coding(entry, values, settings.bits_uv)
        if grid is not None:
            yield grid
    if entry.role == "normal" and not settings.lossless and is_unit(values):
        yield replace(entry, coding="octahedral", bits=settings.bits_normal)


def _integer_codings(entry: Entry, values: _Any) -> list[Entry]:
    """Return the codings of integers: in the fewest limbs, and in bytes where that may help."""
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


def _grid_coding(entry: Entry, values: _Any, bits: int) -> Entry | None:
    """Return the grid of 2^bits - 1 steps over the largest extent, None if it does not fit."""
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


def _colour_coding(entry: Entry, values: _Any) -> Entry | None:
    """Return the grid of 256 levels from 0 to 1; None if not all values lie there."""
    if not values.size or not ((values >= 0) & (values <= 1)).all():
        return None
    origin = (0.0,) * entry.width
    found = replace(entry, coding="grid", origin=origin, density=COLOUR_DENSITY, bits=BYTE)
    return _measured(found, values, 0.51 / COLOUR_DENSITY)


def _measured(entry: Entry, values: _Any, bound: float) -> Entry | None:
    """Return the entry with its largest error; None if that is beyond the bound."""
    back = from_codes(entry, to_codes(entry, values)).astype(np.float64)
    error = float(np.abs(back - values.astype(np.float64)).max())
    return replace(entry, error=error) if error <= bound else None


def _is_lossless(entry: Entry, values: _Any) -> bool:
    """Return whether all values come back bit for bit."""
    back = from_codes(entry, to_codes(entry, values))
    return back.tobytes() == np.ascontiguousarray(values).tobytes()


def to_codes(entry: Entry, values: _Any) -> Ints:
    """Return the integers (r, columns) of rows of values (r, width).

    Those of unit normals only distinguish them: their codes depend on the surface.
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


def from_codes(entry: Entry, codes: Ints) -> _Any:
    """Return the values of codes that `check_codes` accepts: the mirror of `to_codes`."""
    if entry.coding == "exact":
        return from_bits(codes, entry.dtype)
    if entry.coding == "grid":
        origin = np.array(entry.origin, dtype=np.float64)
        return (origin + codes / entry.density).astype(entry.dtype)
    words = _from_limbs(entry, codes)
    if entry.dtype.kind == "i":
        return words.view(np.int64).astype(entry.dtype)
    return words.astype(entry.dtype)


def margin_of(entry: Entry) -> float:
    """Return how far a writer may round each number of an attribute, 0 if it came back exactly."""
    if entry.error and entry.coding == "grid":
        return SHARE / 2 / entry.density
    if entry.error and entry.coding == "octahedral":
        return SHARE * math.sqrt(2) / half(entry.bits)
    return 0.0


def check_codes(entry: Entry, codes: Ints) -> None:
    """Refuse integers that are the codes of no value.

    Raises
    ------
    FormatError
    """
    if entry.coding == "exact":
        return
    most = MAX_LIMB_BITS if entry.coding == "grid" else entry.bits
    if ((codes < 0) | (codes >> most > 0)).any():
        raise FormatError("attribute integer out of range", 0)
    if entry.coding != "integer":
        return
    left = 64 - entry.bits * (entry.limbs - 1)
    highest = codes[:, entry.limbs - 1 :: entry.limbs]
    if entry.limbs > 1 and left < entry.bits and (highest >> left).any():
        raise FormatError("attribute integer exceeds 64 bits", 0)
    values = from_codes(entry, codes)
    if (_words(values) != _from_limbs(entry, codes)).any():
        raise FormatError(f"attribute value not representable in {entry.dtype}", 0)


def mixed(columns: Ints) -> Ints:
    """Return columns with the second subtracted from the first and the third."""
    result = columns.copy()
    result[:, [0, 2]] -= columns[:, 1:2]
    return result


def unmixed(columns: Ints) -> Ints:
    """Return the columns: the mirror of `mixed`."""
    result = columns.copy()
    result[:, [0, 2]] += columns[:, 1:2]
    return result


def _words(values: _Any) -> NDArray[np.uint64]:
    """Return integers or booleans (r, k) modulo 2^64."""
    if values.dtype.kind == "i":
        return values.astype(np.int64).view(np.uint64)
    return values.astype(np.uint64)


def _from_limbs(entry: Entry, codes: Ints) -> NDArray[np.uint64]:
    """Return the integers modulo 2^64 that limbs (r, columns) are cut from."""
    limbs = codes.reshape(len(codes), entry.numbers, entry.limbs).astype(np.uint64)
    shifts = np.arange(entry.limbs, dtype=np.uint64) * np.uint64(entry.bits)
    words = (limbs << shifts).sum(axis=2, dtype=np.uint64)
    return np.asarray(words + np.uint64(int(entry.origin[0]) % _WORD))
