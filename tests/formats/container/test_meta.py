"""Errors and names in section meta: what comes back, and what is refused."""

from __future__ import annotations

import math
import struct
from dataclasses import replace

import pytest
from containers import (
    META,
    pieces,
    refused,
    written,
)
from forging import section

from deltamesh_formats.container.meta import meta_faults, read_meta, write_meta


@pytest.mark.parametrize(
    "changes",
    [{}, {"lost": 3}, {"parts": 2, "part": "body", "part_normal": 0.5, "part_rms": 1e-5}],
    ids=str,
)
def test_meta_comes_back(changes):
    meta = replace(META, **changes)
    assert not [*meta_faults(meta)]
    assert read_meta(write_meta(meta)) == meta
    assert meta.has_losses == bool(changes)
    assert meta.room == meta.diagonal * 2.0**-meta.margin


# Numbers and names of a `meta` that goes on with two parts.
PARTS = bytes(33) + b"\0\0\0\0\2"


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        (struct.pack("<ddffd", 1, 1, 1, 1, float("nan")) + b"\0\0\0", "diagonal is nan"),
        (struct.pack("<ddffd", -1, 1, 1, 1, 1) + b"\0\0\0", "rms is -1"),
        (bytes(33) + b"\1\x1b\0", "control characters"),
        (bytes(33) + b"\1\xff\0", "not UTF-8"),
        (bytes(33) + b"\0\1", "truncated"),
        (bytes(33) + b"\0\0\1", "meta: truncated"),
        (bytes(33) + b"\0\0\1\2\1\0", "meta: 1 bytes follow the last field"),
        (bytes(33) + b"\0\0\0\0\1", "no faces are lost or turned, and there is one part"),
        (bytes(33) + b"\0\0\1\0\0", "0 parts"),
        (bytes(33) + b"\0\0\0\0\2", "meta: truncated"),
        (PARTS + struct.pack("<fd", -1, 1) + b"\0", "part_normal is -1"),
        (PARTS + struct.pack("<fd", 1, math.inf) + b"\0", "part_rms is inf"),
        (PARTS + struct.pack("<fd", 1, 1) + b"\1\n", "the part name holds control characters"),
        (PARTS + struct.pack("<fd", 1, 1) + b"\1n\0", "meta: 1 bytes follow the last field"),
    ],
)
def test_meta_out_of_range(payload, message):
    start, parts = pieces(written())
    parts["meta"] = section("meta", payload)
    refused(start + b"".join(parts.values()), message)
