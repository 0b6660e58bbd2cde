"""Rows of codes, at their owners or in a palette: both come back, and wrong counts are refused."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st
from payloads import joined

from deltamesh._attributes.owners import Owners
from deltamesh._attributes.rows import Rows, decode_rows, encode_rows
from deltamesh._graph.elements import of_vertices
from deltamesh_formats.array_types import Ints
from deltamesh_formats.container.attribute_entry import Entry
from deltamesh_formats.errors import FormatError

FACES = meshes.icosphere(2)[1]
COUNT = 162
BYTES = Entry(
    "label", "vertex", "other", np.dtype(np.uint8), 4, False, "integer", origin=(0,), bits=8
)


def owners_of(has: np.ndarray) -> Owners:
    return Owners(np.arange(COUNT), of_vertices(FACES, COUNT), has)


def few_and_many(seed: int, count: int) -> tuple[Ints, Ints]:
    """Rows of codes, and which of them each of the values has."""
    rng = np.random.default_rng(seed)
    different = int(rng.choice([1, 3, 100]))
    return rng.integers(0, 256, (different, 4)), rng.integers(0, different, count)


@strategies.SOME
@given(strategies.SMALL, st.sampled_from([0.0, 0.3, 1.0]))
def test_rows_come_back(seed: int, share: float) -> None:
    has = np.random.default_rng(seed).random(COUNT) >= share
    codes, rows = few_and_many(seed, int(has.sum()))
    owners = owners_of(has)
    entry, coded, streams = encode_rows(BYTES, codes, rows, owners)
    payload, places = joined(streams, b"table")
    found = decode_rows(payload, places, entry, owners, 5)
    assert_same(found, coded)
    np.testing.assert_array_equal(found.codes[found.labels], codes[rows])


def assert_same(one: Rows, other: Rows) -> None:
    np.testing.assert_array_equal(one.labels, other.labels)
    np.testing.assert_array_equal(one.codes, other.codes)


def palette() -> tuple[Entry, list[bytes], Owners]:
    owners = owners_of(np.ones(COUNT, dtype=bool))
    codes = np.array([[255, 0, 7, 9], [1, 2, 3, 4], [90, 80, 70, 60]])
    # Rows in an order that no neighbour tells are dearer than their numbers.
    rows = np.random.default_rng(4).integers(0, 3, COUNT)
    entry, _, streams = encode_rows(BYTES, codes, rows, owners)
    assert entry.palette == 3
    return entry, streams, owners


@pytest.mark.parametrize("count", [2, 4])
def test_a_palette_of_another_size_is_refused(count: int) -> None:
    entry, streams, owners = palette()
    payload, places = joined(streams)
    with pytest.raises(FormatError, match=f"palette of {count} rows, of which 3 are used"):
        decode_rows(payload, places, replace(entry, palette=count), owners, 0)


def test_codes_beyond_the_type_are_refused() -> None:
    owners = owners_of(np.ones(COUNT, dtype=bool))
    nine = replace(BYTES, bits=9)
    _, _, streams = encode_rows(nine, np.full((1, 4), 300), np.zeros(COUNT, np.int64), owners)
    entry, _, _ = encode_rows(nine, np.full((1, 4), 300), np.zeros(COUNT, np.int64), owners)
    payload, places = joined(streams)
    with pytest.raises(FormatError):
        decode_rows(payload, places, replace(entry, bits=8), owners, 0)


def test_owners_take_the_rows_of_their_elements() -> None:
    elements = of_vertices(np.zeros((0, 3), dtype=np.int64), 3)
    owners = Owners(np.array([2, 0, 0, 1]), elements, np.ones(3, dtype=bool))
    assert owners.rows(np.array([5, 6, 6, 7])).tolist() == [6, 7, 5]
