"""Signed integers: their slots, their bits, and the twin that codes them as text."""

from __future__ import annotations

import numpy as np
import oracle
import pytest
import strategies
from coders import twin_of
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.coding import signed_integers
from deltamesh._streams import entropy


@pytest.mark.parametrize("x", [*range(40), 63, 64, 95, 96, 1000, 2**16, 3 << 20, 2**40, 2**62])
def test_level_equals_its_oracle(x: int) -> None:
    assert signed_integers.level(x) == oracle.level(x)
    assert signed_integers.level(-x) == 0


LENGTHS, SIGNS, CANDIDATES = 4, 2, 3
NUMBER_MIXERS = signed_integers.mixers(LENGTHS, SIGNS, CANDIDATES)
EXTREMES = [0, 1, -1, 2, -3, 2**30, 1 - 2**30, 2**31 - 1, 1 - 2**31]
any_number = st.sampled_from(EXTREMES) | st.integers(1 - 2**31, 2**31 - 1)
small_context = st.integers(0, 3) | st.integers(0, 2**31 - 1)


def contexts_of(size):
    return st.lists(small_context, min_size=size, max_size=size)


@st.composite
def numbers_with_contexts(draw):
    """(value, axis, lengths, signs, candidates, histories); the candidates are often right."""
    rows = []
    for _ in range(draw(st.integers(0, 12))):
        value, axis = draw(any_number), draw(st.integers(0, 2))
        other = st.sampled_from([value, -value, value ^ 1, value // 2, 2 * value])
        other |= st.integers(-(2**43), 2**43)
        candidates = draw(st.lists(other, min_size=CANDIDATES, max_size=CANDIDATES))
        histories = draw(st.lists(st.integers(0, 31), min_size=CANDIDATES, max_size=CANDIDATES))
        contexts = draw(contexts_of(LENGTHS)), draw(contexts_of(SIGNS))
        rows += [(value, axis, *contexts, candidates, histories)] * draw(st.integers(1, 4))
    return rows


def code_numbers(coder, rows, decoding=False):
    """What the kernel codes."""
    return [
        signed_integers.code_signed(
            coder, 0 if decoding else value, axis, *(np.array(a, dtype=np.int64) for a in arrays)
        )
        for value, axis, *arrays in rows
    ]


def code_numbers_slowly(coder, rows, decoding=False):
    return [oracle.code_number(coder, 0 if decoding else row[0], *row[1:]) for row in rows]


def slow_numbers(data=None):
    return twin_of(data, NUMBER_MIXERS)


@strategies.SOME
@given(numbers_with_contexts())
def test_numbers_equal_their_oracle_both_ways(rows: list[tuple]) -> None:
    values = [row[0] for row in rows]
    coder, twin = entropy.encoder(len(rows), signed_integers.SLOTS, NUMBER_MIXERS), slow_numbers()
    assert code_numbers(coder, rows) == values == code_numbers_slowly(twin, rows)
    data = entropy.finish(coder)
    assert data == twin.finish()
    decoder = entropy.decoder(data, signed_integers.SLOTS, NUMBER_MIXERS)
    assert code_numbers(decoder, rows, decoding=True) == values
    entropy.check_end(decoder, 0)
    assert code_numbers_slowly(slow_numbers(data), rows, decoding=True) == values


@strategies.SOME
@given(numbers_with_contexts(), st.binary(max_size=60), st.sampled_from([0x00, 0x55, 0xFF]))
def test_any_bytes_are_the_numbers_of_the_oracle(
    rows: list[tuple], data: bytes, filler: int
) -> None:
    data += bytes([filler]) * 200
    decoder, twin = entropy.decoder(data, signed_integers.SLOTS, NUMBER_MIXERS), slow_numbers(data)
    values = code_numbers(decoder, rows, decoding=True)
    assert values == code_numbers_slowly(twin, rows, decoding=True)
    assert decoder.registers.code == twin.code
    assert max(map(abs, values), default=0) < 2**31


@given(st.integers(0, 47), st.integers(0, 2), st.integers(0, 2**37))
def test_slots_equal_their_oracle(number: int, axis: int, context: int) -> None:
    """Contexts of a mantissa have up to 37 bits, of which 31 count."""
    slot = signed_integers.hashed(number, axis, context)
    assert slot == oracle.slot(number, axis, context)
    assert 0 <= slot < signed_integers.SLOTS


def test_known_slots() -> None:
    """Part of the format: other hashes, other bytes."""
    wanted = {
        (0, 0, 0): 0,
        (3, 1, 77): 277163,
        (33, 2, 8388613): 307963,
        (34, 0, 68719489081): 579620,
        (42, 2, 371): 442601,
    }
    assert {key: int(signed_integers.hashed(*key)) for key in wanted} == wanted


def test_the_longest_numbers_fit_the_buffer() -> None:
    """Three of the largest, at every vertex, each bit as surprising as can be."""
    rng = np.random.default_rng(12)
    zeros = [(0, axis, [0] * 4, [0] * 2, [0] * 3, [0] * 3) for axis in range(3)]
    rows = zeros * 300
    for value in rng.integers(2**30, 2**31, 300).tolist():
        rows += [(value, *row[1:]) for row in zeros]
    coder = entropy.encoder(600, signed_integers.SLOTS, NUMBER_MIXERS)
    code_numbers(coder, rows)
    data = entropy.finish(coder)
    assert len(data) < len(coder.data)
    decoder = entropy.decoder(data, signed_integers.SLOTS, NUMBER_MIXERS)
    assert code_numbers(decoder, rows, decoding=True) == [row[0] for row in rows]


def test_a_candidate_that_is_right_saves_all_the_bits() -> None:
    rng = np.random.default_rng(5)
    values = rng.integers(-(2**20), 2**20, 600).tolist()
    rows = [(v, 0, [0] * 4, [0] * 2, [v, -v, 7], [31, 0, 0]) for v in values]
    noise = [
        (v, 0, [0] * 4, [0] * 2, [w, -w, 7], [31, 0, 0])
        for v, w in zip(values, reversed(values), strict=True)
    ]
    sizes = []
    for message in (rows, noise):
        coder = entropy.encoder(len(rows), signed_integers.SLOTS, NUMBER_MIXERS)
        code_numbers(coder, message)
        sizes.append(len(entropy.finish(coder)))
    assert sizes[0] < 0.2 * sizes[1]
    assert 8 * sizes[1] < 24 * len(values)
