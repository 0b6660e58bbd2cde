"""§5.22 of `formats/SPEC.md`, to be read beside it: the further frames of a sequence."""

from __future__ import annotations

import hashlib
import math
import struct
import zlib

import numpy as np
import spec_cells
import spec_decoder
import spec_steps
from spec_coder import Bytes, check

KEY, CELLS, CORRECTIONS = 1, 2, 4


class Table:
    """The rate, and the records without their checksums."""

    def __init__(self, payload, step):
        check(step > 0, "frames in a file of 0 bits")
        table = Bytes(payload)
        (self.rate,) = table.unpack("d")
        check(0 <= self.rate < math.inf, "rate")
        count = table.varint()
        check(1 <= count <= len(payload), "number of frames")
        sizes = [table.varint() for _ in range(count)]
        self.records = []
        for size in sizes:
            check(size <= len(payload), "size of a record")
            (record,) = table.unpack(f"{size}s")
            check(size >= 4 and struct.pack("<I", zlib.crc32(record[:-4])) == record[-4:], "crc")
            self.records.append(record[:-4])
        check(table.at == len(payload), "FRAM is too long")


def head(record, index, p, near):
    """The fields of a record, and its streams by their names."""
    table = Bytes(record)
    names = "flags finer step coarse rms max normal dihedral digest"
    f = dict(zip(names.split(), table.unpack("BBdfffff8s"), strict=True))
    f["maps"] = table.varint()
    f["rounds"], f["unit"] = table.unpack("BB") if f["maps"] else (0, 0)
    cartesian = p["method"] == spec_decoder.CARTESIAN
    check(f["flags"] < 8, "reserved bits")
    check(not (f["flags"] & KEY and index == 1), "frame 1 as a key frame")
    check(not f["flags"] & CELLS or p["interpolated"], "cells")
    check(not (f["flags"] & CORRECTIONS and cartesian), "corrections")
    check(f["finer"] <= 30 and f["unit"] <= 30, "finer or unit")
    check(0 < f["step"] < math.inf, "step")
    check(not cartesian or f["step"] == p["step"] * 2.0 ** -f["finer"], "step of a grid")
    refined = p["method"] == spec_decoder.REFINED
    check(f["coarse"] == 1 or (refined and 1 < f["coarse"] < math.inf), "coarse")
    check(all(0 <= f[name] < math.inf for name in ("rms", "max", "normal", "dihedral")), "errors")
    parts = len(spec_steps.components(near))
    check(not f["maps"] or (parts <= f["maps"] <= len(near) and not cartesian), "maps")
    streams = ["MAPS"] if f["maps"] else []
    streams += ["CART"] if cartesian else ["ANCH", "DELT"] + (["NORM"] if refined else [])
    streams += ["CELL"] if f["flags"] & CELLS else []
    streams += ["FIXS"] if f["flags"] & CORRECTIONS else []
    sizes = [table.varint() for _ in streams]
    check(sum(sizes) == len(record) - table.at, "sizes of the streams")
    return f, {name: table.unpack(f"{n}s")[0] for name, n in zip(streams, sizes, strict=True)}


def integers(f, streams, p, near, mesh, first):
    """The integers of a frame by their names, as its streams have them."""
    vectors_of, found = spec_decoder.vectors_of, {"rows": [], "units": [], "cells": []}
    found |= {name: [] for name in ("points", "isolated", "refinements", "corrections")}
    if "MAPS" in streams:
        found["rows"] = vectors_of(streams["MAPS"], [[]] * (3 * f["maps"]))
        check(any(map(any, found["rows"])), "maps that are all the identity")
    if "CART" in streams:
        found["vectors"], _ = spec_decoder.grid_points(streams["CART"], *mesh)
    else:
        k, many = len(first["anchors"]), len(first["isolated"])
        points = vectors_of(streams["ANCH"], [[]] * (k + many))
        found["points"], found["isolated"] = points[:k], points[k:]
        found["vectors"] = vectors_of(streams["DELT"], near)
    if "NORM" in streams:
        found["refinements"] = spec_decoder.refinements(streams["NORM"], near, found["vectors"])
    if "FIXS" in streams:
        found["corrections"] = vectors_of(streams["FIXS"], near)
    if "CELL" in streams:
        stages, anchors = (2 if "NORM" in streams else 1), [v for (v,) in first["anchors"]]
        units, many = spec_cells.units_of(streams["CELL"], stages, p, near, anchors)
        found["units"] = [units]
        found["cells"] = vectors_of(streams["CELL"][stages:], [[]] * many)
        check(any(map(any, found["cells"])), "vectors of cells that are all 0")
    order = [
        "rows",
        "vectors",
        "points",
        "isolated",
        "refinements",
        "corrections",
        "units",
        "cells",
    ]
    words = [struct.pack("<q", x) for name in order for row in found[name] for x in row]
    check(hashlib.blake2b(b"".join(words), digest_size=8).digest() == f["digest"], "digest")
    return found


def expected(f, rows, x, near):
    """The expected delta coordinates."""
    n = len(near)
    each = np.tile(np.eye(3), (n, 1, 1))
    if f["maps"]:
        maps = np.eye(3) + np.array(rows, float).reshape(-1, 3, 3) * 2.0 ** -f["unit"]
        chosen = spec_decoder.chosen({"anchor_method": 0, "anchor_count": f["maps"]}, near)
        each, weight = maps[spec_cells.cells_of(near, chosen)], np.ones((n, 1, 1))
        for _ in range(f["rounds"]):
            each, weight = handed_on(each, near), handed_on(weight, near)
        each = each / weight
    delta = np.zeros((n, 3))
    for i, neighbours in enumerate(near):
        for j in neighbours:
            delta[i] += (each[i] + each[j]) / 2 @ (x[i] - x[j])
    return delta


def handed_on(values, near):
    out = np.zeros_like(values)
    for i, neighbours in enumerate(near):
        out[i] += values[i] / 2 if neighbours else values[i]
        for j in neighbours:
            out[j] += values[i] / 2 / len(neighbours)
    return out


def moved(points, by):
    return [tuple(x << by if by >= 0 else x >> -by for x in point) for point in points]


def frames(payload, p, near, mesh, surface, first, x):
    """The positions of each further frame; those of frame 0 are x, its integers `first`."""
    table, found, run = Table(payload, p["step"]), [], 0
    origin = x, first, 0
    last = origin
    for index, record in enumerate(table.records, 1):
        f, streams = head(record, index, p, near)
        run = 0 if f["flags"] & KEY else run + 1
        check(run <= 255, "a run of frames")
        read = integers(f, streams, p, near, mesh, first)
        positions, before, halved = origin if f["flags"] & KEY else last
        by = f["finer"] - halved
        whole = {name: [] for name in first} | read
        whole |= {name: first[name] for name in ("anchors", "exponents")}
        for name in ["points", "isolated"] if "ANCH" in streams else ["vectors"]:
            pairs = zip(moved(before[name], by), read[name], strict=True)
            whole[name] = [tuple(map(sum, zip(*pair, strict=True))) for pair in pairs]
        own = p | {"step": f["step"], "coarse": f["coarse"]}
        own["anchor_step"] = p["anchor_step"] * 2.0 ** -f["finer"]
        add = None if "CART" in streams else expected(f, read["rows"], positions, near)
        positions = spec_decoder.positions(own, surface, near, whole, add)
        check(float(np.abs(positions).max()) <= 1e152, "positions that are too large")
        last = positions, whole, f["finer"]
        found.append(positions)
    return found
