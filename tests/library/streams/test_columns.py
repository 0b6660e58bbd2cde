"""Columns of integers at elements, three to a stream, and back."""

from __future__ import annotations

import meshes
import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps
from payloads import joined

from deltamesh._graph.elements import alone, of_vertices
from deltamesh._kernels.coding.parallelogram import BOUND
from deltamesh._streams.columns import (
    decode_columns,
    decode_three,
    encode_columns,
    encode_three,
    join_columns,
    split_columns,
)
from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import FormatError

SPHERE = of_vertices(meshes.icosphere(1)[1], 42)
tables = nps.arrays(np.int64, st.tuples(st.integers(0, 6), st.integers(0, 8)))


@given(tables)
def test_columns_are_joined_as_they_were(columns: Ints) -> None:
    count, width = columns.shape
    threes = split_columns(columns)
    assert len(threes) == -(-width // 3)
    assert {three.shape for three in threes} <= {(count, 3)}
    np.testing.assert_array_equal(join_columns(threes, 0, count, width), columns)


def test_padding_that_is_not_zero_is_refused() -> None:
    threes = [np.zeros((4, 3), dtype=np.int64), np.zeros((4, 3), dtype=np.int64)]
    threes[1][2, 2] = 1
    assert join_columns(threes, 77, 4, 6).shape == (4, 6)
    with pytest.raises(FormatError, match="padding") as caught:
        join_columns(threes, 77, 4, 5)
    assert caught.value.offset == 77


@strategies.FEW
@given(st.integers(0, 7), st.sampled_from([1, 300, 2**29]), strategies.SMALL)
def test_columns_come_back(width: int, most: int, seed: int) -> None:
    columns = np.random.default_rng(seed).integers(-most, most + 1, (42, width))
    kept = columns.copy()
    payload, places = joined(encode_columns(SPHERE, columns), b"before")
    np.testing.assert_array_equal(columns, kept)
    np.testing.assert_array_equal(decode_columns(payload, places, SPHERE, width), columns)


def test_columns_that_go_on_cost_next_to_nothing() -> None:
    columns = np.repeat(np.arange(9000)[:, None], 3, axis=1)
    assert len(encode_three(alone(9000), columns)) < 100


@given(st.binary(max_size=60))
def test_any_bytes_are_columns_or_refused(data: bytes) -> None:
    offset = None
    try:
        found = decode_three(data, SPHERE, 1000)
    except FormatError as error:
        offset = error.offset
    if offset is None:
        assert np.abs(found).max() <= BOUND
    else:
        assert 1000 <= offset <= 1000 + len(data)
