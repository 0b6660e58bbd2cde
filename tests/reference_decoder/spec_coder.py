"""§1 and §5.1 of `formats/SPEC.md`, to be read beside it: what the second decoder reads with."""

from __future__ import annotations

import math
import struct
import zlib


class RefusedError(ValueError):
    """The specification does not allow the file."""


def check(holds, what):
    if not holds:
        raise RefusedError(what)


def clamp(x, low, high):
    return min(max(x, low), high)


class Bytes:
    """A cursor over bytes."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def unpack(self, code):
        start, self.at = self.at, self.at + struct.calcsize("<" + code)
        check(self.at <= len(self.data), "truncated")
        return struct.unpack_from("<" + code, self.data, start)

    def varint(self):
        value = 0
        for i in range(9):
            (byte,) = self.unpack("B")
            value |= (byte & 127) << 7 * i
            if byte < 128:
                check(byte or i == 0, "a varint that is not canonical")
                return value
        raise RefusedError("a varint of more than nine bytes")

    def crc(self, start):
        crc = zlib.crc32(self.data[start : self.at])
        check(self.unpack("I") == (crc,), "crc")


# ---- §5.1: entropy coder --------------------------------------------------------------------

STRETCH = [round(256 * math.log((x + 0.5) / (4095.5 - x))) for x in range(4096)]
SQUASH = [clamp(round(65536 / (1 + math.exp(-x / 256))), 24, 65512) for x in range(-2048, 2048)]
RATE = [math.floor(65536 / (n + 1.8)) for n in range(1024)]


def slot(i, x, a=0):
    """The number of a slot: at(i, x), on axis a."""
    h = ((4 * i + a) * 0x9E3779B1 + x % (1 << 31) * 0x85EBCA6B) % (1 << 32)
    h = (h ^ h >> 15) * 0x2C1B3C6D % (1 << 32)
    return (h ^ h >> 13) % (1 << 20)


class Stream:
    """The range decoder; slots are [q, n], mixers [weights, number of bits so far]."""

    def __init__(self, data):
        self.data, self.at = data, 4
        self.range, self.low = (1 << 32) - 1, 0
        self.code = int.from_bytes(data[:4].ljust(4, b"\0"), "big")
        self.slots, self.mixers = {}, {}

    def bit(self, p):
        bound = (self.range >> 16) * p
        bit = int(self.code < bound)
        if bit:
            self.range = bound
        else:
            self.range -= bound
            self.code -= bound
            self.low += bound
        while self.range < 1 << 24:
            byte = self.data[self.at] if self.at < len(self.data) else 0
            self.at += 1
            self.range *= 256
            self.code = self.code * 256 + byte
            self.low = self.low * 256 % (1 << 32)
        return bit

    def end(self):
        """A stream has one form only."""
        low = self.low % (1 << 32)
        v = -low % (1 << 32)  # what is missing to a multiple of 2^32, else of 2^24
        check(self.code == (v if v < self.range else -low % (1 << 24)), "end of a stream")
        check(self.at >= len(self.data) and self.data[-1:] != b"\0", "bytes left in a stream")

    def raw(self, n):
        value = 0
        for _ in range(n):
            value = 2 * value + self.bit(32768)
        return value

    def predicted(self, mixer, keys, limit, first=(1 << 21, 0)):
        """A bit, read with a mixer and a slot for each of its inputs; all of them learn."""
        k = len(keys)
        start = 65536 if k == 1 else round(65536 * 1.2 / k)
        weights, seen = self.mixers.get(mixer, ([start] * k, 0))
        slots = [self.slots.setdefault(key, [*first]) for key in keys]
        s = [STRETCH[slot[0] >> 10] for slot in slots]
        dot = sum(weight * x for weight, x in zip(weights, s, strict=True))
        p = SQUASH[clamp(dot >> 16, -2047, 2047) + 2048]
        bit = self.bit(p)
        z = 14 if seen < 300 else 15
        weights = [
            weight + ((x * (65536 * bit - p) + (1 << z - 1)) >> z)
            for weight, x in zip(weights, s, strict=True)
        ]
        self.mixers[mixer] = weights, seen + 1
        for slot in slots:  # one that is several inputs learns as often
            slot[0] += (((bit << 22) - slot[0]) * RATE[slot[1]]) >> 16
            slot[1] = min(slot[1] + 1, limit)
        return bit

    def number(self, mixer, kind, most=40):
        k = 0
        while k < most and self.predicted(mixer, [(kind, k)], 255):
            k += 1
        return 1 << k | self.raw(k)

    def index(self, n):
        """One of n, as of the live nodes."""
        b = n.bit_length() - 1
        u = (1 << b + 1) - n
        i = self.raw(b)
        return i if i < u else 2 * i + self.raw(1) - u

    def tree(self, mixer, kind, n):
        node = 1
        for _ in range(n):
            node = 2 * node + self.predicted(mixer, [(kind, node)], 255)
        return node - (1 << n)

    def signed(self, a, X, Y, candidates=()):  # noqa: N803
        """A signed number on axis a; a candidate is (W, H)."""

        def at(i, x):
            return slot(i, x, a)

        sizes = [abs(w).bit_length() for w, _ in candidates]
        l = 0  # noqa: E741
        while l <= 30:
            keys = [(at(i, x) + l) % (1 << 20) for i, x in enumerate(X)]
            for i, (size, (_, h)) in enumerate(zip(sizes, candidates, strict=True)):
                s = 0 if size < l else 1 if size == l else 2
                keys.append(at(8 + i, 32 * (3 * h + s) + l))
            if not self.predicted((a, "length", l), keys, 255):
                break
            l += 1  # noqa: E741
        if l == 0:
            return 0
        keys = [at(16 + i, y) for i, y in enumerate(Y)]
        for i, (size, (w, h)) in enumerate(zip(sizes, candidates, strict=True)):
            keys.append(at(24 + i, 3 * h + (side(w) if size == l else 0)))
        n = self.predicted((a, "sign"), keys, 255)
        b = 1
        for j in range(l - 1):
            t, x = (8 * l + b, X[0]) if j < 3 else (8 * l, 0)
            keys = [at(32, 32 * t + j), at(33, 1024 * (32 * t + j) + x)]
            keys.append(at(34, 2 * (32 * b + l) + n))
            for i, (w, h) in enumerate(candidates):
                agrees = abs(w) >> l - 1 - j == b and (w < 0) == (n == 1)
                f = 1 + (abs(w) >> l - 2 - j & 1) if agrees else 0
                keys.append(at(40 + i, 3 * (4 * h + min(j, 3)) + f))
            b = 2 * b + self.predicted((a, "below", j), keys, 255)
        return -b if n else b


# ---- §5.4: levels and signs ------------------------------------------------------------------


def level(x):
    b = x.bit_length() - 1
    return 0 if x <= 0 else min(1 + 2 * b + (x >> b - 1 & 1 if b else 0), 31)


def side(x):
    return 1 if x > 0 else 2 if x < 0 else 0


def wrapped(x):
    """A number of a model has 64 bits."""
    return (x + (1 << 63)) % (1 << 64) - (1 << 63)
