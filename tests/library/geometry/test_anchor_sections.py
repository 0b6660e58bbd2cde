"""Payloads of the methods with anchors, those that no encoder has written among them."""

from __future__ import annotations

import numpy as np
import pytest
from coders import integers_of
from hypothesis import given
from hypothesis import strategies as st
from payloads import SURFACE, read_or_refused, section_of

from deltamesh._geometry.anchor_sections import decode, encode
from deltamesh._geometry.integers import NO_POINTS, Integers
from deltamesh_formats.container.container import Parameters
from deltamesh_formats.errors import FormatError


def highpass_parameters(**changes):
    fields = {
        "method": "highpass",
        "diffusion": True,
        "anchor_method": "greedy",
        "bits": None,
        "step": 0.01,
        "origin": (0.0, 0.0, 0.0),
        "anchor_step": 0.001,
        "seed": 0,
        "anchor_count": 5,
        "isolated": 3,
    }
    return Parameters(**(fields | changes))


@given(st.binary(max_size=200), st.sampled_from(["greedy", "farthest", "random"]))
def test_random_anchors(payload: bytes, method: str) -> None:
    parameters = highpass_parameters(anchor_method=method, bits=0, step=0.0)
    integers = read_or_refused(decode, parameters, ANCH=payload, DELT=b"")
    if integers is not None:
        assert integers.anchors.shape == (5,)
        assert ((integers.anchors >= 0) & (integers.anchors < 42)).all()
        assert ((integers.positions >= 0) & (integers.positions < 2**30)).all()
        assert integers.isolated.shape == (3, 3)
        assert ((integers.isolated >= 0) & (integers.isolated < 2**30)).all()
        assert (np.diff(integers.isolated[:, 0]) >= 0).all()


@given(st.binary(max_size=300))
def test_random_deltas(payload: bytes) -> None:
    anchors = _written_anchors()
    integers = read_or_refused(decode, highpass_parameters(), ANCH=anchors, DELT=payload)
    if integers is not None:
        assert integers.values.shape == (42, 3)
        assert np.abs(integers.values).max() < 2**31


@given(st.binary(max_size=300))
def test_random_corrections(payload: bytes) -> None:
    payloads = {"ANCH": _written_anchors(), "DELT": b"", "FIXS": payload}
    integers = read_or_refused(decode, highpass_parameters(), **payloads)
    if integers is not None:
        assert integers.corrections.shape == (42, 3)
        assert np.abs(integers.corrections).max() < 2**31


def _written_anchors():
    grid = np.arange(15).reshape(5, 3)
    integers = Integers(NO_POINTS, np.arange(5) * 8, grid, grid[:3])
    return encode(SURFACE, highpass_parameters(bits=0, step=0.0), integers)["ANCH"]


def test_a_grid_of_too_many_bits_is_refused() -> None:
    parameters = highpass_parameters(bits=0, step=0.0)
    for at in range(3):
        bits = bytes(31 if i == at else 5 for i in range(3))
        payloads = {"ANCH": section_of("ANCH", bits), "DELT": section_of("DELT", b"")}
        with pytest.raises(FormatError, match="bits") as caught:
            decode(SURFACE, parameters, payloads)
        assert caught.value.offset == 50 + 5 + at


@pytest.mark.parametrize("size", [0, 1, 2])
def test_anchors_without_their_grid_are_refused(size: int) -> None:
    parameters = highpass_parameters(bits=0, step=0.0)
    assert read_or_refused(decode, parameters, ANCH=bytes(size), DELT=b"") is None


def test_deltas_of_zero_bits_are_refused() -> None:
    parameters = highpass_parameters(bits=0, step=0.0)
    assert read_or_refused(decode, parameters, ANCH=_written_anchors(), DELT=b"") is not None
    assert read_or_refused(decode, parameters, ANCH=_written_anchors(), DELT=b"\1") is None


def test_corrections_round_trip() -> None:
    values, fixes = integers_of(42, 1), integers_of(42, 2)
    fixes[np.random.default_rng(3).random(42) < 0.8] = 0
    grid = np.arange(15).reshape(5, 3)
    integers = Integers(values, np.arange(5) * 8, grid, grid[:3], corrections=fixes)
    payloads = encode(SURFACE, highpass_parameters(), integers)
    assert list(payloads) == ["ANCH", "DELT", "FIXS"]
    read = read_or_refused(decode, highpass_parameters(), **payloads)
    assert read is not None
    np.testing.assert_array_equal(read.corrections, fixes)
    np.testing.assert_array_equal(read.values, values)


def test_corrections_of_zero_bits_are_refused() -> None:
    parameters = highpass_parameters(bits=0, step=0.0)
    payloads = {"ANCH": _written_anchors(), "DELT": b"", "FIXS": b""}
    assert read_or_refused(decode, parameters, **payloads) is None
