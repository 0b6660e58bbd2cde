"""Signed integers in bits that several contexts predict; `src/core/signed_integers.h`."""

from __future__ import annotations

from ctypes import byref, c_int64

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.core import LIBRARY, call, constant, ints, number
from deltamesh_formats.array_types import Ints

LENGTHS = constant("DM_LENGTHS")  # |v| < 2^31: checked before a value reaches the coder
MANTISSAS = constant("DM_MANTISSAS")  # contexts of a mantissa, beside the candidates
LIMIT = constant("DM_HASH_LIMIT")  # of the counts
SLOTS = constant("DM_HASH_SLOTS")

LIBRARY.dm_level_of.restype = LIBRARY.dm_slot_of.restype = c_int64


def mixers(lengths: int, signs: int, candidates: int) -> tuple[tuple[int, int], ...]:
    """Return the mixers of numbers with that many contexts and candidates, for three axes."""
    inputs = (lengths,) * LENGTHS + (MANTISSAS,) * LENGTHS + (signs,)
    return 3 * tuple((n + candidates, LIMIT) for n in inputs)


def level(x: int) -> int:
    """Return two levels an octave: 0 for 0, 1 for 1, 3, 4 for 2, 3, then 5 and 6 for 4 to 7."""
    found: int = LIBRARY.dm_level_of(c_int64(x))
    return found


def hashed(number: int, axis: int, context: int) -> int:
    """Return the slot of a context, of that number and axis."""
    slot: int = LIBRARY.dm_slot_of(c_int64(number), c_int64(axis), c_int64(context))
    return slot


def code_signed(
    c: Coder,
    value: int,
    axis: int,
    lengths: Ints,
    signs: Ints,
    candidates: Ints,
    histories: Ints,
) -> int:
    """Code a number, or return the one that was read.

    Parameters
    ----------
    c : Coder
        With `SLOTS` slots, and the `mixers` of so many contexts and candidates.
    value : int
        |value| < 2^31.
    axis : int
        0, 1 or 2; each has a model of its own.
    lengths, signs : int64
        Contexts of the length and of the sign, below 2^31; with the candidates at most
        `MAX_INPUTS` of each.
    candidates, histories : int64
        Numbers that this may be; and how each of them has fared, from 0 to 31.
    """
    coded = number()
    many = len(candidates)
    call(
        "dm_signed",
        c.pointer,
        value,
        axis,
        ints(lengths, len(lengths)),
        len(lengths),
        ints(signs, len(signs)),
        len(signs),
        ints(candidates, many),
        ints(histories, many),
        many,
        byref(coded),
    )
    return coded.value
