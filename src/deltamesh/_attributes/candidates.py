"""Candidate codings of an attribute, the smallest of which is kept."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes.codings import from_codes, to_codes
from deltamesh._attributes.normals.octahedral import half, is_unit
from deltamesh._measures.margins import SHARE
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.attribute_entry import Entry
from deltamesh_formats.container.payload_layout import (
    MAX_LIMB_BITS,
    MAX_NORMAL_BITS,
    MIN_NORMAL_BITS,
)
from deltamesh_formats.polymesh.mesh import Attribute

_Any = NDArray[Any]

BYTE: Final = 8
# A grid has the steps of the range of all values or, if that is less, of one that is so many times
# as wide as without so large a share of them at either end; of fewer values, each counts.
_WIDER: Final = 2.0
_FEW: Final = 0.005
_LEAST: Final = 16
_MOST_STEPS: Final = (1 << MAX_LIMB_BITS) - 1
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
    bits_float : int or None
        Bits of the largest extent of other floats; None to keep them bit for bit.
    errors : mapping of str to float
        The largest errors of attributes, by their names and roles.
    """

    bits_uv: int
    bits_normal: int
    lossless: bool
    positions: Floats
    tolerance: float
    bits_float: int | None = None
    errors: Mapping[str, float] = field(default_factory=dict)

    def error_of(self, attribute: Attribute | Entry) -> float:
        """Return the largest error that an attribute may have; infinite if nothing says so."""
        names = (attribute.name, attribute.role)
        return min(self.errors.get(name, math.inf) for name in names)


def candidate_codings(
    attribute: Attribute, values: _Any, settings: AttributeSettings
) -> Iterator[Entry]:
    """Yield the codings that may suit the values (r, width) of an attribute.

    At least one of them is lossless. Texture coordinates and unit normals, and colours within
    0 .. 1, may lose something; the meaning of other values is unknown, and so they do if the
    settings say so.
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
    if (error := settings.error_of(entry)) < math.inf:
        coding = _bounded_coding(entry, values, error)
    elif settings.lossless:
        coding = _colour_coding(entry, values) if entry.role == "colour" else None
        coding = coding if coding is not None and _is_lossless(coding, values) else None
    else:
        coding = _rounded_coding(entry, values, settings)
    if coding is not None:
        yield coding


def _rounded_coding(entry: Entry, values: _Any, settings: AttributeSettings) -> Entry | None:
    """Return the coding of floats that suits their role, or the one that was asked for."""
    coding = None
    if entry.role == "colour":
        coding = _colour_coding(entry, values)
    elif entry.role == "uv":
        coding = _grid_coding(entry, values, settings.bits_uv)
    elif entry.role == "normal" and is_unit(values):
        coding = replace(entry, coding="octahedral", bits=settings.bits_normal)
    if coding is None and settings.bits_float is not None:
        return _grid_coding(entry, values, settings.bits_float)
    return coding


def _bounded_coding(entry: Entry, values: _Any, error: float) -> Entry | None:
    """Return the coding within an error, of normals an angle in degrees; None if there is none."""
    if entry.role == "normal" and is_unit(values):
        for bits in range(MIN_NORMAL_BITS, MAX_NORMAL_BITS + 1):
            if half(bits) > 0 and math.degrees(math.sqrt(2) / half(bits)) <= error:
                return replace(entry, coding="octahedral", bits=bits)
        return None
    V = values.astype(np.float64)
    if not np.isfinite(V).all():
        return None
    # A writer may round by a share of half a step more, and floats by their last bit.
    density = 0.501 * (1 + SHARE) / error
    extent = float(np.ptp(V, axis=0).max())
    if not (0 < density < np.inf and extent * density < 1 << MAX_LIMB_BITS):
        return None
    found = _on_grid(entry, V, density, 0)
    return _measured(found, values, error)


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
    """Return the grid of 2^bits - 1 steps over the largest extent, None if it does not fit.

    A few values that lie far away do not make the steps of all others coarse.
    """
    V = values.astype(np.float64)
    if not V.size or not np.isfinite(V).all():
        return None
    extent = float(np.ptp(V, axis=0).max())
    if not np.isfinite(extent):
        return None
    usual = min(extent, _WIDER * _inner_extent(V)) or extent
    density = ((1 << bits) - 1) / usual if usual > 0 else 1.0
    density = min(density, _MOST_STEPS / extent if extent > 0 else 1.0)
    if not 0 < density < np.inf:
        return None
    return _measured(_on_grid(entry, V, density, bits), values, 0.51 / density)


def _inner_extent(V: Floats) -> float:
    """Return the largest extent without a few of the values at either end, if there are many."""
    few = max(round(_FEW * len(V)), 1)
    if len(V) < _LEAST:
        return float(np.ptp(V, axis=0).max())
    inner = np.partition(V, (few, len(V) - 1 - few), axis=0)
    return float((inner[len(V) - 1 - few] - inner[few]).max())


def _on_grid(entry: Entry, V: Floats, density: float, bits: int) -> Entry:
    origin = tuple(V.min(axis=0).tolist())
    return replace(entry, coding="grid", origin=origin, density=density, bits=bits)


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
