"""Sequences of different numbers, against their twin."""

from __future__ import annotations

import numpy as np
import oracle
import pytest
from coders import slow_coder
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.coding import choices
from deltamesh._streams import entropy

sequences = st.integers(1, 12).flatmap(
    lambda total: st.tuples(
        st.lists(st.integers(0, total - 1), unique=True, max_size=total), st.just(total)
    )
)


def encoded(numbers: list[int], total: int) -> bytes:
    coder = entropy.encoder(total, choices.SLOTS, choices.MIXERS)
    assert choices.code_choices(coder, np.array(numbers, dtype=np.int64), total)
    return entropy.finish(coder)


@given(sequences)
def test_choices_equal_their_oracle_both_ways(case: tuple[list[int], int]) -> None:
    numbers, total = case
    twin = slow_coder(None, choices.SLOTS, choices.MIXERS)
    assert oracle.code_choices(twin, numbers, total) == numbers
    data = encoded(numbers, total)
    assert data == twin.finish()
    decoder = entropy.decoder(data, choices.SLOTS, choices.MIXERS)
    out = np.zeros(len(numbers), dtype=np.int64)
    assert choices.code_choices(decoder, out, total)
    assert out.tolist() == numbers
    entropy.check_end(decoder, 0)


@given(st.binary(max_size=20), st.sampled_from([0x00, 0x55, 0xFF]), st.integers(1, 12), st.data())
def test_any_bytes_are_the_choices_of_the_oracle(
    data: bytes, filler: int, total: int, draw: st.DataObject
) -> None:
    data += bytes([filler]) * 20
    count = draw.draw(st.integers(0, total))
    decoder, twin = entropy.decoder(data, *choices.MODEL), slow_coder(data, *choices.MODEL)
    out = np.zeros(count, dtype=np.int64)
    good = choices.code_choices(decoder, out, total)
    expected = oracle.code_choices(twin, [0] * count, total)
    assert good == (expected is not None)
    if expected is not None:
        assert out.tolist() == expected
        assert decoder.registers.code == twin.code


@pytest.mark.parametrize("total", [1, 2, 5, 1000])
def test_numbers_in_their_order_cost_nothing(total: int) -> None:
    assert encoded(list(range(total)), total) == b""
