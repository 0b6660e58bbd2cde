"""Sections of a file: their places, ids and order, and what is refused."""

from __future__ import annotations

import pytest
from containers import HIGHPASS, pieces, refused, written
from forging import section

from deltamesh_formats.container.fields import take, write_varint
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.container.sections import (
    end_of_section,
    id_at,
    laid_out,
    payload_of,
    write_section,
)
from deltamesh_formats.errors import FormatError


def test_sections_follow_each_other():
    sections = laid_out({"CONN": bytes(200), "abcd": b"", "meta": b"xyz"}, 17)
    data = bytes(17) + b"".join(map(write_section, sections.values()))
    ends = [17]
    for one in sections.values():
        assert one.offset == ends[-1]
        assert id_at(data, one.offset) == one.id
        assert end_of_section(data, one.offset) == one.end
        assert data[one.offset : one.end] == section(one.id, one.payload)
        assert end_of_section(data[: one.end - 1], one.offset) is None
        ends.append(one.end)
    assert ends[-1] == len(data)
    assert id_at(data, len(data)) == id_at(data + b"CHE", len(data)) == ""


def test_faults_in_a_payload_are_at_their_place_in_the_file():
    one = laid_out({"CONN": b"abc"}, 100)["CONN"]
    with payload_of(one) as payload:
        assert payload == b"abc"
    with pytest.raises(FormatError, match="CONN: truncated") as caught, payload_of(one) as payload:
        take(payload, 2, 5)
    assert caught.value.offset == 100 + 4 + 1 + 3


def test_a_section_longer_than_the_file():
    start, parts = pieces(written())
    huge = b"CONN" + write_varint(2**63 - 1)
    refused(start + parts["PARM"] + huge + bytes(20), "truncated: section CONN at byte .* 16 are")


@pytest.mark.parametrize(
    ("order", "message"),
    [
        ("CONN ANCH DELT meta CHEK", "PARM is missing"),
        ("PARM ANCH DELT meta CHEK", "CONN is missing"),
        ("PARM CONN DELT CHEK", "ANCH is missing"),
        ("PARM CONN ANCH meta CHEK", "DELT is missing"),
        ("PARM CHEK", "CONN is missing"),
        ("CHEK", "PARM is missing"),
        ("PARM CONN ANCH DELT meta", "truncated: section CHEK is missing"),
        ("", "truncated: section CHEK is missing"),
        ("PARM ANCH CONN DELT CHEK", "CONN is missing, ANCH is in its place"),
        ("PARM CONN ANCH DELT CART CHEK", "CART has no place here in a highpass file"),
        ("PARM CONN ANCH DELT abcd meta CHEK", "meta has no place"),
        ("meta PARM CONN ANCH DELT CHEK", "PARM is missing"),
        ("PARM CONN CONN ANCH DELT CHEK", "CONN comes a second time"),
        ("PARM CONN ANCH DELT meta meta CHEK", "meta comes a second time"),
        ("PARM CONN ANCH DELT CHEK meta", "bytes follow the last section"),
        ("PARM CONN COPY STCH ANCH DELT CHEK", "STCH is missing, COPY is in its place"),
        ("PARM STCH CONN ANCH DELT CHEK", "CONN is missing, STCH is in its place"),
        ("PARM CONN ANCH DELT STCH CHEK", "STCH is missing, ANCH is in its place"),
        ("PARM CONN ANCH DELT WXYZ CHEK", "WXYZ is unknown: it needs a newer deltamesh"),
    ],
)
def test_sections_out_of_order(order, message):
    start, parts = pieces(written())
    parts |= {name: section(name, b"?") for name in ("CART", "STCH", "COPY", "abcd", "WXYZ")}
    refused(start + b"".join(parts[name] for name in order.split()), message)


def test_unknown_optional_sections_are_skipped():
    container = read_container(written(abcd=b"x", eFGH=b""))
    assert list(container.sections)[-4:] == ["meta", "abcd", "eFGH", "CHEK"]
    assert container.parameters == HIGHPASS


@pytest.mark.parametrize("name", [b"AB1D", b"\0\0\0\0", b"AB D", "é".encode() * 2])
def test_ids_are_letters(name):
    start, parts = pieces(written())
    assert refused(start + parts["PARM"] + name + bytes(10), "cannot be called") == len(
        start + parts["PARM"]
    )


def test_too_many_sections():
    ids = [f"x{chr(97 + i % 26)}{chr(97 + i // 26)}z" for i in range(61)]
    start, parts = pieces(written(meta=None))
    check = parts.pop("CHEK")
    body = start + b"".join(parts.values())
    full = body + b"".join(section(i, b"") for i in ids[:59]) + check
    assert len(read_container(full).sections) == 64
    refused(body + b"".join(section(i, b"") for i in ids) + check, "more than 64 sections")
    with pytest.raises(ValueError, match="64 sections"):
        written(meta=None, **dict.fromkeys(ids, b""))
