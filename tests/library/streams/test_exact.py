"""Number formats at the beginning of a stream, and indices in these formats."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._graph.elements import of_vertices
from deltamesh._streams.exact import (
    DOUBLE,
    SINGLE,
    decode_indices,
    encode_indices,
    pack_formats,
    parallelogram_errors,
    unpack_formats,
)
from deltamesh._streams.number_formats import RAW_ONLY, ColumnFormats, NumberFormat
from deltamesh_formats.errors import FormatError

DECIMAL = ColumnFormats((NumberFormat(10, 3, 5),), (4,), 3, raw=True, zeros=False)
BINARY = ColumnFormats(
    (NumberFormat(2, 20, 24), NumberFormat(2, -4, 53)), (0, 60), 20, raw=False, zeros=True
)
COLUMNS = [DECIMAL, BINARY, RAW_ONLY]


@pytest.mark.parametrize("width", [SINGLE, DOUBLE])
def test_formats_are_unpacked_as_they_were_packed(width: int) -> None:
    data = pack_formats(width, COLUMNS)
    assert unpack_formats(memoryview(data + b"stream")) == (width, COLUMNS, len(data))


def test_formats_that_are_cut_short_are_refused() -> None:
    data = pack_formats(DOUBLE, COLUMNS)
    for size in range(len(data)):
        with pytest.raises(FormatError, match="truncated: number formats") as caught:
            unpack_formats(memoryview(data[:size]))
        assert caught.value.offset == size


@pytest.mark.parametrize(
    ("how", "message"),
    [
        (replace(RAW_ONLY, raw=False), "0 number formats in a column"),
        (replace(DECIMAL, formats=(NumberFormat(3, 3, 5),)), "invalid number format: base 3"),
        (replace(DECIMAL, formats=(NumberFormat(10, 23, 5),), grid=23), "23 places"),
        (replace(DECIMAL, formats=(NumberFormat(10, 3, 0),)), "0 digits"),
        (replace(DECIMAL, grid=2), "invalid number format"),
        (replace(DECIMAL, usual=(61,)), "invalid number format"),
        (replace(BINARY, formats=(*BINARY.formats[:1], *DECIMAL.formats)), "base 10"),
        (replace(DECIMAL, formats=DECIMAL.formats * 3, usual=(0,) * 3), "3 number formats"),
    ],
)
def test_formats_that_are_none_are_refused(how: ColumnFormats, message: str) -> None:
    data = pack_formats(DOUBLE, [RAW_ONLY, how, RAW_ONLY])
    with pytest.raises(FormatError, match=message) as caught:
        unpack_formats(memoryview(data))
    # The column at fault, behind the width and a column without formats.
    assert caught.value.offset == len(pack_formats(DOUBLE, [RAW_ONLY]))


def test_other_widths_and_reserved_bits_are_refused() -> None:
    data = bytearray(pack_formats(DOUBLE, COLUMNS))
    data[0] = 16
    with pytest.raises(FormatError, match="numbers of 16 bits"):
        unpack_formats(memoryview(data))
    data[0] = DOUBLE
    data[1] |= 0x80
    with pytest.raises(FormatError, match="reserved bits are set"):
        unpack_formats(memoryview(data))


@strategies.FEW
@given(strategies.SMALL, st.sampled_from([SINGLE, DOUBLE]))
def test_indices_come_back(seed: int, width: int) -> None:
    sphere = of_vertices(meshes.icosphere(1)[1], 42)
    rng = np.random.default_rng(seed)
    choices = np.stack([2 * rng.integers(0, 2, 42), rng.integers(0, 2, 42), np.full(42, 2)], axis=1)
    indices = rng.integers(-99, 100, (42, 3))
    indices[choices == 2] = rng.integers(0, 1 << 31, (42, 3))[choices == 2]
    data = encode_indices(sphere, width, COLUMNS, choices, indices)
    found = decode_indices(memoryview(b"at" + data), 2, sphere, width, COLUMNS)
    for decoded, given_values in zip(found, (choices, indices), strict=True):
        np.testing.assert_array_equal(decoded, given_values)
    with pytest.raises(FormatError):
        decode_indices(memoryview(b"at" + data + b"?"), 2, sphere, width, COLUMNS)


def test_the_error_of_a_parallelogram_is_its_distance_from_the_vertex() -> None:
    elements = of_vertices(np.array([[0, 1, 2], [1, 0, 3]]), 4)
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, -1, 0.25]])
    assert parallelogram_errors(V, elements).tolist() == [[0, 0, 0.25]]
