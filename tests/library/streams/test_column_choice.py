"""Conversions of single columns, and no stream that is larger for one."""

from __future__ import annotations

import meshes
import numpy as np
import pytest
from converted_numbers import KINDS, as_single, walk

from deltamesh._graph.elements import Elements, of_vertices
from deltamesh._kernels.coding.exact import RAW
from deltamesh._streams import column_choice
from deltamesh._streams.column_choice import choose_columns, numbers_of
from deltamesh._streams.exact import DOUBLE, SINGLE, encode_numbers, pack_formats
from deltamesh._streams.number_formats import ColumnFormats, from_indices, raw_bits

V, F = meshes.icosphere(3)
ELEMENTS: Elements = of_vertices(F, len(V))
DECIMALS = (100 * V + np.stack([walk(len(V), i) for i in range(3)], axis=1) / 50).round(2)


def size(columns: list[ColumnFormats], X: np.ndarray, single: bool) -> int:
    width, usable = SINGLE if single else DOUBLE, np.ones(X.shape, dtype=bool)
    numbers = numbers_of(X, usable, raw_bits(X, single), columns, single)
    return len(pack_formats(width, columns) + encode_numbers(ELEMENTS, width, columns, *numbers))


def chosen(X: np.ndarray, single: bool, usable: np.ndarray | None = None) -> list[ColumnFormats]:
    usable = np.ones(X.shape, dtype=bool) if usable is None else usable
    return choose_columns(ELEMENTS, X, usable, raw_bits(X, single), single)


def test_each_column_has_a_conversion_of_its_own() -> None:
    inches = as_single(25.4 * DECIMALS[:, 0])
    X = np.stack([inches, np.full(len(V), as_single(0.1)), as_single(V[:, 2])], axis=1)
    columns = chosen(X, single=True)
    assert [bool(column.conversion.operations) for column in columns] == [True, False, False]


@pytest.mark.parametrize("kind", KINDS)
def test_no_stream_is_larger_for_a_conversion(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    single, function = KINDS[kind]
    decimals = as_single(DECIMALS) if single else DECIMALS
    X = np.stack([function(column) for column in decimals.T], axis=1)
    found = size(chosen(X, single), X, single)
    with monkeypatch.context() as patch:
        patch.setattr(
            column_choice, "choose_conversion", lambda *arguments: (arguments[3], arguments[4])
        )
        assert found < size(chosen(X, single), X, single)


def test_the_smaller_stream_is_taken_where_estimates_are_near(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """An estimate that is wrong does not make a file larger."""
    noise = as_single(V + np.random.default_rng(1).normal(size=V.shape) / 100)
    inches = as_single(25.4 * DECIMALS)
    wrong = chosen(inches, single=True)[0]
    plain = chosen(noise, single=True)
    assert not any(column.conversion.operations for column in plain)

    def cheap(*arguments: object) -> tuple[float, ColumnFormats]:
        cost = arguments[3]
        assert isinstance(cost, float)
        return 0.9 * cost, ColumnFormats(
            wrong.formats, wrong.usual, wrong.grid, True, False, wrong.conversion
        )

    monkeypatch.setattr(column_choice, "choose_conversion", cheap)
    assert chosen(noise, single=True) == plain


def test_what_is_in_no_format_is_raw_and_has_no_deviation() -> None:
    X = as_single(25.4 * DECIMALS)
    usable = np.ones(X.shape, dtype=bool)
    usable[::9] = False
    X[~usable] = np.nan
    raw = raw_bits(X, single=True)
    columns = chosen(X, True, usable)
    assert all(column.raw and column.conversion.operations for column in columns)
    choices, indices, deviations = numbers_of(X, usable, raw, columns, single=True)
    assert ((choices == RAW) == ~usable).all()
    assert not deviations[~usable].any()
    for a, column in enumerate(columns):
        known = choices[:, a], indices[:, a], deviations[:, a]
        np.testing.assert_array_equal(from_indices(*known, column, single=True), X[:, a])
