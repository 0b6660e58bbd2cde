"""Table of attributes: what is written is read, and every rule has its refusal."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from containers import CARTESIAN, PAYLOADS
from hypothesis import given
from hypothesis import strategies as st

from deltamesh_formats.container.attribute_entry import Entry
from deltamesh_formats.container.attribute_table import entries_of, read_table, write_table
from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.payload_layout import (
    MAX_LIMB_BITS,
    MAX_NORMAL_BITS,
    POLYGON_OWNERS,
    WEDGES_OF,
)
from deltamesh_formats.errors import FormatError

INTEGER = Entry(
    "id", "vertex", "other", np.dtype("i4"), 2, False, "integer", origin=(7,), bits=16, limbs=1
)
GRID = Entry(
    "uv",
    "corner",
    "uv",
    np.dtype("f4"),
    2,
    False,
    "grid",
    origin=(0.0, 1.0),
    bits=12,
    density=4096.0,
    error=1e-4,
)
EXACT = Entry("w", "face", "other", np.dtype("c16"), 1, False, "exact")
NORMAL = Entry(
    "normal", "vertex", "normal", np.dtype("f8"), 3, False, "octahedral", bits=10, error=0.2
)


def with_streams(entry: Entry) -> Entry:
    return replace(entry, sizes=tuple(range(1, entry.streams + 1)))


def payload_of(*entries: Entry) -> bytes:
    sized = tuple(map(with_streams, entries))
    return write_table(sized) + bytes(sum(entry.size for entry in sized))


entries = st.sampled_from([INTEGER, GRID, EXACT, NORMAL]).flatmap(
    lambda entry: st.builds(
        replace,
        st.just(entry),
        name=st.text(st.characters(exclude_categories=[]), max_size=5),
        normalized=st.booleans(),
        partly=st.just(True),
        first_none=st.booleans(),
        palette=st.none() if entry is NORMAL else st.none() | st.integers(1, 2**40),
    )
)


@given(st.lists(entries, min_size=1, max_size=5))
def test_tables_are_read_as_they_were_written(some: list[Entry]) -> None:
    payload = payload_of(*some)
    found, at = read_table(payload)
    assert found == tuple(map(with_streams, some))
    assert at == len(payload) - sum(entry.size for entry in found)


def test_streams_are_those_of_owners_and_of_columns() -> None:
    assert INTEGER.streams == 1
    assert replace(INTEGER, width=4, limbs=2).streams == 3  # eight columns
    assert replace(INTEGER, partly=True, palette=3).streams == 3
    assert GRID.streams == 2  # its wedges
    assert replace(GRID, wedges=POLYGON_OWNERS).streams == 1
    assert (EXACT.columns, EXACT.number_size) == (2, 8)
    assert NORMAL.columns == 3


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (replace(INTEGER, dtype=np.dtype("f4")), "type float32 with coding integer"),
        (replace(EXACT, dtype=np.dtype("u1")), "type uint8 with coding exact"),
        (replace(NORMAL, dtype=np.dtype("c8")), "type complex64 with coding octahedral"),
        (replace(INTEGER, bits=0), "1 limbs of 0 bits"),
        (replace(INTEGER, bits=MAX_LIMB_BITS + 1), "limbs of"),
        (replace(INTEGER, limbs=5), "5 limbs of 16 bits"),
        (replace(INTEGER, mixed=True), "mixed columns"),
        (replace(EXACT, width=3, mixed=True), "mixed columns with coding exact"),
        (replace(NORMAL, width=2), "octahedral coding with width 2"),
        (replace(NORMAL, palette=2), "octahedral coding with a palette"),
        (replace(NORMAL, bits=MAX_NORMAL_BITS + 1), "normals of"),
        (replace(NORMAL, error=-1.0), "error -1"),
        (replace(GRID, density=0.0), "density 0"),
        (replace(GRID, density=float("inf")), "density inf"),
        (replace(GRID, origin=(0.0, float("nan"))), "origin nan"),
        (replace(INTEGER, palette=0), "empty palette"),
        (replace(INTEGER, first_none=True), "first_none without partly"),
        (
            replace(GRID, wedges=WEDGES_OF),
            "wedges of attribute 0, which does not come",
        ),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_entries_against_the_rules_are_refused(entry: Entry, message: str) -> None:
    with pytest.raises(FormatError, match=f"attribute 0: .*{message}") as caught:
        read_table(payload_of(entry))
    assert caught.value.offset == 1


def test_wedges_are_those_of_an_attribute_before_that_has_some() -> None:
    shared = replace(GRID, wedges=WEDGES_OF)
    assert read_table(payload_of(GRID, shared))[0][1].wedges == WEDGES_OF
    for first in (INTEGER, replace(GRID, wedges=POLYGON_OWNERS)):
        with pytest.raises(FormatError, match="attribute 1: wedges of attribute 0, which has none"):
            read_table(payload_of(first, shared))


def test_every_truncation_and_other_sizes_are_refused() -> None:
    payload = payload_of(INTEGER, GRID, NORMAL)
    for data in (*(payload[:size] for size in range(len(payload))), payload + b"\0"):
        with pytest.raises(FormatError) as caught:
            read_table(data)
        assert 0 <= caught.value.offset <= len(data)


def test_a_table_of_nothing_and_unknown_codes_are_refused() -> None:
    with pytest.raises(FormatError, match="a table of 0 attributes"):
        read_table(b"\0")
    payload = bytearray(payload_of(INTEGER))
    at = 1 + 1 + len("id")
    for place, value, message in ((at, 3, "unknown domain 3"), (at + 1, 0xFF, "reserved bits")):
        damaged = payload.copy()
        damaged[place] |= value
        with pytest.raises(FormatError, match=message):
            read_table(bytes(damaged))


def test_attributes_of_a_file_are_named_without_decoding() -> None:
    parameters = replace(CARTESIAN, isolated=0)
    plain = build_container(3, 1, parameters, PAYLOADS["cartesian"], None, bytes(8))
    assert entries_of(plain) == ()
    payloads = PAYLOADS["cartesian"] | {"ATTR": payload_of(INTEGER)}
    container = build_container(3, 1, parameters, payloads, None, bytes(8))
    assert entries_of(container) == (with_streams(INTEGER),)
    damaged = build_container(3, 1, parameters, payloads | {"ATTR": b""}, None, bytes(8))
    with pytest.raises(FormatError) as caught:
        entries_of(damaged)
    assert caught.value.offset >= damaged.sections["ATTR"].offset
