"""Number formats at the beginning of a stream, and indices in these formats."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._graph.elements import Elements, of_vertices
from deltamesh._kernels.coding.exact import RAW
from deltamesh._streams.conversions import ADD, DIVIDE, MULTIPLY, Conversion, Operation
from deltamesh._streams.exact import (
    DOUBLE,
    SINGLE,
    decode_numbers,
    encode_numbers,
    pack_formats,
    parallelogram_errors,
    unpack_formats,
)
from deltamesh._streams.number_formats import RAW_ONLY, ColumnFormats, NumberFormat
from deltamesh._streams.vectors import encode_vectors
from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import FormatError

DECIMAL = ColumnFormats((NumberFormat(10, 3, 5),), (4,), 3, raw=True, zeros=False)
BINARY = ColumnFormats(
    (NumberFormat(2, 20, 24), NumberFormat(2, -4, 53)), (0, 60), 20, raw=False, zeros=True
)
COLUMNS = [DECIMAL, BINARY, RAW_ONLY]
INCHES = replace(
    DECIMAL,
    conversion=Conversion((Operation(MULTIPLY, 25.4),), double=False, deviations=True),
)
CENTRED = replace(
    DECIMAL,
    conversion=Conversion(
        (Operation(DIVIDE, 40.0), Operation(ADD, -1.5)), double=False, deviations=False
    ),
)


def with_conversion(*operations: tuple[int, float], double: bool = False) -> ColumnFormats:
    conversion = Conversion(tuple(Operation(*one) for one in operations), double, deviations=False)
    return replace(DECIMAL, conversion=conversion)


@pytest.mark.parametrize("width", [SINGLE, DOUBLE])
@pytest.mark.parametrize("columns", [COLUMNS, [INCHES, CENTRED, BINARY]])
def test_formats_are_unpacked_as_they_were_packed(width: int, columns: list[ColumnFormats]) -> None:
    data = pack_formats(width, columns)
    assert unpack_formats(memoryview(data + b"stream")) == (width, columns, len(data))


def test_formats_that_are_cut_short_are_refused() -> None:
    data = pack_formats(DOUBLE, [INCHES, CENTRED, BINARY])
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
        (with_conversion((ADD, 1.0), (ADD, 1.0), (ADD, 1.0)), "3 operations in a column"),
        (with_conversion((3, 1.0)), "invalid operator: 3"),
        (with_conversion((ADD, 1.0), double=True), "a conversion in binary64 that is none"),
        *(
            (with_conversion((MULTIPLY, 2.0), (DIVIDE, bad)), "invalid operand")
            for bad in (0.0, -0.0, np.nan, np.inf, -np.inf, 1e151, -5e-324, 2.0**-1023)
        ),
    ],
)
def test_formats_that_are_none_are_refused(how: ColumnFormats, message: str) -> None:
    data = pack_formats(DOUBLE, [RAW_ONLY, how, RAW_ONLY])
    with pytest.raises(FormatError, match=message) as caught:
        unpack_formats(memoryview(data))
    # The column at fault, behind the width and a column without formats.
    assert caught.value.offset == len(pack_formats(DOUBLE, [RAW_ONLY]))


def test_other_widths_are_refused() -> None:
    data = bytearray(pack_formats(DOUBLE, COLUMNS))
    data[0] = 16
    with pytest.raises(FormatError, match="numbers of 16 bits"):
        unpack_formats(memoryview(data))


@strategies.FEW
@given(strategies.SMALL, st.sampled_from([SINGLE, DOUBLE]))
def test_indices_come_back(seed: int, width: int) -> None:
    sphere = of_vertices(meshes.icosphere(1)[1], 42)
    rng = np.random.default_rng(seed)
    choices = np.stack([2 * rng.integers(0, 2, 42), rng.integers(0, 2, 42), np.full(42, 2)], axis=1)
    indices = rng.integers(-99, 100, (42, 3))
    indices[choices == 2] = rng.integers(0, 1 << 31, (42, 3))[choices == 2]
    none = np.zeros_like(indices)
    data = encode_numbers(sphere, width, COLUMNS, choices, indices, none)
    found = decode_numbers(memoryview(b"at" + data), 2, sphere, width, COLUMNS)
    for decoded, given_values in zip(found, (choices, indices, none), strict=True):
        np.testing.assert_array_equal(decoded, given_values)
    try:  # a byte more may be read where zeros were before: the numbers are others then
        others = decode_numbers(memoryview(b"at" + data + b"?"), 2, sphere, width, COLUMNS)
    except FormatError:
        return
    assert any((a != b).any() for a, b in zip(found, others, strict=True))


def with_deviations() -> tuple[bytes, Elements, Ints]:
    sphere = of_vertices(meshes.icosphere(1)[1], 42)
    rng = np.random.default_rng(3)
    choices = np.stack([2 * rng.integers(0, 2, 42), np.zeros(42, int), np.full(42, 2)], axis=1)
    deviations = rng.integers(-9, 9, (42, 3)) * [1, 0, 0]
    deviations[choices == RAW] = 0
    deviations[choices[:, 0].argmin(), 0] = 2**31 - 1
    columns = [INCHES, CENTRED, RAW_ONLY]
    numbers = choices, rng.integers(0, 99, (42, 3)), deviations
    data = encode_numbers(sphere, SINGLE, columns, *numbers)
    found = decode_numbers(memoryview(data), 0, sphere, SINGLE, columns)
    for decoded, encoded in zip(found, numbers, strict=True):
        np.testing.assert_array_equal(decoded, encoded)
    return data, sphere, deviations


def test_deviations_come_back_and_are_refused_where_there_are_none() -> None:
    data, sphere, deviations = with_deviations()
    size = int.from_bytes(data[:4], "little")
    assert data[4 + size :] == encode_vectors(sphere.indptr, sphere.indices, deviations)
    wrong = deviations.copy()
    for place in ((5, 1), (5, 2)):
        wrong[place] = 1
        other = encode_vectors(sphere.indptr, sphere.indices, wrong)
        forged = memoryview(data[: 4 + size] + other)
        with pytest.raises(FormatError, match="deviation of a number that has none") as caught:
            decode_numbers(forged, 0, sphere, SINGLE, [INCHES, CENTRED, RAW_ONLY])
        assert caught.value.offset == 4 + size
        wrong[place] = 0


def test_a_stream_of_numbers_that_is_too_long_is_refused() -> None:
    data, sphere, _ = with_deviations()
    for forged in (b"\xff\xff\xff\xff" + data[4:], data[:3], data[:9]):
        with pytest.raises(FormatError, match="truncated") as caught:
            decode_numbers(memoryview(forged), 0, sphere, SINGLE, [INCHES, CENTRED, RAW_ONLY])
        assert caught.value.offset == len(forged)


def test_the_error_of_a_parallelogram_is_its_distance_from_the_vertex() -> None:
    elements = of_vertices(np.array([[0, 1, 2], [1, 0, 3]]), 4)
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, -1, 0.25]])
    assert parallelogram_errors(V, elements).tolist() == [[0, 0, 0.25]]
