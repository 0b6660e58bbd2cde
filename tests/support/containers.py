"""Containers of payloads that nobody decodes, their pieces, and what a reader refuses."""

from __future__ import annotations

import struct

import pytest
from forging import section

from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.container import Meta, Parameters
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.container.writer import write_container
from deltamesh_formats.errors import FormatError

HIGHPASS = Parameters(
    "highpass", True, "random", 8, 0.001, (-1.0, 0.5, 2.0), 0.25, 2**64 - 1, 200, 3
)
CARTESIAN = Parameters("cartesian", False, None, None, 0.5, (0.0, 0.0, 0.0), 0.0, 0, 0, 0)
META = Meta(0.5, 1.25, 2.0, 4.0, 8.0, 20, "deltamesh 0.1.0", "ply")
PAYLOADS = {
    "highpass": {"CONN": b"connectivity", "ANCH": b"", "DELT": bytes(range(200))},
    "cartesian": {"CONN": b"c", "CART": b"integers"},
    "lossless": {"CONN": b"c", "EXAC": b"forms"},
}
DIGEST = b"01234567"


def written(parameters=HIGHPASS, meta=META, vertices=1000, triangles=2000, **optional):
    payloads = PAYLOADS[parameters.method] | optional
    return write_container(build_container(vertices, triangles, parameters, payloads, meta, DIGEST))


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


PINNED = bytes.fromhex(
    """
    89444d530d0a1a0a 0400 0000 e807 d00f 87015235
    5041524d 34 01 00 ff ff 000000000000e03f
        0000000000000000 0000000000000000 0000000000000000
        0000000000000000 0000803f 00 00 00 00 8e7fb501
    434f4e4e 01 63 9e98c22e
    43415254 08 696e746567657273 f666a466
    6d657461 35 000000000000e03f 000000000000f43f 00000040 00008040
        0000000000002040 14
        0f 64656c74616d65736820302e312e30 03 706c79 13a6e424
    4348454b 08 3031323334353637 9774630b
    """
)


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
        "coarse": 1.0,
        "dead_zone": 0,
        "normal_dead_zone": 0,
    } | {k: v for k, v in changes.items() if k not in ("anchor_count", "isolated", "extra")}
    payload = struct.pack("<BBBBdddddfBB", *values.values())
    payload += write_varint(changes.get("anchor_count", 1)) + write_varint(
        changes.get("isolated", 0)
    )
    parts["PARM"] = section("PARM", payload + changes.get("extra", b""))
    return start + b"".join(parts.values())
