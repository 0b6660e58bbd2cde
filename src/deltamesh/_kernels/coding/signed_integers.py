"""Signed integers in bits that several contexts predict.

A number is the length of |v| in unary, the sign, the bits below the highest: an Exp-Golomb code
(Teuhola, "A compression method for clustered bit-vectors", 1978) of which each bit has adaptive
probabilities, as in CABAC (Marpe, Schwarz, Wiegand, 2003), here mixed from several contexts:

- those of the caller: levels of the magnitudes around, signs around;
- the number so far. Where numbers repeat, as in models of machine parts, all their bits are learnt;
  where the low bits are noise, such a context stays near one half, and so weighs nothing;
- candidates, numbers that this one may equal. As long as its bits agree with a candidate, that
  predicts the next one, the better the more often it was right recently: the match model of
  Mahoney, "Adaptive weighing of context models for lossless data compression", 2005.

Contexts are hashed into one table: a collision costs bits, nothing else.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import CONTEXT, MAX_INPUTS, Coder, code_bit
from deltamesh._kernels.jit import Int, inlined, kernel
from deltamesh_formats.array_types import Ints

LENGTHS = 32  # |v| < 2^31: checked before a value reaches the coder
LEVELS = 32
LIMIT = 255  # of the counts: measured best on the mean from 127, 255, 500, 1000
SLOTS = 1 << 20  # 2^18 cost 0.1 % more bytes, 2^22 save none

# Contexts of each kind of bit have 16 numbers, those of the candidates the last 8 of them.
LENGTH, SIGN, MANTISSA = 0, 16, 32
MATCHES = 8
MANTISSAS = 3  # contexts of a mantissa, beside the candidates
MODELLED = 3  # bits of a mantissa that see each other and the caller's first context

# Mixers of one axis: one for each bit of the length, one for each of the mantissa, the sign.
AXIS_MIXERS = 2 * LENGTHS + 1


def mixers(lengths: int, signs: int, candidates: int) -> tuple[tuple[int, int], ...]:
    """Return the mixers of numbers with that many contexts and candidates, for three axes."""
    inputs = (lengths,) * LENGTHS + (MANTISSAS,) * LENGTHS + (signs,)
    return 3 * tuple((n + candidates, LIMIT) for n in inputs)


@inlined
def level(x: Int) -> Int:
    """Return two levels an octave: 0 for 0, 1 for 1, 3, 4 for 2, 3, then 5 and 6 for 4 to 7."""
    if x <= 0:
        return np.int64(0)
    n = 0
    while (x >> (n + 1)) > 0:
        n += 1
    half = (x >> (n - 1)) & 1 if n > 0 else 0
    return np.int64(min(1 + 2 * n + half, LEVELS - 1))


@inlined
def bit_length(magnitude: Int) -> Int:
    """Return the number of bits of a magnitude, 0 for 0."""
    length = np.int64(0)
    while magnitude >> length > 0:
        length += 1
    return length


@inlined
def hashed(number: Int, axis: Int, context: Int) -> Int:
    """Return the slot of a context, of that number and axis; products are modulo 2^32."""
    h = ((4 * number + axis) * 0x9E3779B1 + (context & 0x7FFFFFFF) * 0x85EBCA6B) & 0xFFFFFFFF
    h ^= h >> 15
    h = (h * 0x2C1B3C6D) & 0xFFFFFFFF
    h ^= h >> 13
    return h & (SLOTS - 1)


@kernel
def code_signed(
    c: Coder,
    value: Int,
    axis: Int,
    lengths: Ints,
    signs: Ints,
    candidates: Ints,
    histories: Ints,
) -> Int:
    """Code a number, or return the one that was read.

    Parameters
    ----------
    c : Coder
        With `SLOTS` slots, and the `mixers` of so many contexts and candidates.
    value : int64
        |value| < 2^31.
    axis : int64
        0, 1 or 2; each has a model of its own.
    lengths, signs : int64
        Contexts of the length and of the sign, below 2^31; with the candidates at most
        `MAX_INPUTS` of each.
    candidates, histories : int64
        Numbers that this may be; and how each of them has fared, from 0 to 31.
    """
    mixer = axis * AXIS_MIXERS
    length = bit_length(abs(value))
    length = _code_length(c, length, axis, lengths, candidates, histories, mixer)
    if length == 0:
        return np.int64(0)
    sign_mixer, mantissa_mixer = mixer + 2 * LENGTHS, mixer + LENGTHS
    negative = np.int64(value < 0)
    negative = _code_sign(c, negative, length, axis, signs, candidates, histories, sign_mixer)
    first = lengths[0]
    magnitude = _code_mantissa(
        c, abs(value), length, negative, axis, first, candidates, histories, mantissa_mixer
    )
    return -magnitude if negative == 1 else magnitude


@kernel
def _code_length(
    c: Coder,
    length: Int,
    axis: Int,
    contexts: Ints,
    candidates: Ints,
    histories: Ints,
    mixer: Int,
) -> Int:
    """Code the length in unary; candidates say whether they are shorter."""
    slots = np.empty(MAX_INPUTS, np.int64)
    many = len(contexts)
    for i in range(many):
        slots[i] = hashed(LENGTH + i, axis, contexts[i])
    k = np.int64(0)
    while k < LENGTHS - 1:
        for i in range(many):
            c.state[CONTEXT + i] = (slots[i] + k) & (SLOTS - 1)
        for i in range(len(candidates)):
            other = bit_length(abs(candidates[i]))
            side = 0 if other < k else (1 if other == k else 2)
            match = (histories[i] * 3 + side) * LENGTHS + k
            c.state[CONTEXT + many + i] = hashed(LENGTH + MATCHES + i, axis, match)
        if code_bit(c, np.int64(length > k), mixer + k) == 0:
            break
        k += 1
    return k


@kernel
def _code_sign(
    c: Coder,
    negative: Int,
    length: Int,
    axis: Int,
    contexts: Ints,
    candidates: Ints,
    histories: Ints,
    mixer: Int,
) -> Int:
    many = len(contexts)
    for i in range(many):
        c.state[CONTEXT + i] = hashed(SIGN + i, axis, contexts[i])
    for i in range(len(candidates)):
        agrees = bit_length(abs(candidates[i])) == length
        expected = (2 if candidates[i] < 0 else 1) if agrees else 0
        match = histories[i] * 3 + expected
        c.state[CONTEXT + many + i] = hashed(SIGN + MATCHES + i, axis, match)
    return code_bit(c, negative, mixer)


@kernel
def _code_mantissa(
    c: Coder,
    magnitude: Int,
    length: Int,
    negative: Int,
    axis: Int,
    context: Int,
    candidates: Ints,
    histories: Ints,
    mixer: Int,
) -> Int:
    """Code the bits of a magnitude below its highest, the high ones first."""
    result = np.int64(1)  # the bits so far
    for j in range(length - 1):
        shift = length - 2 - j
        node = length * 8 + (result if j < MODELLED else 0)
        near = context if j < MODELLED else 0
        c.state[CONTEXT] = hashed(np.int64(MANTISSA), axis, node * LENGTHS + j)
        c.state[CONTEXT + 1] = hashed(
            np.int64(MANTISSA + 1), axis, (node * LENGTHS + j) * 1024 + near
        )
        whole = (result * LENGTHS + length) * 2 + negative
        c.state[CONTEXT + 2] = hashed(np.int64(MANTISSA + 2), axis, whole)
        for i in range(len(candidates)):
            other = abs(candidates[i])
            agrees = (candidates[i] < 0) == (negative == 1) and other >> (shift + 1) == result
            expected = 1 + ((other >> shift) & 1) if agrees else 0
            match = (histories[i] * 4 + min(j, 3)) * 3 + expected
            c.state[CONTEXT + MANTISSAS + i] = hashed(MANTISSA + MATCHES + i, axis, match)
        bit = code_bit(c, (magnitude >> shift) & 1, mixer + j)
        result = 2 * result + bit
    return result
