"""The range coder with mixing: its twin, its invariants, its tables, and damaged streams."""

from __future__ import annotations

import decimal
import hashlib
import math
import zlib

import numpy as np
import pytest
import strategies
from coders import TABLES, slow_coder
from hypothesis import given
from hypothesis import strategies as st
from spec_tables import SPEC

from deltamesh._kernels.coding import coder as kernels
from deltamesh._kernels.coding.coder import (
    COUNT_BITS,
    COUNT_MASK,
    PROBABILITY_BITS,
    TOP,
    code_bit,
    code_raw,
)
from deltamesh._kernels.coding.models import Model
from deltamesh._streams import entropy
from deltamesh_formats.errors import FormatError

# A mixer is (inputs, bound of the counts).
SLOTS, MIXERS = 12, ((1, 255), (2, 255), (5, 1), (8, 30), (1, 1000), (3, 1023))

# What is coded: ("bit", bit, slots, mixer) or ("raw", value, bits).
modelled_bits = st.integers(0, len(MIXERS) - 1).flatmap(
    lambda mixer: st.tuples(
        st.just("bit"),
        st.integers(0, 1),
        st.lists(st.integers(0, SLOTS - 1), min_size=MIXERS[mixer][0], max_size=MIXERS[mixer][0]),
        st.just(mixer),
    )
)
raw_numbers = st.integers(0, 40).flatmap(
    lambda bits: st.tuples(st.just("raw"), st.integers(0, 2**bits - 1), st.just(bits))
)


@st.composite
def messages(draw):
    """Runs of one symbol, so that probabilities go to their ends, and single symbols between."""
    message = []
    for symbol, count in draw(
        st.lists(st.tuples(st.one_of(modelled_bits, raw_numbers), st.integers(1, 60)), max_size=25)
    ):
        message += [symbol] * count
    return message


def code(coder, message, decoding=False):
    """Code a message with the fast coder; give what it returned."""
    out = []
    for kind, value, *rest in message:
        given_value = 0 if decoding else value
        if kind == "raw":
            out.append(code_raw(coder, given_value, rest[0]))
        else:
            slots, mixer = rest
            out.append(code_bit(coder, given_value, slots, mixer))
    return out


def code_slowly(coder, message, decoding=False):
    out = []
    for kind, value, *rest in message:
        given_value = 0 if decoding else value
        out.append(
            coder.raw(given_value, *rest) if kind == "raw" else coder.bit(given_value, *rest)
        )
    return out


def slow(data=None):
    return slow_coder(data, SLOTS, MIXERS)


def encoded(message):
    coder = entropy.encoder(len(message), SLOTS, MIXERS)
    assert code(coder, message) == [value for _, value, *_ in message]
    return entropy.finish(coder)


@given(messages())
def test_equals_its_oracle_both_ways(message: list[tuple]) -> None:
    twin = slow()
    assert code_slowly(twin, message) == [value for _, value, *_ in message]
    data = encoded(message)
    assert data == twin.finish()
    values = [value for _, value, *_ in message]
    assert code_slowly(slow(data), message, decoding=True) == values
    decoder = entropy.decoder(data, SLOTS, MIXERS)
    assert code(decoder, message, decoding=True) == values
    entropy.check_end(decoder, 0)


@given(messages(), st.binary(max_size=40))
def test_any_bytes_decode_as_the_oracle_decodes_them(message: list[tuple], data: bytes) -> None:
    """Of a stream that no encoder has written, both make the same, and go on beyond its end."""
    decoder, twin = entropy.decoder(data, SLOTS, MIXERS), slow(data)
    assert code(decoder, message, decoding=True) == code_slowly(twin, message, decoding=True)
    assert decoder.registers.code == twin.code
    assert decoder.registers.position == twin.position


def test_long_messages_equal_their_oracle() -> None:
    """Long enough for every mixer to be past its youth, and every count at its bound."""
    rng = np.random.default_rng(2003)
    message = []
    for _ in range(6000):
        mixer = int(rng.integers(len(MIXERS)))
        slots = rng.integers(0, SLOTS, MIXERS[mixer][0]).tolist()
        message.append(("bit", int(rng.random() < (slots[0] + 1) / 14), slots, mixer))
    twin = slow()
    code_slowly(twin, message)
    data = encoded(message)
    assert data == twin.finish()
    decoder = entropy.decoder(data, SLOTS, MIXERS)
    assert code(decoder, message, decoding=True) == [value for _, value, *_ in message]


def test_empty_stream_takes_no_bytes() -> None:
    assert encoded([]) == b"" == slow().finish()
    entropy.check_end(entropy.decoder(b"", SLOTS, MIXERS), 0)


def test_the_likeliest_stream_takes_no_bytes() -> None:
    """Ones have the lower part of the range: a run of them ends at zero, which is left out."""
    message = [("bit", 1, [0], 0)] * 3000
    assert encoded(message) == b""
    assert code(entropy.decoder(b"", SLOTS, MIXERS), message, decoding=True) == [1] * 3000


@pytest.mark.parametrize("bit", [0, 1])
def test_long_certain_runs_cost_little_and_end(bit: int) -> None:
    message = [("bit", bit, [0, 1], 1)] * 20_000 + [("bit", 1 - bit, [0, 1], 1)]
    message += [("raw", 0x5A5A, 16)]
    data = encoded(message)
    assert data == _slow_bytes(message)
    # At least log2(65536 / (65536 - P_MIN)) a bit: what the limits of the decoder count on.
    assert 8 * len(data) < 20_000 * 1.5 * kernels.P_MIN / 65536 / math.log(2) + 100
    decoder = entropy.decoder(data, SLOTS, MIXERS)
    assert code(decoder, message, decoding=True) == [value for _, value, *_ in message]


def _slow_bytes(message):
    twin = slow()
    code_slowly(twin, message)
    return twin.finish()


# 0.5 as a raw bit puts LOW in the middle of the range: with ones the bytes that wait become
# 0xFF, and a last zero bit carries through them all.
@pytest.mark.parametrize("length", [1, 7, 8, 9, 24, 32, 33, 40, 250, 2000])
@pytest.mark.parametrize("last", [0, 1])
def test_carry_through_bytes_of_ff(length: int, last: int) -> None:
    raw = [("raw", 1, 1)] + [("raw", 0, 1)] * length + [("raw", last, 1)] * 2
    for message in (raw, [("raw", 1 - value, 1) for _, value, _ in raw]):
        data = encoded(message)
        assert data == _slow_bytes(message)
        decoder = entropy.decoder(data, SLOTS, MIXERS)
        assert code(decoder, message, decoding=True) == [value for _, value, _ in message]


@given(st.integers(0, 2**32 - 2), st.integers(1, 300), messages())
def test_carries_from_any_place_of_the_range(low: int, pending: int, message: list[tuple]) -> None:
    """A coder with bytes of 0xFF in waiting, as they come up once in 2^(8 n) streams."""
    coder = entropy.encoder(len(message) + pending, SLOTS, MIXERS)
    coder.registers.cache, coder.registers.pending = 0x41, pending
    coder.registers.low, coder.registers.range = low, 2**32 - 1
    code(coder, message)
    data = entropy.finish(coder)
    twin = slow()
    twin.low = (((0x42 << 8 * pending) - 1) << 32) + low  # 41 FF ... FF, then LOW
    code_slowly(twin, message)
    # The byte before 0x41 would be the first one, which is not stored: neither is 0x41.
    expected = _bytes(twin, 5 + pending)[1:].rstrip(b"\0")
    assert data == expected


def _bytes(twin, size):
    for bits in (32, 24, 16, 8, 0):
        rounded = -(-twin.low >> bits) << bits
        if rounded < twin.low + twin.span:
            return rounded.to_bytes(size + twin.shifted, "big")


@strategies.SOME
@given(messages())
def test_invariants_of_the_state(message: list[tuple]) -> None:
    encoder = entropy.encoder(len(message), SLOTS, MIXERS)
    for symbol in message:
        code(encoder, [symbol])
        registers = encoder.registers
        assert TOP <= registers.range < 2**32
        assert 0 <= registers.low <= 2**33 - registers.range  # at most one carry
        assert 0 <= registers.cache < 256
        assert registers.pending >= 0
        assert (encoder.slots >> COUNT_BITS < 1 << PROBABILITY_BITS).all()
        assert (encoder.slots & COUNT_MASK <= np.max([limit for _, limit in MIXERS])).all()
    data = entropy.finish(encoder)
    assert not data.endswith(b"\0")
    decoder = entropy.decoder(data, SLOTS, MIXERS)
    for symbol in message:
        code(decoder, [symbol], decoding=True)
        assert 0 <= decoder.registers.code < decoder.registers.range
    # Both have learnt the same.
    np.testing.assert_array_equal(decoder.slots, encoder.slots)
    np.testing.assert_array_equal(decoder.mixers, encoder.mixers)


def test_weights_of_a_mixer_are_its_own() -> None:
    coder = entropy.encoder(100, SLOTS, MIXERS)
    before = coder.mixers.copy()
    code(coder, [("bit", 1, [3, 4], 1)] * 50)
    changed = coder.mixers["weights"] != before["weights"]
    assert np.argwhere(changed).tolist() == [[1, 0], [1, 1]]
    assert (before["youth"] - coder.mixers["youth"]).tolist() == [0, 50, 0, 0, 0, 0]


@pytest.mark.parametrize(("mixer", "p"), [(0, 0.5), (0, 0.3), (0, 0.9), (4, 0.02), (4, 0.5)])
def test_size_of_bernoulli_bits_is_their_entropy(mixer: int, p: float) -> None:
    n = 30_000
    bits = np.random.default_rng(7124).random(n) < p
    data = encoded([("bit", int(bit), [0], mixer) for bit in bits])
    share = bits.mean()
    expected = -n * (share * math.log2(share) + (1 - share) * math.log2(1 - share))
    assert expected - 32 < 8 * len(data) < 1.02 * expected + 32


def test_mixing_takes_the_better_context() -> None:
    """One of two contexts tells the bit: soon the other one costs nothing more."""
    rng = np.random.default_rng(7127)
    bits, noise = rng.integers(0, 2, (2, 5000)).tolist()
    message = [("bit", b, [b, 2 + n], 1) for b, n in zip(bits, noise, strict=True)]
    assert 8 * len(encoded(message)) < 0.05 * len(bits)


@pytest.mark.parametrize("bits", [0, 1, 31, 62])
def test_raw_numbers_cost_their_bits(bits: int) -> None:
    message = [("raw", (1 << bits) - 1 - i % 2 if bits else 0, bits) for i in range(64)]
    data = encoded(message)
    assert 8 * bits - 1 <= len(data) <= 8 * bits + 1
    decoder = entropy.decoder(data, SLOTS, MIXERS)
    assert code(decoder, message, decoding=True) == [value for _, value, _ in message]


def assert_refused_or_of_another_message(data, message):
    """A stream has one form only: other bytes are refused, or what the other message encodes to."""
    decoder = entropy.decoder(data, SLOTS, MIXERS)
    values = code(decoder, message, decoding=True)
    other = [(kind, value, *rest) for value, (kind, _, *rest) in zip(values, message, strict=True)]
    if other != message and encoded(other) == data:
        entropy.check_end(decoder, 1000)
        return
    with pytest.raises(FormatError) as caught:
        entropy.check_end(decoder, 1000)
    assert 1000 <= caught.value.offset <= 1000 + len(data)


@given(messages(), st.binary(min_size=1, max_size=10))
def test_bytes_left_over(message: list[tuple], rest: bytes) -> None:
    assert_refused_or_of_another_message(encoded(message) + rest, message)


@given(messages(), strategies.SMALL)
def test_flipped_bits(message: list[tuple], at: int) -> None:
    data = bytearray(encoded(message))
    if data:
        data[at // 8 % len(data)] ^= 1 << at % 8
        assert_refused_or_of_another_message(bytes(data), message)


@given(messages(), strategies.SMALL)
def test_truncated_stream(message: list[tuple], size: int) -> None:
    data = encoded(message)
    if data:
        assert_refused_or_of_another_message(data[: size % len(data)], message)


def test_a_buffer_that_is_too_small_is_not_overrun() -> None:
    """The length says that more was needed; nothing beyond the buffer is touched."""
    big = entropy.encoder(1000, SLOTS, MIXERS)
    backing = np.full(100, 0xEE, dtype=np.uint8)
    small = kernels.new_coder(Model(SLOTS, MIXERS), backing[:10], decoding=False)
    message = [("raw", 0x7ABCDEF, 27)] * 20
    code(big, message)
    code(small, message)
    assert kernels.finish_encoding(small) >= kernels.finish_encoding(big) > len(small.data)
    assert (backing[10:] == 0xEE).all()
    assert backing[:10].tobytes() == big.data[:10].tobytes()


# ---- Tables: part of the format ----------------------------------------------------------------


def test_digest_of_the_tables() -> None:
    digest = hashlib.blake2b(digest_size=8)
    for table in TABLES:
        digest.update(table.astype("<i8"))
    assert digest.hexdigest() == "2edb518d38e27b44"


def test_spec_has_the_checksums_of_the_tables() -> None:
    types = "<i2", "<i4", "<i4"
    sums = (zlib.crc32(t.astype(kind)) for t, kind in zip(TABLES, types, strict=True))
    assert ", ".join(f"{one:08X}" for one in sums) in " ".join(SPEC.split())


def test_tables_follow_their_definitions_in_exact_arithmetic() -> None:
    """`math.log` and `math.exp` differ between machines in the last place; no entry does."""
    with decimal.localcontext(prec=40):
        half = decimal.Decimal("0.5")
        for p, entry in enumerate(kernels.STRETCH.tolist()):
            exact = 256 * ((p + half) / (4096 - half - p)).ln()
            assert entry == round(exact)
            assert abs(abs(exact - entry) - half) > decimal.Decimal("9e-5")
        for i, entry in enumerate(kernels.SQUASH.tolist()):
            exact = 65536 / (1 + (-decimal.Decimal(i - 2048) / 256).exp())
            assert entry == min(max(round(exact), kernels.P_MIN), 65536 - kernels.P_MIN)
            assert abs(abs(exact - round(exact)) - half) > decimal.Decimal("9e-5")


def test_shape_of_the_tables() -> None:
    stretch, squash, rate = (table.astype(np.int64) for table in TABLES)
    assert (np.diff(stretch) >= 0).all()
    assert (stretch == -stretch[::-1]).all()
    assert (np.diff(squash) >= 0).all()
    assert squash[2048] == 32768
    assert (squash[1:] + squash[:0:-1] == 65536).all()
    # A range of at least TOP leaves both halves at least one.
    assert squash.min() * (TOP >> 16) >= 1
    assert (65536 - squash).min() * (TOP >> 16) >= 1
    assert ((rate > 0) & (rate < 65536)).all()
    assert (np.diff(rate) <= 0).all()
