"""Choice of number formats: the shortest that holds the values."""

from __future__ import annotations

import numpy as np
import pytest

from deltamesh._streams.decomposition import BINARY_DIGITS
from deltamesh._streams.format_choice import choose_formats
from deltamesh._streams.number_formats import NumberFormat, to_indices


@pytest.mark.parametrize(
    ("values", "single", "base", "places", "digits"),
    [
        ([0.25, -3.5, 17.75], False, 2, 2, 7),
        ([0.1, 0.25, -3.14], False, 10, 2, 3),
        ([0.001234, 0.1234, 12.34], False, 10, 6, 4),
        ([np.float32(0.13), np.float32(-3.14)], True, 10, 2, 3),
        ([-8.0, 1024.0, 24.0], False, 2, -3, 2),
        ([1e-7, 2e-7, 1.0], False, 10, 7, 1),
    ],
)
def test_the_shortest_form_is_found(
    values: list[float], single: bool, base: int, places: int, digits: int
) -> None:
    V = np.tile(np.array(values, dtype=np.float64), 100)
    _, how = choose_formats(V, np.abs(V), single)
    assert how.formats == (NumberFormat(base, places, digits),)
    assert not how.raw


def test_random_bits_have_the_form_of_their_type() -> None:
    rng = np.random.default_rng(3)
    V = rng.random(1000)
    assert choose_formats(V, V, False)[1].formats[0].digits == BINARY_DIGITS
    single = V.astype(np.float32).astype(np.float64)
    assert {form.digits for form in choose_formats(single, V, True)[1].formats} == {24}


def test_a_few_other_numbers_are_raw() -> None:
    V = np.random.default_rng(4).random(10000).round(4)
    V[77:80] = 1 / 3, 1e-20, 1e100
    _, how = choose_formats(V, V, False)
    assert how.formats == (NumberFormat(10, 4, 4),)
    assert how.raw
    assert np.flatnonzero(to_indices(V, how, False)[0]).tolist() == [77, 78, 79]
