"""Coding of the geometry, in section PARM: what comes back, and what is refused."""

from __future__ import annotations

import pytest
from containers import CARTESIAN, HIGHPASS, pieces, refused, with_parameters, written
from forging import section
from spec_tables import spec_offset

from deltamesh_formats.container.parameters import (
    parameter_faults,
    read_parameters,
    write_parameters,
)
from deltamesh_formats.container.reader import read_container


@pytest.mark.parametrize("parameters", [HIGHPASS, CARTESIAN], ids=lambda p: p.method)
def test_parameters_come_back(parameters):
    assert not [*parameter_faults(parameters, 1000)]
    assert read_parameters(write_parameters(parameters), 1000) == parameters
    assert parameters.solution == (None if parameters is CARTESIAN else "least-squares")


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
