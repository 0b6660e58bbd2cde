"""Adaptive binary range coder whose probabilities are mixed from several contexts.

The arithmetic is in `src/core/coder.h`. One function serves both directions: it returns the bit
that it was given (encoding) or the bit that it has read (decoding), so that a model is written down
once for both.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from ctypes import byref, c_int64, c_uint64, c_void_p
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.coding.models import Model
from deltamesh._kernels.core import LIBRARY, address, call, constant, ints, invoke, number, table

MAX_INPUTS = constant("DM_MAX_INPUTS")
PROBABILITY_BITS = constant("DM_PROBABILITY_BITS")  # of a slot; below it count the observations
COUNT_BITS = constant("DM_COUNT_BITS")
COUNT_MASK = (1 << COUNT_BITS) - 1
TOP = 1 << 24  # the range stays at or above it, so that range >> 16 keeps 8 bits at least

# The tables are part of the format: ln(p / (1 - p)) in 1/256, for p in 1/4096; its inverse, p in
# 1/65536; the rate at which a slot that has seen n bits moves towards the next, in 1/65536.
STRETCH = table("dm_stretch", np.int16, 4096)
SQUASH = table("dm_squash", np.int32, 4096)
RATE = table("dm_rate", np.int32, COUNT_MASK + 1)
P_MIN = int(SQUASH[0])  # of 65536: a certain bit costs 0.0005 bits, a wrong certainty 11.4

MIXER = np.dtype(
    [
        ("weights", np.int64, MAX_INPUTS),  # in 1/65536, of each input
        ("inputs", np.int32),
        ("limit", np.int32),  # the bound of the counts of its slots, and so of their memory
        ("youth", np.int32),  # the bits that it may still learn fast from
        ("unused", np.int32),
    ]
)


class Registers(ctypes.Structure):
    """Registers of a coder, and where its memory is; `dm_coder` of the core.

    Invariant while encoding: low + range <= 2^33, so that at most one carry leaves `low`; it goes
    into `cache`, through the `pending` bytes of 0xFF behind it.
    """

    _fields_: ClassVar = [
        ("low", c_uint64),
        ("range", c_uint64),
        ("code", c_uint64),
        ("cache", c_uint64),
        ("pending", c_int64),
        ("position", c_int64),
        ("decoding", c_int64),
        ("slots", c_void_p),
        ("slot_count", c_int64),
        ("mixers", c_void_p),
        ("mixer_count", c_int64),
        ("data", c_void_p),
        ("size", c_int64),
    ]


class Coder(NamedTuple):
    """All that a coder keeps.

    Attributes
    ----------
    registers : Registers
    slots : uint32
        Each a probability of a one (22 bits) and a count (10 bits).
    mixers : MIXER
    data : uint8
        Written while encoding; read, with zeros beyond its end, while decoding.
    """

    registers: Registers
    slots: NDArray[np.uint32]
    mixers: NDArray[Any]
    data: NDArray[np.uint8]

    @property
    def pointer(self) -> object:
        """What the core takes."""
        return byref(self.registers)


LIBRARY.dm_finish.restype = c_int64


def new_coder(model: Model, data: NDArray[np.uint8], decoding: bool) -> Coder:
    """Return a coder of a model that reads or writes `data`."""
    kinds = np.empty((len(model.mixers), 3), dtype=np.int32)
    kinds[:, 0], kinds[:, 1:] = 1, model.mixers
    slots = np.empty(model.slots, dtype=np.uint32)
    mixers = np.empty(len(kinds), dtype=MIXER)
    coder = Coder(Registers(), slots, mixers, data)
    if not data.flags.c_contiguous or (not decoding and not data.flags.writeable):
        raise ValueError("a coder needs contiguous bytes, and an encoder such that can be written")
    call(
        "dm_start",
        coder.pointer,
        address(slots),
        len(slots),
        address(mixers),
        len(mixers),
        address(kinds),
        len(kinds),
        address(data),
        len(data),
        decoding,
    )
    return coder


def is_finished(c: Coder) -> bool:
    """Return whether a decoder has come to where the encoder stopped, with nothing left over."""
    return bool(invoke("dm_is_finished", c.pointer))


def finish_encoding(c: Coder) -> int:
    """Flush, with as many zero bytes at the end as can be, leave these out, return the length."""
    return invoke("dm_finish", c.pointer)


def code_raw(c: Coder, value: int, bits: int) -> int:
    """Code a number of that many bits, all equally likely, the high bit first."""
    coded = number()
    call("dm_raw", c.pointer, value, bits, byref(coded))
    return coded.value


def code_bit(c: Coder, bit: int, slots: Sequence[int], mixer: int) -> int:
    """Code one bit, predicted by slots, as many as the mixer has inputs, and learn from it."""
    coded, at = number(), np.array(slots, dtype=np.int64)
    call("dm_bit", c.pointer, bit, mixer, ints(at, len(at)), len(at), byref(coded))
    return coded.value
