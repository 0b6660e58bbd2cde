"""The container: reader and writer as mirrors, and everything that must be refused."""

from __future__ import annotations

import struct
import zlib
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from spec_tables import spec_offset

from deltamesh_formats.container import layout
from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.container import Meta, Parameters
from deltamesh_formats.container.reader import read_container, read_varint
from deltamesh_formats.container.writer import write_container, write_varint
from deltamesh_formats.errors import FormatError, MeshError, located

HIGHPASS = Parameters(
    "highpass", True, "farthest", 8, 0.001, (-1.0, 0.5, 2.0), 0.25, 2**64 - 1, 200, 3
)
CARTESIAN = Parameters("cartesian", False, None, None, 0.5, (0.0, 0.0, 0.0), 0.0, 0, 0, 0)
META = Meta(0.5, 1.25, 2.0, 4.0, 8.0, "deltamesh 0.1.0", "ply")
PAYLOADS = {
    "highpass": {"CONN": b"connectivity", "ANCH": b"", "DELT": bytes(range(200))},
    "cartesian": {"CONN": b"c", "CART": b"integers"},
    "lossless": {"CONN": b"c", "EXAC": b"forms"},
}
DIGEST = b"01234567"


def written(parameters=HIGHPASS, meta=META, vertices=1000, triangles=2000, **optional):
    payloads = PAYLOADS[parameters.method] | optional
    return write_container(build_container(vertices, triangles, parameters, payloads, meta, DIGEST))


def section(name, payload):
    raw = name.encode("ascii") + write_varint(len(payload)) + payload
    return raw + struct.pack("<I", zlib.crc32(raw))


def header(vertices=1000, triangles=2000, version=layout.VERSION, reserved=0):
    counts = write_varint(vertices) + write_varint(triangles)
    raw = layout.MAGIC + struct.pack("<HH", version, reserved) + counts
    return raw + struct.pack("<I", zlib.crc32(raw))


def pieces(data):
    """Cut a valid file into its header and its sections, by id."""
    sections = read_container(data).sections.values()
    start = next(iter(sections)).offset
    return data[:start], {s.id: data[s.offset : s.offset + s.size] for s in sections}


def refused(data, message=None):
    with pytest.raises(FormatError, match=message) as caught:
        read_container(data)
    assert caught.value.offset is not None
    assert 0 <= caught.value.offset <= len(data)
    return caught.value.offset


@pytest.mark.parametrize("parameters", [HIGHPASS, CARTESIAN], ids=lambda p: p.method)
@pytest.mark.parametrize("meta", [META, None], ids=["meta", "bare"])
def test_reader_mirrors_writer(parameters, meta):
    data = written(parameters, meta)
    container = read_container(data)
    assert (container.vertices, container.triangles) == (1000, 2000)
    assert (container.version, container.digest, container.size) == (
        layout.VERSION,
        DIGEST,
        len(data),
    )
    assert (container.parameters, container.meta) == (parameters, meta)
    for name, payload in PAYLOADS[parameters.method].items():
        assert container.sections[name].payload == payload
    start = next(iter(container.sections.values())).offset
    assert start + sum(s.size for s in container.sections.values()) == len(data)
    assert written(parameters, meta) == data


def test_payloads_are_views_of_any_buffer():
    data = written()
    container = read_container(memoryview(bytearray(data)))
    assert isinstance(container.sections["DELT"].payload, memoryview)
    assert container == read_container(data)


def test_offsets_count_from_where_the_bytes_are():
    for inner, outer in ((None, 40), (0, 40), (7, 47)):
        with pytest.raises(FormatError) as caught, located(40, "ATTR: "):
            raise FormatError("empty palette", inner)
        assert (caught.value.reason, caught.value.offset) == ("ATTR: empty palette", outer)
        assert str(caught.value) == f"ATTR: empty palette (at byte {outer})"
    with pytest.raises(FormatError) as caught, located(100), located(20, "a: "), located(3):
        raise FormatError("fault", 1)
    assert (caught.value.reason, caught.value.offset) == ("a: fault", 124)
    with pytest.raises(MeshError, match=r"^no faces$"), located(40):
        raise MeshError("no faces")


PINNED = bytes.fromhex(
    """
    89444d530d0a1a0a 0200 0000 e807 d00f 00083df3
    5041524d 3c 01 00 ff ff 000000000000e03f
        0000000000000000 0000000000000000 0000000000000000
        0000000000000000 0000000000000000 0000803f 00 00 00 00 38cae788
    434f4e4e 01 63 9e98c22e
    43415254 08 696e746567657273 f666a466
    6d657461 34 000000000000e03f 000000000000f43f 00000040 00008040
        0000000000002040
        0f 64656c74616d65736820302e312e30 03 706c79 1cd4908b
    4348454b 08 3031323334353637 9774630b
    """
)


def test_bytes_are_pinned():
    """A change of these bytes is a change of the format."""
    assert written(CARTESIAN) == PINNED
    assert read_container(PINNED).parameters == CARTESIAN


finite = st.floats(allow_nan=False, allow_infinity=False)
positive = st.floats(min_value=5e-324, allow_infinity=False)
not_negative = st.floats(min_value=0, allow_infinity=False)
single = st.floats(min_value=0, allow_infinity=False, width=32)
names = st.text(max_size=60).filter(lambda s: s.isprintable() and len(s.encode()) <= 255)
metas = st.builds(Meta, not_negative, not_negative, single, single, not_negative, names, names)
origins = st.tuples(finite, finite, finite)
seeds = st.integers(0, 2**64 - 1)


@st.composite
def containers(draw):
    vertices, triangles = draw(st.integers(0, 2**40)), draw(st.integers(0, 2**40))
    method, counts = draw(st.sampled_from(list(layout.METHODS))), st.integers(0, vertices)
    bits = draw(st.none() | st.integers(0, layout.MAX_BITS))
    anchored, lossless = method in ("highpass", "refined"), method == "lossless"
    bits = None if lossless else bits
    hundredths = st.integers(0, 255).map(lambda n: n / 100)
    parameters = Parameters(
        method,
        draw(st.booleans()),
        draw(st.sampled_from(["farthest", "random", "greedy"])) if anchored else None,
        bits,
        0.0 if lossless or (method == "highpass" and bits == 0) else draw(positive),
        (0.0, 0.0, 0.0) if lossless else draw(origins),
        draw(not_negative) if anchored else 0.0,
        draw(seeds),
        draw(counts) if anchored else 0,
        draw(counts),
        draw(st.floats(1, 2**100, width=32)) if method == "refined" else 1.0,
        draw(hundredths),
        draw(hundredths),
        draw(st.booleans()),
    )
    further = layout.METHODS[method].further
    needed = draw(st.sets(st.sampled_from((*layout.AFTER_CONNECTIVITY, *further))))
    required = layout.required(method, needed)[1:]
    payloads = {name: draw(st.binary(max_size=300)) for name in required}
    ids = st.from_regex(r"[a-z][A-Za-z]{3}", fullmatch=True).filter(lambda i: i != "meta")
    payloads |= draw(st.dictionaries(ids, st.binary(max_size=20), max_size=3))
    return (
        vertices,
        triangles,
        parameters,
        payloads,
        draw(st.none() | metas),
        draw(st.binary(min_size=8, max_size=8)),
    )


@settings(deadline=None)
@given(containers())
def test_any_container_comes_back(arguments):
    vertices, triangles, parameters, payloads, meta, digest = arguments
    container = build_container(*arguments)
    data = write_container(container)
    assert read_container(data) == container
    assert list(read_container(data).sections) == list(container.sections)
    assert len(data) == container.size
    assert (container.vertices, container.triangles) == (vertices, triangles)
    assert (container.parameters, container.meta) == (parameters, meta)
    assert container.digest == digest
    assert {i: s.payload for i, s in container.sections.items() if i in payloads} == payloads
    assert list(container.sections)[-1] == "CHEK"


def test_a_container_has_the_numbers_that_its_file_has():
    """Those of binary32 and of hundredths are rounded when it is built, not when it is read."""
    parameters = replace(HIGHPASS, method="refined", coarse=8.1, dead_zone=0.123)
    payloads = PAYLOADS["highpass"] | {"NORM": b""}
    meta = replace(META, normal=0.1)
    container = build_container(1000, 2000, parameters, payloads, meta, DIGEST)
    assert container.parameters.coarse == float(np.float32(8.1)) != 8.1
    assert container.parameters.dead_zone == 0.12
    assert container.meta == replace(meta, normal=float(np.float32(0.1)))
    assert read_container(write_container(container)) == container


def test_a_file_that_is_read_is_written_as_it_was():
    """Unused bits, too, which no field of a container has."""
    for data in (with_parameters(flags=0xFF), written(abcd=b"x"), PINNED):
        assert write_container(read_container(data)) == data


def test_sections_know_their_place():
    data = written(CARTESIAN, CONN=bytes(200), CART=bytes(20_000))
    for one in read_container(data).sections.values():
        assert data[one.offset : one.offset + 4].decode() == one.id
        assert data[one.start : one.start + len(one.payload)] == one.payload
        assert one.end == one.offset + one.size == one.start + len(one.payload) + 4


@settings(deadline=None)
@given(st.binary(max_size=100), st.booleans())
def test_arbitrary_bytes_are_refused(data, with_magic):
    with pytest.raises(FormatError):
        read_container(layout.MAGIC + data if with_magic else data)


@settings(deadline=None)
@given(st.binary(max_size=60), st.sampled_from(["PARM", "meta", "CHEK"]))
def test_arbitrary_payloads_are_read_or_refused(payload, name):
    """Behind valid checksums: whatever is read can be written, byte for byte."""
    start, parts = pieces(written())
    data = start + b"".join(section(i, payload) if i == name else p for i, p in parts.items())
    try:
        found = read_container(data)
    except FormatError:
        return
    payloads = {i: bytes(found.sections[i].payload) for i in PAYLOADS["highpass"]}
    again = build_container(
        found.vertices, found.triangles, found.parameters, payloads, found.meta, found.digest
    )
    # The flags have unused bits, which are ignored and not kept.
    assert again.size == len(data)
    assert write_container(found) == data


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


@pytest.mark.parametrize("value", [-1, 2**63])
def test_varint_out_of_range(value):
    with pytest.raises(ValueError, match="range of a varint"):
        write_varint(value)


@pytest.mark.parametrize("parameters", [HIGHPASS, CARTESIAN], ids=lambda p: p.method)
def test_every_truncation_is_refused(parameters):
    data = written(parameters, abcd=b"unknown")
    for size in range(1, len(data)):
        assert refused(data[:size], "truncated") == size


@pytest.mark.parametrize("extra", [b"\0", b"\x89", written()], ids=["zero", "byte", "file"])
def test_appended_bytes_are_refused(extra):
    data = written()
    assert refused(data + extra, f"{len(extra)} bytes follow") == len(data)


def test_every_bit_flip_is_refused():
    data = written(abcd=b"unknown")
    for i in range(8 * len(data)):
        flipped = bytearray(data)
        flipped[i // 8] ^= 1 << i % 8
        refused(flipped)


def test_empty_input():
    assert refused(b"", "empty") == 0


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"\r\n", b"\n"),
        (b"\n", b"\r\n"),
        (b"\n", b"\r"),
        (b"\x89", b"\x09"),
        (b"\x89", b"\xc2\x89"),
        (b"\x89", b"\xef\xbf\xbd"),
    ],
)
def test_text_transfer_is_recognized(old, new):
    refused(written().replace(old, new), "as text")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"ply\nformat ascii 1.0\n", r"a mesh file \(PLY\)"),
        (b"glTF\2\0\0\0", r"a mesh file \(GLB\)"),
        (b"OFF\n8 6 12\n", r"a mesh file \(OFF\)"),
        (b"solid cube\n", r"a mesh file \(STL\)"),
        (b"\x89PNG\r\n\x1a\n" + bytes(50), "not a .dmesh file"),
        (b"v", "not a .dmesh file"),
    ],
)
def test_other_files_are_named(data, message):
    assert refused(data, message) == 0


def test_versions_and_reserved_bits():
    rest = b"".join(pieces(written())[1].values())
    assert read_container(header() + rest)
    assert refused(header(version=3) + b"anything", "version 3 needs a newer deltamesh") == 8
    assert refused(header(version=0) + rest, "no container version 0") == 8
    for bit in range(16):
        assert refused(header(reserved=1 << bit) + rest, "reserved .* newer deltamesh") == 10


def test_huge_counts_are_refused():
    rest = b"".join(pieces(written())[1].values())
    assert read_container(header(2**40, 2**40) + rest)
    assert refused(header(2**40 + 1, 0) + rest, "vertices, more than") == 12
    assert refused(header(0, 2**63 - 1) + rest, "triangles, more than") == 13
    crafted = header()[:12] + b"\x80\x00" + bytes(6)
    assert refused(crafted + rest, "longer than it needs") == 12


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


def with_parameters(**changes):
    """Return a file whose PARM has fields replaced behind the writer's back."""
    start, parts = pieces(written())
    values = {
        "method": 0,
        "flags": 1,
        "anchor_method": 0,
        "bits": 8,
        "step": 0.001,
        "origin_x": 0.0,
        "origin_y": 0.0,
        "origin_z": 0.0,
        "anchor_step": 0.25,
        "seed": 0,
        "coarse": 1.0,
        "dead_zone": 0,
        "normal_dead_zone": 0,
    } | {k: v for k, v in changes.items() if k not in ("anchor_count", "isolated", "extra")}
    payload = struct.pack("<BBBBdddddQfBB", *values.values())
    payload += write_varint(changes.get("anchor_count", 1)) + write_varint(
        changes.get("isolated", 0)
    )
    parts["PARM"] = section("PARM", payload + changes.get("extra", b""))
    return start + b"".join(parts.values())


@pytest.mark.parametrize(
    ("changes", "field", "message"),
    [
        ({"method": 4}, "method", "method 4 is unknown"),
        ({"method": 3}, "anchor_method", "method lossless with anchor method farthest"),
        ({"method": 3, "bits": 8, "anchor_method": 255}, "bits", "8 bits in a lossless file"),
        ({"method": 3, "bits": 255, "anchor_method": 255}, "step", "step of 0.001"),
        ({"method": 1}, "anchor_method", "method cartesian with anchor method farthest"),
        ({"anchor_method": 3}, "anchor_method", "anchor method 3 is unknown"),
        ({"anchor_method": 255}, "anchor_method", "method highpass with anchor method none"),
        ({"bits": 63}, "bits", "63 bits"),
        ({"step": float("nan")}, "step", "step of nan"),
        ({"step": float("inf")}, "step", "step of inf"),
        ({"step": -1.0}, "step", "step of -1"),
        ({"step": 0.0}, "step", "step of 0"),
        ({"bits": 0}, "step", "step of 0.001"),
        ({"origin_y": float("nan")}, "origin_y", "origin of nan"),
        ({"anchor_step": float("-inf")}, "anchor_step", "anchor step of -inf"),
        ({"coarse": 2.0}, "coarse", "method highpass with deltas 2.0 times as coarse"),
        ({"coarse": float("nan")}, "coarse", "method highpass with deltas nan times as coarse"),
        ({"method": 2, "coarse": 0.5}, "coarse", "method refined with deltas 0.5 times as coarse"),
        ({"anchor_count": 1001}, "anchor_count", "1001 anchor vertices among 1000"),
        ({"isolated": 2**63 - 1}, "isolated", "isolated vertices among 1000"),
        ({"extra": b"\0"}, None, "PARM: 1 bytes follow the last field"),
    ],
)
def test_parameters_out_of_range(changes, field, message):
    data = with_parameters(**changes)
    offset = refused(data, message)
    if field in changes and field != "isolated":
        read = read_container(written()).sections["PARM"]
        assert offset == read.offset + 5 + spec_offset("4.1", field)


def test_unused_flags_are_ignored():
    assert read_container(with_parameters(flags=0xFF)).parameters.diffusion
    assert not read_container(with_parameters(flags=0xFE)).parameters.diffusion
    for flags, single in ((0xFF, True), (0xFD, False), (2, True), (0, False)):
        assert read_container(with_parameters(flags=flags)).parameters.single is single


@pytest.mark.parametrize("cut", range(1, 20))
def test_a_short_parameter_payload(cut):
    start, parts = pieces(written())
    payload = bytes(read_container(written()).sections["PARM"].payload)
    parts["PARM"] = section("PARM", payload[:-cut])
    refused(start + b"".join(parts.values()), "truncated")


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        (struct.pack("<ddffd", 1, 1, 1, 1, float("nan")) + b"\0\0", "diagonal is nan"),
        (struct.pack("<ddffd", -1, 1, 1, 1, 1) + b"\0\0", "rms is -1"),
        (bytes(32) + b"\1\x1b\0", "control characters"),
        (bytes(32) + b"\1\xff\0", "not UTF-8"),
        (bytes(32) + b"\0\1", "truncated"),
        (bytes(32) + b"\0\0\0", "meta: 1 bytes follow the last field"),
    ],
)
def test_meta_out_of_range(payload, message):
    start, parts = pieces(written())
    parts["meta"] = section("meta", payload)
    refused(start + b"".join(parts.values()), message)


def test_the_digest_has_its_size():
    start, parts = pieces(written())
    for payload, message in (
        (b"1234567", "truncated"),
        (b"123456789", "CHEK: 1 bytes follow the last field"),
    ):
        parts["CHEK"] = section("CHEK", payload)
        refused(start + b"".join(parts.values()), message)


@pytest.mark.parametrize(
    "arguments",
    [
        {"parameters": replace(HIGHPASS, step=float("inf"))},
        {"parameters": replace(HIGHPASS, bits=0)},
        {"parameters": replace(HIGHPASS, seed=2**64)},
        {"parameters": replace(HIGHPASS, anchor_count=1001)},
        {"parameters": replace(CARTESIAN, anchor_method="random")},
        {"parameters": replace(CARTESIAN, anchor_count=1)},
        {"meta": replace(META, dihedral=1e39)},
        {"meta": replace(META, normal=float("nan"))},
        {"meta": replace(META, encoder="x" * 256)},
        {"meta": replace(META, source="a\nb")},
        {"vertices": 2**40 + 1},
        {"triangles": -1},
    ],
    ids=str,
)
def test_the_writer_refuses_what_the_reader_would(arguments):
    with pytest.raises(MeshError):
        written(**arguments)


@pytest.mark.parametrize(
    ("payloads", "digest"),
    [
        ({"CONN": b""}, DIGEST),
        (PAYLOADS["cartesian"], DIGEST),
        (PAYLOADS["highpass"] | {"meta": b""}, DIGEST),
        (PAYLOADS["highpass"] | {"WXYZ": b""}, DIGEST),
        (PAYLOADS["highpass"] | {"ab1d": b""}, DIGEST),
        (PAYLOADS["highpass"], b"short"),
    ],
)
def test_wrong_payloads_are_a_mistake_of_the_caller(payloads, digest):
    with pytest.raises(ValueError, match=r"payloads|optional|digest"):
        build_container(
            10, 10, replace(HIGHPASS, anchor_count=1, isolated=0), payloads, None, digest
        )
