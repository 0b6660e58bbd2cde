"""Floats of attributes to the last bit: any bits of any type, and streams that are refused."""

from __future__ import annotations

import meshes
import numpy as np
import pytest
import strategies
from attributed import odd
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps
from numpy.typing import NDArray
from payloads import joined

from deltamesh._graph.elements import of_vertices
from deltamesh._streams.exact import DOUBLE, SINGLE, encode_numbers, pack_formats
from deltamesh._streams.floats import bits_of, decode_floats, encode_floats, from_bits
from deltamesh._streams.number_formats import RAW_ONLY
from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import FormatError

TYPES = ("f2", "f4", "f8", "c8", "c16")
SPHERE = of_vertices(meshes.icosphere(1)[1], 42)


def encoded(bits: Ints, size: int) -> list[bytes]:
    """Streams of any bits, as the encoder of attributes makes them: NaNs and all."""
    with np.errstate(over="ignore", invalid="ignore"):
        return encode_floats(SPHERE, bits, size)


@given(st.data(), st.sampled_from(TYPES))
def test_bits_lead_back_to_the_numbers(data: st.DataObject, kind: str) -> None:
    dtype = np.dtype(kind)
    raw = data.draw(nps.arrays(np.uint8, (3, 2 * dtype.itemsize)))
    values: NDArray[np.generic] = raw.view(dtype)
    bits = bits_of(values)
    assert bits.dtype == np.int64
    assert from_bits(bits, dtype).tobytes() == values.tobytes()
    size = dtype.itemsize // (2 if dtype.kind == "c" else 1)
    assert size == 8 or ((bits >= 0) & (bits < 1 << 8 * size)).all()


@strategies.FEW
@given(st.sampled_from([2, 4, 8]), st.integers(0, 4), strategies.SMALL)
def test_any_bits_come_back(size: int, width: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    wild = rng.integers(-(2**63), 2**63 - 1, (42, width))
    tidy = rng.normal(size=(42, width)).round(2).astype(f"f{size}")
    bits = np.where(rng.random((42, width)) < 0.3, wild, bits_of(tidy))
    bits = bits_of(from_bits(bits, np.dtype(f"f{size}")))
    payload, places = joined(encoded(bits, size), b"?")
    np.testing.assert_array_equal(decode_floats(payload, places, SPHERE, width, size), bits)


@pytest.mark.parametrize("kind", ["f2", "f4", "f8"])
def test_zeros_infinities_and_every_nan_come_back(kind: str) -> None:
    bits = bits_of(odd(kind, 42, 3))
    payload, places = joined(encoded(bits, int(kind[1])))
    np.testing.assert_array_equal(decode_floats(payload, places, SPHERE, 3, int(kind[1])), bits)


def test_doubles_that_are_singles_cost_half() -> None:
    noise = np.random.default_rng(4).normal(size=(42, 3)).astype(np.float32)
    single = noise.astype(np.float64)
    double = single + 1e-9
    sizes = [len(encoded(bits_of(V), 8)[0]) for V in (single, double)]
    assert sizes[0] < 0.6 * sizes[1]


def raw_stream(width: int, bits: Ints) -> bytes:
    """A stream of raw numbers of a width in bits."""
    columns, raw = [RAW_ONLY] * 3, np.full(bits.shape, 2)
    return pack_formats(width, columns) + encode_numbers(
        SPHERE, width, columns, raw, bits, np.zeros_like(bits)
    )


def refused(stream: bytes, size: int, message: str) -> None:
    payload, places = joined([stream], b"before it")
    with pytest.raises(FormatError, match=message) as caught:
        decode_floats(payload, places, SPHERE, 3, size)
    assert places[0][0] <= caught.value.offset <= places[0][1]


def test_numbers_beyond_their_type_are_refused() -> None:
    large = np.full((42, 3), 1 << 16)
    assert decode_floats(*joined([raw_stream(SINGLE, large)]), SPHERE, 3, 4)[0, 0] == 1 << 16
    refused(raw_stream(SINGLE, large), 2, "raw value exceeds 16 bits")
    refused(raw_stream(DOUBLE, large), 4, "64-bit numbers in an attribute of 32 bits")
    ones = encode_floats(SPHERE, bits_of(np.full((42, 3), 1 + 2.0**-20, np.float32)), 4)
    refused(ones[0], 2, "not representable in 16 bits")


def test_every_truncation_is_refused_or_other_bits() -> None:
    """Bytes that are not there count as zeros, which may well be other numbers."""
    bits = bits_of(np.random.default_rng(1).normal(size=(42, 3)).astype(np.float32).round(1))
    (whole,) = encoded(bits, 4)
    refusals = 0
    for size in range(len(whole)):
        try:
            found = decode_floats(*joined([whole[:size]]), SPHERE, 3, 4)
        except FormatError:
            refusals += 1
        else:
            assert (found != bits).any()
    assert refusals > len(whole) // 4
