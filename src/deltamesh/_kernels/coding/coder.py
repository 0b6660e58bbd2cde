"""Adaptive binary range coder whose probabilities are mixed from several contexts.

The arithmetic coder is the carry-propagating range coder of LZMA (Martin, "Range encoding: an
algorithm for removing redundancy from a digitised message", 1979; Pavlov, LZMA specification).
A bit is predicted by several adaptive probabilities, one a context, which a gated linear mixer
joins in the logistic domain (Mahoney, "Adaptive weighing of context models for lossless data
compression", 2005, section 3). Everything is an integer: encoder and decoder cannot drift apart.

One function serves both directions: `code_bit` returns the bit that it was given (encoding) or
the bit that it has read (decoding), so that a model is written down once for both.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.jit import Flag, Int, inlined, kernel
from deltamesh_formats.array_types import Ints

# Indices into Coder.state: the registers; the slots of the bit at hand, set by the caller; what
# the mixer was given for each.
LOW, RANGE, CODE, CACHE, PENDING, POSITION, DECODING, MIXERS = range(8)
CONTEXT = 8
MAX_INPUTS = 10
INPUT = CONTEXT + MAX_INPUTS
STATE_SIZE = INPUT + MAX_INPUTS

# A mixer in Coder.memory: a weight in 1/65536 for each input; how many inputs it has; the bound of
# the counts of its slots, and so of their memory; the bits that it may still learn fast from.
MIXER_INPUTS, MIXER_LIMIT, MIXER_YOUTH, MIXER_SIZE = range(MAX_INPUTS, MAX_INPUTS + 4)
YOUTH = 300  # then it learns half as fast: 0.2 % smaller than either speed alone

PROBABILITY_BITS = 22  # of a slot; 10 bits below it count the observations
COUNT_BITS = 10
COUNT_MASK = (1 << COUNT_BITS) - 1
UNKNOWN = 1 << (PROBABILITY_BITS - 1 + COUNT_BITS)  # a slot that has seen nothing: one half

TOP = 1 << 24  # the range stays at or above it, so that range >> 16 keeps 8 bits at least
MASK32 = (1 << 32) - 1
P_MIN = 24  # of 65536: a certain bit costs 0.0005 bits, a wrong certainty 11.4

# The tables are part of the format. No entry is so near to a half-integer that an error of
# `math.log` or `math.exp` in the last place could change its rounding; a test pins a digest.
# ln(p / (1 - p)) in 1/256, for p in 1/4096.
STRETCH = np.array(
    [round(256 * math.log((p + 0.5) / (4095.5 - p))) for p in range(4096)], dtype=np.int16
)
# Its inverse: p in 1/65536.
SQUASH = np.array(
    [
        min(max(round(65536 / (1 + math.exp(-x / 256))), P_MIN), 65536 - P_MIN)
        for x in range(-2048, 2048)
    ],
    dtype=np.int32,
)
# The rate at which a slot that has seen n bits moves towards the next, in 1/65536: that of a
# running mean, with 1.8 for the 1.5 of Krichevsky and Trofimov's estimator, which measured best.
RATE = np.array([int(65536 / (n + 1.8)) for n in range(COUNT_MASK + 1)], dtype=np.int32)


class Coder(NamedTuple):
    """All that the coder keeps. Few arrays: numba passes each by value, in seven words.

    Attributes
    ----------
    state : int64 (STATE_SIZE,)
        Registers. Invariant while encoding: LOW + RANGE <= 2^33, so that at most one carry leaves
        LOW; it goes into CACHE, through the PENDING bytes of 0xFF behind it.
    memory : int64
        Slots, each a probability of a one (22 bits) and a count (10 bits); from state[MIXERS]
        on, the mixers.
    data : uint8
        Written while encoding; read, with zeros beyond its end, while decoding.
    """

    state: Ints
    memory: Ints
    data: NDArray[np.uint8]


@inlined
def _next_byte(c: Coder) -> Int:
    state = c.state
    position = state[POSITION]
    state[POSITION] = position + 1
    # The encoder leaves trailing zeros out.
    return np.int64(c.data[position]) if position < c.data.size else np.int64(0)


@kernel
def start_decoding(c: Coder) -> None:
    """Fill the code register with the first four bytes."""
    state = c.state
    state[DECODING] = 1
    for _ in range(4):
        state[CODE] = (state[CODE] << 8) | _next_byte(c)


@inlined
def _put_byte(c: Coder, byte: Int) -> None:
    """Store a byte; never past the end of the buffer, though no model writes that much."""
    state = c.state
    position = state[POSITION]
    if 0 <= position < c.data.size:
        c.data[position] = byte
    state[POSITION] = position + 1


@kernel
def _shift_low(c: Coder) -> None:
    """Move the top byte of LOW out, holding back bytes that a carry may still change."""
    state = c.state
    low = state[LOW]
    if low < 0xFF000000 or low > MASK32:
        carry = low >> 32
        _put_byte(c, (state[CACHE] + carry) & 0xFF)
        while state[PENDING] > 0:
            _put_byte(c, (0xFF + carry) & 0xFF)
            state[PENDING] -= 1
        state[CACHE] = (low >> 24) & 0xFF
    else:
        state[PENDING] += 1
    state[LOW] = (low << 8) & MASK32


@inlined
def _roundest(low: Int, span: Int) -> Int:
    """Return the number in [low, low + span) that ends in the most zero bytes; span >= TOP."""
    rounded = (low + MASK32) & ~MASK32
    return rounded if rounded < low + span else (low + TOP - 1) & ~(TOP - 1)


@kernel
def is_finished(c: Coder) -> Flag:
    """Return whether a decoder has come to where the encoder stopped, with nothing left over.

    The decoder keeps LOW too, but for carries, so that a stream has one form only.
    """
    state = c.state
    low = state[LOW] & MASK32
    return state[CODE] == _roundest(low, state[RANGE]) - low


@kernel
def finish_encoding(c: Coder) -> Int:
    """Flush, with as many zero bytes at the end as can be, leave these out, return the length."""
    state = c.state
    state[LOW] = _roundest(state[LOW], state[RANGE])
    for _ in range(5):
        _shift_low(c)
    length = state[POSITION]
    while 0 < length <= c.data.size and c.data[length - 1] == 0:
        length -= 1
    return length


@inlined
def _code_with(c: Coder, bit: Int, p: Int) -> Int:
    """Code one bit whose probability of being one is p / 65536."""
    state = c.state
    span = state[RANGE]
    bound = (span >> 16) * p
    if state[DECODING] == 1:
        code = state[CODE]
        bit = np.int64(code < bound)
        if bit == 0:
            state[CODE] = code - bound
    if bit == 0:
        state[LOW] += bound
    span = bound if bit == 1 else span - bound
    while span < TOP:
        span <<= 8
        if state[DECODING] == 1:
            state[CODE] = (state[CODE] << 8) | _next_byte(c)
            state[LOW] = (state[LOW] << 8) & MASK32
        else:
            _shift_low(c)
    state[RANGE] = span
    return bit


@kernel
def code_raw(c: Coder, value: Int, bits: Int) -> Int:
    """Code a number of that many bits, all equally likely, the high bit first."""
    result = 0
    for shift in range(bits - 1, -1, -1):
        result = (result << 1) | _code_with(c, (value >> shift) & 1, np.int64(32768))
    return result


@kernel
def code_bit(c: Coder, bit: Int, mixer: Int) -> Int:
    """Code one bit and learn from it.

    It is predicted by the slots that the caller has put into `state[CONTEXT:]`, as many as the
    mixer has inputs.
    """
    memory = c.memory
    weights = c.state[MIXERS] + mixer * MIXER_SIZE
    inputs, limit = memory[weights + MIXER_INPUTS], memory[weights + MIXER_LIMIT]
    dot = 0
    for i in range(inputs):
        slot = memory[c.state[CONTEXT + i]]
        stretched = np.int64(STRETCH[slot >> (PROBABILITY_BITS - 12 + COUNT_BITS)])
        c.state[INPUT + i] = stretched
        dot += memory[weights + i] * stretched
    p = np.int64(SQUASH[min(max(dot >> 16, -2047), 2047) + 2048])
    bit = _code_with(c, bit, p)
    error = (bit << 16) - p
    young = memory[weights + MIXER_YOUTH] > 0
    memory[weights + MIXER_YOUTH] -= young
    shift = 14 if young else 15
    for i in range(inputs):
        memory[weights + i] += (c.state[INPUT + i] * error + (1 << (shift - 1))) >> shift
        slot = memory[c.state[CONTEXT + i]]
        count = slot & COUNT_MASK
        probability = slot >> COUNT_BITS
        probability += (((bit << PROBABILITY_BITS) - probability) * np.int64(RATE[count])) >> 16
        memory[c.state[CONTEXT + i]] = (probability << COUNT_BITS) | min(count + 1, limit)
    return bit


@kernel
def code_number(c: Coder, value: Int, slots: Int, mixer: Int, most: Int) -> Int:
    """Code a number >= 1: its length in adaptive unary, then its bits below the highest.

    The unary has a slot for each of at most `most` bits, from `slots` on, and one mixer.
    """
    bits = 0
    while value >> (bits + 1) > 0:
        bits += 1
    k = 0
    while k < most:
        c.state[CONTEXT] = slots + k
        if code_bit(c, 1 if bits > k else 0, mixer) == 0:
            break
        k += 1
    return (1 << k) | code_raw(c, value & ((1 << k) - 1), k)
