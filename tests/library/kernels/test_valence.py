"""Numbers below a bound, against their twin, and bits that only one number takes."""

from __future__ import annotations

import oracle
import pytest
from coders import slow_coder
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.coding.models import Model
from deltamesh._kernels.coding.valence import code_below
from deltamesh._streams import entropy

MODEL = Model(1, ((1, 255),))
pairs = st.integers(1, 2**40).flatmap(lambda n: st.tuples(st.integers(0, n - 1), st.just(n)))


@given(st.lists(pairs, max_size=20))
def test_numbers_below_a_bound_equal_their_oracle(cases: list[tuple[int, int]]) -> None:
    coder, twin = entropy.encoder(len(cases), *MODEL), slow_coder(None, *MODEL)
    for value, bound in cases:
        assert code_below(coder, value, bound) == value
        oracle.code_below(twin, value, bound)
    data = entropy.finish(coder)
    assert data == twin.finish()
    decoder, twin = entropy.decoder(data, *MODEL), slow_coder(data, *MODEL)
    for value, bound in cases:
        assert code_below(decoder, 0, bound) == oracle.code_below(twin, 0, bound) == value


@pytest.mark.parametrize("bound", [1, 2, 3, 5, 8, 100])
def test_any_bytes_are_numbers_below_the_bound(bound: int) -> None:
    found = set()
    for first in range(256):
        decoder = entropy.decoder(bytes([first, 0xA5]), *MODEL)
        found.add(int(code_below(decoder, 0, bound)))
    assert found == set(range(bound))
