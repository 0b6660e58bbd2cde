"""Values of an attribute as the integers that are coded, and back."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes.normals.octahedral import half
from deltamesh._measures.margins import SHARE
from deltamesh._streams.floats import bits_of, from_bits
from deltamesh_formats.array_types import Ints
from deltamesh_formats.container.attribute_entry import Entry
from deltamesh_formats.container.payload_layout import MAX_LIMB_BITS
from deltamesh_formats.errors import FormatError

_Any = NDArray[Any]

_WORD: Final = 1 << 64


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
