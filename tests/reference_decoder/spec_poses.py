"""§5.21 of `formats/SPEC.md`, to be read beside it."""

from __future__ import annotations

import math
import struct

import numpy as np
import spec_cells
from spec_coder import Bytes, check


def neighbours_of_cells(near, anchors):
    """By pairs of cells with a border, lower first: how many edges it has."""
    cells, borders = spec_cells.cells_of(near, anchors), {}
    for v, neighbours in enumerate(near):
        for w in neighbours:
            if cells[v] < cells[w]:
                pair = cells[v], cells[w]
                borders[pair] = borders.get(pair, 0) + 1
    return borders


def tree(borders, count):
    """The anchors in the order in which they are coded, and the parent of each, None without."""
    group, edges = list(range(count)), [[] for _ in range(count)]
    for _, a, b in sorted((-length, a, b) for (a, b), length in borders.items()):
        if group[a] != group[b]:
            edges[a].append(b)
            edges[b].append(a)
            group = [group[a] if g == group[b] else g for g in group]
    order, parents = [], {}
    for first in range(count):
        if first in parents:
            continue
        parents[first] = None
        order.append(first)
        for a in (walk := [first]):
            for b in sorted(edges[a]):
                if b not in parents:
                    parents[b] = a
                    walk.append(b)
                    order.append(b)
    return order, parents


def graph_of_motions(order, borders):
    """The neighbours of each of the vectors."""
    count, rank = len(order), {a: i for i, a in enumerate(order)}
    near = [[count + i] for i in range(count)] + [[i] for i in range(count)]
    for pair in borders:
        a, b = (rank[cell] for cell in pair)
        for x, y in ((a, b), (b, a)):
            near[x].append(y)
            near[count + x].append(count + y)
    return [sorted(neighbours) for neighbours in near]


def poses(payload, near, anchors, vectors_of):
    """By name: step, octaves, and the six numbers of each anchor."""
    table, found = Bytes(payload), {}
    borders = neighbours_of_cells(near, anchors)
    order, _ = tree(borders, len(anchors))
    motions, count = graph_of_motions(order, borders), len(anchors)
    while table.at < len(payload) or not found:
        (raw,) = table.unpack("{}s".format(*table.unpack("B")))
        name = raw.decode("utf-8")
        check(name and name.isprintable() and name not in found, "name of a pose")
        step, octaves = table.unpack("dB")
        check(math.isfinite(step) and step > 0 and octaves <= 24, "units of a pose")
        (stream,) = table.unpack(f"{min(table.varint(), len(payload))}s")
        read, numbers = vectors_of(stream, motions), [None] * count
        for i, a in enumerate(order):
            numbers[a] = (*read[i], *read[count + i])
        total = sum(abs(number) for row in numbers for number in row[:3])
        check(total * step <= 1e152, "displacements that are too large")
        found[name] = step, octaves, numbers
    return found


def words(found):
    """§5.7."""
    for name, (step, octaves, numbers) in found.items():
        yield from name.encode()
        yield struct.unpack("<q", struct.pack("<d", step))[0]
        yield octaves
        for row in numbers:
            yield from row


def rotation(q):
    """R(q)."""
    w, x, y, z = q
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )


def product(p, q):
    """Of quaternions."""
    (a, u), (b, v) = ((x[0], x[1:]) for x in (p, q))
    return np.concatenate(([a * b - u @ v], a * v + b * u + np.cross(u, v)))


def carried(pose, rest, near, anchors):
    """Positions and quaternions of the anchors."""
    step, octaves, numbers = pose
    order, parents = tree(neighbours_of_cells(near, anchors), len(anchors))
    p, q = {}, {}
    for a in order:
        d, u = np.array(numbers[a][:3], float), np.array(numbers[a][3:], float) * 2.0**-octaves
        parent, r = parents[a], rest[anchors]
        if parent is None:
            b, before = r[a], np.array([1.0, 0, 0, 0])
        else:
            before = q[parent]
            b = p[parent] + rotation(before) @ (r[a] - r[parent])
        p[a] = b + step * d
        further = np.concatenate(([1 - u @ u], 2 * u)) / (1 + u @ u)
        q[a] = product(further, before)
    count = range(len(anchors))
    return np.array([p[a] for a in count]), np.array([q[a] for a in count])


def solved(near, anchors, right, held):
    """The least squares with anchors of weight 10, about their mean."""
    L, S = np.zeros((len(near), len(near))), np.zeros((len(anchors), len(near)))
    for v, neighbours in enumerate(near):
        L[v, v] = len(neighbours)
        L[v, neighbours] = -1
    S[range(len(anchors)), anchors] = 10
    centre = held.mean(axis=0)
    rows = np.concatenate((right, 10 * (held - centre)))
    return np.linalg.lstsq(np.concatenate((L, S)), rows, rcond=None)[0] + centre


def posed(pose, rest, near, anchors):
    """Positions and matrices of all vertices of faces."""
    p, q = carried(pose, rest, near, anchors)
    spread = solved(near, anchors, np.zeros((len(near), 4)), q)
    small = 2.0**-40
    R = [(rotation(one) + small * np.eye(3)) / (one @ one + small) for one in spread]
    d = np.zeros_like(rest)
    for i, neighbours in enumerate(near):
        for j in neighbours:
            d[i] += (R[i] + R[j]) @ (rest[i] - rest[j]) / 2
    return solved(near, anchors, d, p), R
