"""Fields of byte tables: numbers, strings and checksums, both ways, and what is refused."""

from __future__ import annotations

import pytest

from deltamesh_formats.container.fields import (
    STRING_MAX_BYTES,
    Field,
    check_crc,
    read_fields,
    read_table,
    read_varint,
    struct_of,
    with_crc,
    write_fields,
    write_varint,
)
from deltamesh_formats.errors import FormatError, MeshError

# One list for both directions.
VARINTS = [
    (0, b"\x00"),
    (1, b"\x01"),
    (127, b"\x7f"),
    (128, b"\x80\x01"),
    (300, b"\xac\x02"),
    (2**40, b"\x80\x80\x80\x80\x80\x20"),
    (2**63 - 1, b"\xff" * 8 + b"\x7f"),
]


@pytest.mark.parametrize(("value", "data"), VARINTS)
def test_varint(value, data):
    assert write_varint(value) == data
    assert read_varint(b"?" + data + b"?", 1) == (value, 1 + len(data))


@pytest.mark.parametrize("value", [-1, 2**63])
def test_varint_out_of_range(value):
    with pytest.raises(ValueError, match="range of a varint"):
        write_varint(value)


@pytest.mark.parametrize(
    ("data", "offset"),
    [
        (b"", 0),
        (b"\x80", 1),
        (b"\xff" * 8, 8),
        (b"\x80\x00", 0),
        (b"\xff\x80\x00", 0),
        (b"\xff" * 9, 0),
        (b"\xff" * 9 + b"\x01", 0),
    ],
)
def test_malformed_varints_are_refused(data, offset):
    with pytest.raises(FormatError) as caught:
        read_varint(data, 0)
    assert caught.value.offset == offset


def test_fields_come_back_with_their_offsets():
    table = (Field("a", "varint"), Field("b", "string"), Field("c", "i16"), Field("d", "f32"))
    values = {"a": 300, "b": "bé", "c": -2, "d": 0.5}
    data = b"??" + write_fields(table, values) + b"?"
    assert read_fields(data, 2, table) == (values, {"a": 2, "b": 4, "c": 8, "d": 10}, 14)
    assert read_table(data[2:-1], table) == (values, {"a": 0, "b": 2, "c": 6, "d": 8})
    with pytest.raises(FormatError, match="1 bytes follow the last field"):
        read_table(data[2:], table)
    for size in range(2, 14):
        with pytest.raises(FormatError, match="truncated") as caught:
            read_fields(data[:size], 2, table)
        assert caught.value.offset == size


def test_a_table_of_fixed_size_is_one_struct():
    table = (Field("a", "u8"), Field("b", "u64"), Field("c", "f64"))
    packed = struct_of(table).pack(1, 2, 3.0)
    assert packed == write_fields(table, {"a": 1, "b": 2, "c": 3.0})
    assert len(packed) == 17


@pytest.mark.parametrize(
    ("kind", "value"),
    [("u8", 256), ("i16", 1.5), ("f32", 1e39), ("varint", -1), ("string", "x" * 256)],
)
def test_values_that_no_field_holds_are_refused(kind, value):
    with pytest.raises(MeshError, match="the file cannot hold size = "):
        write_fields((Field("size", kind),), {"size": value})


def test_strings_are_utf_8():
    text = "é" * (STRING_MAX_BYTES // 2)
    table = (Field("name", "string"),)
    assert read_table(write_fields(table, {"name": text}), table)[0] == {"name": text}
    with pytest.raises(FormatError, match="not UTF-8") as caught:
        read_table(b"\3a\xffb", table)
    assert caught.value.offset == 2


def test_a_checksum_is_that_of_all_before_it():
    data = with_crc(b"123456789")
    assert data[-4:] == bytes.fromhex("2639f4cb")
    check_crc(memoryview(b"?" + data), 1, 10, "it")
    for i in range(len(data)):
        damaged = bytearray(b"?" + data)
        damaged[1 + i] ^= 4
        with pytest.raises(FormatError, match="it is damaged: its checksum does not match"):
            check_crc(memoryview(damaged), 1, 10, "it")
