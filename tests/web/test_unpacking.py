"""Decompression in JavaScript of what zlib and Zstandard have made, whole and damaged."""

from __future__ import annotations

import base64
import json
import zlib
from pathlib import Path

import children
import numpy as np
import pytest
from places import ROOT

from deltamesh_formats.zstd_frames import ZstdError, frame, framed

SCRIPT = Path(__file__).parent / "unpack_all.mjs"


def samples() -> list[bytes]:
    """Texts, noise, runs, long matches, and what lies between."""
    generator = np.random.default_rng(3)
    words = [b"wheel", b"door_left", b"door_right", b"roof", b"\xc3\xa4", b"0.5 0.25 1"]
    picked = [words[k] for k in generator.integers(len(words), size=4000)]
    noise = generator.bytes(3000)
    skewed = bytes(generator.geometric(0.2, size=20000).clip(0, 255).astype(np.uint8))
    long = (ROOT / "formats" / "SPEC.md").read_bytes()
    floats = generator.normal(size=2000).astype("<f4").tobytes()
    return [
        b"a" * 40,
        b"a" * 300_000,
        b"\n".join(picked),
        noise * 3,
        skewed,
        long,
        long[::-1] + long,
        floats + bytes(5000) + floats,
        bytes(range(256)) * 40,
    ]


def deflated(data: bytes, level: int) -> bytes:
    compressor = zlib.compressobj(level, zlib.DEFLATED, -15)
    return compressor.compress(data) + compressor.flush()


def unpacked(node: str, cases: list[tuple[str, bytes, int]]) -> list[bytes | str]:
    """Return what JavaScript makes of cases: bytes, or the name of an error."""
    lines = (json.dumps((form, base64.b64encode(data).decode(), n)) for form, data, n in cases)
    done = children.run([node, str(SCRIPT)], given="\n".join(lines).encode(), text=True)
    assert done.stderr == ""
    found = done.stdout.splitlines()
    assert len(found) == len(cases)
    return [base64.b64decode(one[1:]) if one.startswith("=") else one for one in found]


def test_streams_of_every_level_unpack(node: str) -> None:
    cases, expected = [], []
    for data in samples():
        n = len(data)
        cases += [("deflate", deflated(data, level), n) for level in (0, 1, 6, 9)]
        cases += [("zstandard", frame(data, level), n) for level in (-5, 1, 3, 9, 19, 22)]
        expected += [data] * 10
    found = unpacked(node, cases)
    for one, data, case in zip(found, expected, cases, strict=True):
        assert one == data, (case[0], case[2], one if isinstance(one, str) else len(one))


def test_another_size_is_refused(node: str) -> None:
    cases = []
    for data in samples():
        cases += [("deflate", deflated(data, 9), len(data) + k) for k in (-1, 1)]
        cases.append(("deflate", deflated(data, 9) + b"x", len(data)))
        cases += [("zstandard", frame(data), len(data) + k) for k in (-1, 1)]
        cases.append(("zstandard", frame(data) + b"x", len(data)))
    assert set(unpacked(node, cases)) == {"RangeError"}


def by_python(form: str, data: bytes, size: int) -> bytes | None:
    try:
        if form == "zstandard":
            return framed(data, size)
        inflater = zlib.decompressobj(-15)
        result = inflater.decompress(data, size)
        more = inflater.decompress(inflater.unconsumed_tail, 1)
        whole = inflater.eof and not inflater.unused_data and not more and len(result) == size
        return result if whole else None
    except (ZstdError, zlib.error):
        return None


@pytest.mark.parametrize("form", ["deflate", "zstandard"])
def test_damaged_streams_are_refused_or_as_python_has_them(node: str, form: str) -> None:
    generator = np.random.default_rng(11)
    cases = []
    for data in samples()[2:8]:
        packed = bytearray(deflated(data[:9000], 9) if form == "deflate" else frame(data[:9000]))
        for _ in range(60):
            damaged = packed.copy()
            for _ in range(generator.integers(1, 4)):
                damaged[generator.integers(len(damaged))] = generator.integers(256)
            cases.append((form, bytes(damaged[: generator.integers(1, len(damaged) + 1)]), 9000))
    found = unpacked(node, cases)
    for case, one in zip(cases, found, strict=True):
        known = by_python(*case)
        assert one == ("RangeError" if known is None else known)
