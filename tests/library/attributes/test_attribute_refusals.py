"""Attributes that no encoder has written, all checksums right: refused, and at no great cost."""

from __future__ import annotations

import time
import tracemalloc
from dataclasses import replace
from itertools import compress

import attributed
import forging
import pytest
import spec_coder
import spec_decoder
from hypothesis import given
from hypothesis import strategies as st

from deltamesh import decode, verify
from deltamesh._options import Options
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh_formats.container.attribute_entry import Entry
from deltamesh_formats.container.attribute_table import read_table, write_table
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import FormatError, LimitError

FILES = {
    name: encode_mesh(mesh, Options(method=name.split("-")[0], threads=1, **options)).data
    for name, mesh, options in attributed.golden()
}
PAYLOADS = {
    name: bytes(read_container(data).sections["ATTR"].payload) for name, data in FILES.items()
}


def refused(name: str, payload: bytes) -> None:
    """Both decoders refuse the file, and the codec says where; nothing large is allocated."""
    data = forging.forged(FILES[name], ATTR=payload)
    for make in (lambda: data, lambda: forging.consistent(data)):
        start = time.perf_counter()
        tracemalloc.start()
        try:
            with pytest.raises((FormatError, LimitError)) as caught:
                decode(make())
            peak = tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()
        assert peak < 64 << 20
        assert time.perf_counter() - start < 2
    if isinstance(caught.value, FormatError):
        assert caught.value.offset is not None
    with pytest.raises((spec_coder.RefusedError, UnicodeDecodeError)):
        spec_decoder.decode(data)


def tables(name: str) -> tuple[tuple[Entry, ...], bytes]:
    entries, at = read_table(PAYLOADS[name])
    return entries, PAYLOADS[name][at:]


def changed(name: str, k: int, **fields: object) -> bytes:
    entries, streams = tables(name)
    made = replace(entries[k], **fields)
    return write_table((*entries[:k], made, *entries[k + 1 :])) + streams


ENORMOUS = 2**40

HOSTILE = {
    "width": ("cartesian-integers", 0, {"width": ENORMOUS}),
    "width of a grid": ("highpass-textured", 0, {"width": ENORMOUS}),
    "width of floats": ("lossless-numbers", 0, {"width": ENORMOUS}),
    "width of complex numbers": ("lossless-numbers", 3, {"width": 2**61}),
    "width of normals": ("cartesian-normals-area", 0, {"width": 4}),
    "sizes": ("cartesian-integers", 0, {"sizes": (ENORMOUS,) * 4}),
    "one size": ("cartesian-integers", 0, {"sizes": (2**62, 0, 0, 0)}),
    "palette": ("cartesian-colours", 1, {"palette": ENORMOUS}),
    "palette of one row less": ("cartesian-colours", 1, {"palette": 2}),
    "palette of none": ("cartesian-colours", 1, {"palette": 0}),
    "wedges of a later one": ("highpass-textured", 0, {"wedges": 3, "sizes": (1,)}),
    "wedges of itself": ("highpass-textured", 0, {"wedges": 2, "sizes": (1,)}),
    "wedges of one that shares": ("highpass-textured", 2, {"wedges": 3}),
    "wedges of an enormous number": ("highpass-textured", 2, {"wedges": ENORMOUS}),
    "wedges of a face": ("cartesian-integers", 4, {"wedges": 3, "sizes": (1, 1, 1)}),
    "limbs": ("cartesian-integers", 0, {"limbs": 255}),
    "no limbs": ("cartesian-integers", 0, {"limbs": 0}),
    "bits": ("cartesian-integers", 0, {"bits": 30}),
    "no bits": ("cartesian-integers", 0, {"bits": 0}),
    "fewer bits": ("cartesian-integers", 0, {"bits": 9}),
    "truth that is not": ("cartesian-integers", 3, {"origin": (5,)}),
    "beyond the type": ("cartesian-integers", 5, {"origin": (120,)}),
    "density": ("highpass-textured", 0, {"density": 0.0}),
    "density that is none": ("highpass-textured", 0, {"density": float("nan")}),
    "origin": ("highpass-textured", 0, {"origin": (float("inf"), 0.0)}),
    "error": ("highpass-textured", 0, {"error": -1.0}),
    "bits of normals": ("cartesian-normals-area", 0, {"bits": 31}),
    "other bits than in the stream": ("cartesian-normals-area", 0, {"bits": 10}),
    "palette of normals": ("cartesian-normals-area", 0, {"palette": 1, "sizes": (0, 5)}),
    "coding of integers": ("cartesian-integers", 5, {"coding": "exact"}),
    "coding of floats": ("lossless-numbers", 0, {"coding": "integer", "origin": (0,), "bits": 8}),
    "mixed, of two": ("highpass-textured", 0, {"mixed": True}),
    "mixed limbs": ("cartesian-integers", 0, {"mixed": True}),
    "the first of all": ("cartesian-integers", 0, {"first_none": True}),
}


# What the table alone is refused for.
FAULTS = {
    "width of normals": "attribute 0: octahedral coding with width 4",
    "palette of none": "attribute 1: empty palette",
    "wedges of a later one": "attribute 0: wedges of attribute 1, which does not come before it",
    "wedges of itself": "attribute 0: wedges of attribute 0, which does not come before it",
    "wedges of one that shares": "attribute 2: wedges of attribute 1, which has none of its own",
    "wedges of a face": "attribute 4: wedges of attribute 1, which has none of its own",
    "limbs": "attribute 0: 255 limbs of ",
    "no limbs": "attribute 0: 0 limbs of ",
    "bits": "attribute 0: . limbs of 30 bits",
    "no bits": "attribute 0: . limbs of 0 bits",
    "density": "attribute 0: density 0.0",
    "density that is none": "attribute 0: density nan",
    "origin": "attribute 0: origin inf",
    "error": "attribute 0: error -1.0",
    "bits of normals": "attribute 0: normals of 31 bits",
    "palette of normals": "attribute 0: octahedral coding with a palette",
    "coding of integers": "attribute 5: type int. with coding exact",
    "coding of floats": "attribute 0: type float.. with coding integer",
    "mixed, of two": "attribute 0: mixed columns with coding grid, width 2 and 1 limbs",
    "the first of all": "attribute 0: first_none without partly",
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_named(name: str) -> None:
    file, k, fields = HOSTILE[name]
    with pytest.raises(FormatError, match=f"^{FAULTS[name]}"):
        read_table(changed(file, k, **fields))


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_tables(name: str) -> None:
    file, k, fields = HOSTILE[name]
    refused(file, changed(file, k, **fields))


@pytest.mark.parametrize("count", [0, 2, ENORMOUS, 2**62])
def test_hostile_numbers_of_attributes(count: int) -> None:
    payload = PAYLOADS["cartesian-colours"]
    refused("cartesian-colours", write_varint(count) + payload[1:])


@pytest.mark.parametrize("at", [2**20, 2**40, 2**62])
def test_names_without_an_end(at: int) -> None:
    payload = PAYLOADS["cartesian-colours"]
    refused("cartesian-colours", payload[:1] + write_varint(at) + payload[2:])


def test_bits_that_are_reserved() -> None:
    payload = PAYLOADS["cartesian-colours"]
    at = 2 + payload[1]
    for k, byte in ((0, 3), (0, 0xE0), (0, 0xF0), (1, 0x80)):
        wrong = bytearray(payload)
        wrong[at + k] |= byte
        refused("cartesian-colours", bytes(wrong))


def test_many_empty_streams_are_no_bomb() -> None:
    """Small streams of many columns each of every vertex: the limit of memory tells."""
    entries, _ = tables("cartesian-integers")
    wide = replace(entries[5], width=3 * 10**6, sizes=(0,) * 10**6)
    data = forging.forged(FILES["cartesian-integers"], ATTR=write_table((wide,)))
    with pytest.raises(LimitError):
        decode(data, memory=1 << 28)


@pytest.mark.parametrize("name", FILES)
def test_truncations(name: str) -> None:
    """Every payload that is cut, and one that is longer."""
    payload = PAYLOADS[name]
    for size in range(0, len(payload), max(len(payload) // 40, 1)):
        with pytest.raises(FormatError):
            decode(forging.forged(FILES[name], ATTR=payload[:size]))
    for more in (b"\0", b"\1"):
        refused(name, payload + more)


@pytest.mark.parametrize("name", FILES)
def test_streams_that_lose_their_last_byte(name: str) -> None:
    """The sizes of the table fit: it is the stream that has no end."""
    entries, streams = tables(name)
    at = 0
    for k, entry in enumerate(entries):
        for i, size in enumerate(entry.sizes):
            at += size
            if size == 0:
                continue
            sizes = (*entry.sizes[:i], size - 1, *entry.sizes[i + 1 :])
            table = write_table((*entries[:k], replace(entry, sizes=sizes), *entries[k + 1 :]))
            data = forging.forged(FILES[name], ATTR=table + streams[: at - 1] + streams[at:])
            with pytest.raises(FormatError):
                decode(data)


@given(st.sampled_from(sorted(FILES)), st.integers(0, 10**6), st.integers(0, 7))
def test_flipped_bits(name: str, at: int, bit: int) -> None:
    """Refused with the digest as it was; with a right one, refused or other attributes."""
    payload = bytearray(PAYLOADS[name])
    payload[at % len(payload)] ^= 1 << bit
    data = forging.forged(FILES[name], ATTR=bytes(payload))
    try:
        mesh = decode(data, memory=1 << 30)
    except (FormatError, LimitError):
        pass
    else:
        # The digest covers integers: not the table, nor which weights normals are predicted with.
        entries, streams = tables(name)
        if at % len(payload) >= len(payload) - len(streams):
            kept = [entry.coding != "octahedral" for entry in entries]
            ours, theirs = (
                [one.dense().tobytes() for one in m.attributes] for m in (decode(FILES[name]), mesh)
            )
            assert [*compress(ours, kept)] == [*compress(theirs, kept)]
    try:
        mesh = decode(forging.consistent(data), memory=1 << 30)
    except (FormatError, LimitError):
        return
    counts = {"vertex": len(mesh.vertices), "corner": len(mesh.corners), "face": len(mesh.sizes)}
    for attribute in mesh.attributes:
        assert len(attribute.rows()) == counts[attribute.domain]


@given(st.sampled_from(sorted(FILES)), st.binary(max_size=80))
def test_any_bytes(name: str, payload: bytes) -> None:
    with pytest.raises((FormatError, LimitError)):
        decode(forging.forged(FILES[name], ATTR=payload))


@pytest.mark.parametrize("name", FILES)
def test_the_files_themselves(name: str) -> None:
    decode(FILES[name])
    verify(FILES[name])
    assert forging.consistent(FILES[name]) == FILES[name]
