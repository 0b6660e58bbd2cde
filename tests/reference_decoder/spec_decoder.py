"""A second decoder of `.dmesh` files, written from `formats/SPEC.md`, to be read beside it.

The numbers behind § are its sections. Nothing is shared with the package: the exact part is plain
Python integers, in which slots and mixers are entries of dictionaries that appear at their first
use; numpy only solves for the positions. It is slow, and meant for a few hundred vertices.
"""

from __future__ import annotations

import hashlib
import math
import struct
from fractions import Fraction
from itertools import chain, count

import numpy as np
import spec_cells
import spec_poses
import spec_steps
from spec_coder import Bytes, Stream, check, clamp, level, side, wrapped
from spec_parts import neighbours_of_faces, read_parts
from spec_polygons import (
    Glue,
    in_mesh,
    inner_parallelograms,
    neighbours_of_polygons,
    polygons,
    seen_neighbours,
)

HIGHPASS, CARTESIAN, REFINED, LOSSLESS = 0, 1, 2, 3


# ---- §1 to §4: container --------------------------------------------------------------------


def is_cut(data, at):
    """§6: whether the section at a byte is not whole."""
    check(not data[at:] or data[at : at + 4].isalpha(), "id of a section")
    size, shift = 0, 0
    for i, byte in enumerate(data[at + 4 : at + 13], 1):
        size, shift = size | (byte & 127) << shift, shift + 7
        if byte < 128:
            return at + 4 + i + size + 4 > len(data)
    return len(data) < at + 13


def container(data, cut=False):
    """§2, §3, §6: the counts of vertices and faces, the payloads by their id, and the next id."""
    file, sections = Bytes(data), {}
    check(file.unpack("8sHH") == (b"\x89DMS\r\n\x1a\n", 4, 0), "magic, version, reserved")
    vertices, faces = file.varint(), file.varint()
    check(vertices <= 1 << 40 and 1 <= faces <= 1 << 40, "counts")
    file.crc(0)
    while file.at < len(data) and not (cut and is_cut(data, file.at)):
        start = file.at
        name = file.unpack("4s")[0].decode("ascii")
        check(name.isalpha() and name not in sections and len(sections) < 64, name)
        (sections[name],) = file.unpack(f"{min(file.varint(), len(data))}s")
        file.crc(start)
    method, meta = sections.get("PARM", b"")[:1], ["meta"] if "meta" in sections else []
    geometries = {b"\1": ["CART"], b"\2": ["ANCH", "DELT", "NORM"], b"\3": ["EXAC"]}
    geometry = geometries.get(method, ["ANCH", "DELT"])
    after = ["STCH", "COPY", "POLY"] + (["STEP"] if method != b"\3" else [])
    needed = [name for name in after if name in sections]
    further = [[], ["CELL", "FIXS"]][method not in (b"\1", b"\3")]
    further += ["ATTR", "PART", "ORDR"] + (["POSE"] if "CELL" in further else []) + ["FILL"]
    further += ["FRAM"] if method != b"\3" else []
    further = [name for name in further if name in sections]
    order = ["PARM", "CONN", *needed, *geometry, *further, *meta]
    names, following = list(sections), data[file.at :][:4].decode("ascii")
    check(names[: len(order)] == order[: len(names)] and names, "order of the sections")
    check(cut or names[-1] == "CHEK", "CHEK is missing")
    check(len(names) >= len(order) or "CHEK" not in names, "sections are missing")
    further = [name for name in names[len(order) :] if name != "CHEK"]
    check(all(name[0].islower() for name in further), "an unknown section")
    return vertices, faces, sections, following if len(following) == 4 else ""


def as_far(p, sections, following):
    """§6: the stage of the sections, and the parameters by which they are decoded."""
    if "CHEK" in sections:
        return "whole", p
    if p["method"] in (CARTESIAN, LOSSLESS):
        check({"CART", "EXAC"} & set(sections), "no positions")
        return "positions", p
    check("ANCH" in sections, "no positions")
    last = "NORM" if p["method"] == REFINED else "DELT"
    before = {"PARM", "CONN", "STCH", "COPY", "POLY", "STEP", "ANCH", "DELT", "NORM", "CELL"}
    after = ({*sections} - before) | ({following} - before - {"", "FIXS"})
    if last in sections and after:
        return "positions", p
    stages = {"NORM": "refinements", "DELT": "deltas", "ANCH": "anchors"}
    stage = next(stages[name] for name in stages if name in sections)
    method = p["method"] if "NORM" in sections else HIGHPASS
    return stage, p | {"method": method, "interpolated": p["interpolated"] and "CELL" in sections}


def parameters(payload, vertices):
    """§4.1."""
    table = Bytes(payload)
    names = "method flags anchor_method bits step x y z anchor_step coarse"
    p = dict(zip(names.split(), table.unpack("4B5df"), strict=True))
    table.unpack("BB")  # the dead zones: for information
    p["anchor_count"], p["isolated"] = table.varint(), table.varint()
    if p["anchor_method"] == 1:
        (p["seed"],) = table.unpack("Q")
    check(table.at == len(payload), "PARM is too long")
    free, steps = p["method"] in (CARTESIAN, LOSSLESS), (p["step"], p["anchor_step"])
    lossless = p["method"] == LOSSLESS
    check(p["method"] <= LOSSLESS, "method")
    check(p["anchor_method"] in ((255,) if free else (0, 1, 2)), "anchor method")
    check(p["bits"] in (*range(63), 255), "bits")
    reals = *steps, p["x"], p["y"], p["z"], p["coarse"]
    check(all(map(math.isfinite, reals)) and min(steps) >= 0, "steps and origin")
    check(p["coarse"] == 1 or (p["method"] == REFINED and p["coarse"] > 1), "coarse")
    none = lossless or (p["method"] == HIGHPASS and p["bits"] == 0)
    check((p["step"] == 0) == none, "step")
    p["interpolated"] = bool(p["flags"] & 4)
    check(not p["interpolated"] or not (free or none), "interpolated anchors without deltas")
    check(not free or p["anchor_step"] == p["anchor_count"] == 0, "anchors")
    check(not lossless or (p["bits"] == 255 and p["x"] == p["y"] == p["z"] == 0), "lossless")
    check(max(p["isolated"], p["anchor_count"]) <= vertices, "counts of PARM")
    return p


def check_meta(payload):
    """§4.2."""
    table = Bytes(payload)
    check(all(0 <= x < math.inf for x in table.unpack("ddffd")), "numbers of meta")
    table.unpack("B")

    def check_string():
        (text,) = table.unpack("{}s".format(*table.unpack("B")))
        check(text.decode("utf-8").isprintable(), "strings of meta")

    check_string()
    check_string()
    if table.at < len(payload):
        lost, turned, parts = (table.varint() for _ in range(3))
        check(parts > 1 or (parts == 1 and lost + turned > 0), "counts of meta")
        if parts > 1:
            check(all(0 <= x < math.inf for x in table.unpack("fd")), "numbers of a part")
            check_string()
    check(table.at == len(payload), "meta is too long")


# ---- §5.2: connectivity ---------------------------------------------------------------------


class Node:
    """One place on a front: vertex, free edges, neighbours, index in the list of live nodes."""

    def __init__(self, vertex, free, place):
        self.vertex, self.free, self.place = vertex, free, place
        self.next = self.before = self.behind = None  # `behind`: of the edge to `next`


def link(a, b, behind):
    a.next, b.before, a.behind = b, a, behind


class Region:
    """The growing region; `names` has the result's number of each vertex, -1 for a loop vertex."""

    def __init__(self, payload, vertices, faces):
        table = Bytes(payload)
        self.loops, border, self.joins = (table.varint() for _ in range(3))
        check(self.loops <= border <= 3 * faces and self.joins <= faces + border, "counts of CONN")
        self.stream = Stream(payload[table.at :])
        self.valences, self.names, self.all = [], [], []
        self.total = self.left = vertices
        self.recent = 0, 0  # R0, R1
        self.live, self.queues = [], [{} for _ in range(64)]  # dictionaries, for their order
        while len(self.all) < faces + border:
            pivot = next(chain(*self.queues), None)
            if pivot is None:
                self.begin()
            elif pivot.free == 0:
                self.close(pivot)
            else:
                self.expand(pivot)
        self.stream.end()
        check(not self.live, "nodes are left")
        check(self.left == self.loops == self.joins == 0, "vertices, loops or joins are left")
        named = [tuple(self.names[v] for v in face) for face in self.all]
        self.faces = [face for face in named if min(face) >= 0]
        check(len(self.faces) == faces, "number of faces")

    def node(self, vertex, free):
        node = Node(vertex, free, len(self.live))
        self.live.append(node)
        self.queues[min(free, 63)][node] = None
        return node

    def set_free(self, node, free):
        check(free >= 0, "an edge too many")
        del self.queues[min(node.free, 63)][node]
        node.free = free
        self.queues[min(free, 63)][node] = None

    def leave(self, node):
        del self.queues[min(node.free, 63)][node]
        last = self.live.pop()
        if last is not node:
            self.live[node.place], last.place = last, node.place

    def vertex(self, valence, loop=False):
        check(loop or self.left > 0, "too many vertices")
        self.names.append(-1 if loop else self.total - self.left)
        self.left -= not loop
        self.valences.append(valence)
        return self.node(len(self.names) - 1, max(valence - 2, 0))

    def begin(self):
        a, b, c = (self.vertex(self.valence(None)) for _ in range(3))
        self.all.append((a.vertex, b.vertex, c.vertex))
        link(b, a, c.vertex)
        link(a, c, b.vertex)
        link(c, b, a.vertex)

    def close(self, pivot):
        u, w = pivot.before, pivot.next
        self.all.append((u.vertex, pivot.vertex, w.vertex))
        self.leave(pivot)
        if w.next is u:
            check(u.free == w.free == 0, "free edges in a closed front")
            self.leave(u)
            self.leave(w)
        else:
            self.set_free(u, u.free - 1)
            self.set_free(w, w.free - 1)
            link(u, w, pivot.vertex)

    def expand(self, pivot):
        w = pivot.next
        check(w.free > 0, "no free edges after the pivot")
        if self.is_join(pivot):
            t = self.target(pivot)
            check(t not in (pivot, w, pivot.before, w.next) and t.free >= 2, "target")
            r, self.joins = t.free - 2, self.joins - 1
            s = self.split(r)
            check(s <= r and self.joins >= 0, "split")
            x = self.node(t.vertex, r - s)  # the twin
            self.set_free(t, s)
            link(t.before, x, t.before.behind)
        else:
            if self.loops and self.stream.predicted("loop", ["loop"], 1000):
                self.loops -= 1
                x = self.vertex(self.stream.number("length", "loop valence"), loop=True)
            else:
                x = self.vertex(self.valence(pivot))
                self.recent = min(self.valences[-1], 15), self.recent[0]
            t = x
        self.all.append((pivot.vertex, w.vertex, x.vertex))
        self.set_free(pivot, pivot.free - 1)
        self.set_free(w, w.free - 1)
        link(pivot, t, w.vertex)
        link(x, w, pivot.vertex)

    def is_join(self, pivot):
        a1, b1 = pivot.next, pivot.before
        a2, b2 = a1.next, b1.before
        triples = (a1, a2, a2.next), (pivot, b1, b2), (a1, a2, b2.before)
        g = [[clamp(node.free - 1, 0, 3) for node in triple] for triple in triples]
        keys = [("join", i, 16 * x + 4 * y + z) for i, (x, y, z) in enumerate(g)]
        return self.stream.predicted("join", keys, 1000, (math.floor((1 << 22) * 0.01), 2))

    def target(self, pivot):
        if self.stream.predicted("near", ["near"], 255):
            z = self.stream.tree("target", "target", 5)
            node = pivot if z & 1 else pivot.next
            for _ in range((z >> 1) + 1):
                node = node.before if z & 1 else node.next
            return node
        return self.live[self.stream.index(len(self.live))]

    def split(self, r):
        if r >= 8:
            return self.stream.number("length", "split") - 1
        return self.stream.tree("split", ("split", r), 3) if r else 0

    def valence(self, pivot):
        """The valence of a vertex that is new at the pivot, or in a first face."""
        closes, contexts = 0, [(0, 0)] * 8
        if pivot:
            nodes = pivot, pivot.next, pivot.before
            vertices = *(node.vertex for node in nodes), pivot.behind
            P, A, B, H = (min(self.valences[v], 15) for v in vertices)  # noqa: N806
            fp, fa, fb = (min(node.free, 7) for node in nodes)
            tp, ta, th = (clamp(x - 3, 0, 7) for x in (P, A, H))
            closes, (r0, r1) = int(fp == 1), self.recent
            numbers = (
                0,
                16 * P + A,
                64 * fp + 8 * fa + fb,
                16 * A + H,
                16 * r0 + r1,
                16 * B + A if closes else 256 + 16 * A + r0,
                64 * ta + 8 * tp + th + 512 * closes,
                2 * clamp(P + A + B + H - 16, 0, 31) + closes,
            )
            contexts = list(enumerate(numbers))

        def bit(node):
            x = (0.35, 0.55, 0.68, 0.8, 0.95, 0.62, 0.55)[min(node, 6)]
            keys = [("valence", node, *context) for context in contexts]
            mixer = "valence", node, closes
            return self.stream.predicted(mixer, keys, 500, (math.floor((1 << 22) * x), 1))

        if bit(0):
            return 6
        if bit(1):
            return next((5 - i for i in range(3) if bit(2 + i)), 2)
        return next((7 + i for i in range(12) if bit(5 + i)), None) or (
            18 + self.stream.number("length", "valence")
        )


# ---- §5.3: anchors --------------------------------------------------------------------------


def read_anchors(payload, p, near, exponents):
    """§5.3, §5.19: the anchors' indices and grid points, those of the isolated vertices."""
    bits, stream = payload[:3], Stream(payload[3:])
    check(len(bits) == 3 and max(bits) <= 30, "bits of the grid")
    if p["anchor_method"] == 2:
        indices, last = [], -1
        for _ in range(p["anchor_count"]):
            last += stream.number("index", "index", 63)
            check(last < len(near), "index of an anchor")
            indices.append(last)
        check(math.inf not in distances(near, indices), "a component without an anchor")
    else:
        indices = chosen(p, near)
    more = [spec_steps.bits_more(exponents[v]) for v in indices]
    points = [tuple(stream.raw(n + extra) for n in bits) for extra in more]
    isolated, x = [], 0
    for _ in range(p["isolated"]):
        x += stream.number("isolated", "isolated", 63) - 1
        check(x < 1 << bits[0], "an isolated vertex outside the grid")
        isolated.append((x, stream.raw(bits[1]), stream.raw(bits[2])))
    stream.end()
    return {"anchors": [(v,) for v in indices], "points": points, "isolated": isolated}


def distances(near, sources):
    """Edges from each vertex to the nearest of the sources."""
    found = [math.inf] * len(near)
    ring = list(sources)
    for steps in count():
        ring = [v for v in ring if found[v] == math.inf]
        if not ring:
            return found
        for v in ring:
            found[v] = steps
        ring = [w for v in ring for w in near[v]]


def chosen(p, near):
    """What the docstrings of `farthest` and `random` in `deltamesh._geometry.anchors` say."""
    n, left, parts = len(near), list(range(len(near))), []
    while left:
        away = distances(near, left[:1])
        parts.append([v for v in left if away[v] < math.inf])
        left = [v for v in left if away[v] == math.inf]
    check(len(parts) <= p["anchor_count"] <= n, "number of anchors")
    if p["anchor_method"] == 1:
        keys = [(splitmix(p["seed"], v), v) for v in range(n)]
        first = [min(keys[v] for v in part) for part in parts]
        return [v for _, v in first + sorted(set(keys) - set(first))][: p["anchor_count"]]
    anchors = [part[0] for part in parts]
    while len(anchors) < p["anchor_count"]:
        away = distances(near, anchors)
        anchors.append(away.index(max(away)))
    return anchors


def splitmix(seed, i):
    modulus = 1 << 64
    z = (seed + (i + 1) * 0x9E3779B97F4A7C15) % modulus
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9 % modulus
    z = (z ^ z >> 27) * 0x94D049BB133111EB % modulus
    return z ^ z >> 31


# ---- §5.4 to §5.6: vectors --------------------------------------------------------------------


class Vectors:
    """The vectors of a stream so far, and the models of the next."""

    def __init__(self, payload, axes=3):
        self.stream, self.read, self.axes = Stream(payload), [], range(axes)

    def next(self, below, K, J, hints=None, more=0, before=0, choose=None):  # noqa: N803
        """Read one more; `below` are the neighbours with a lower index.

        See NORM for `more` and `before`. `choose` gives, of an axis, one more context of the length
        and of the sign, and candidates; it is told what was read.
        """
        known, c = [self.read[v] for v in below], max(len(below), 1)
        S = [sum(v[a] for v in known) for a in self.axes]
        M = [sum(abs(v[a]) for v in known) for a in self.axes]
        H = hints or [max((abs(v[a]) for v in known), default=0) for a in self.axes]
        T, vector = self.read[-1] if self.read else (0, 0, 0), []
        around = level(4 * (sum(M) + more) // c)
        for a in self.axes:
            here, last, hint = level(4 * M[a] // c), level(abs(T[a])), level(H[a])
            N = level(before + sum(map(abs, vector)))
            D = wrapped(sum(s * v for s, v in zip(S, vector, strict=False)))
            X = [4 * here + K, 32 * around + N, 32 * here + last, 32 * hint + here]
            X += [4 * (16 * around + J) + K, 4 * (16 * (here // 2) + N // 2) + K]
            agrees, positive, size = side(D), int(S[a] > 0), level(4 * abs(S[a]) // c)
            Y = [32 * positive + size, 32 * (2 * agrees + positive) + size]  # noqa: N806
            Y += [8 * (2 * (3 * side(T[a]) + agrees) + positive) + size // 4]  # noqa: N806
            if choose:
                x, y, candidates, learn = choose(a)
                vector.append(self.stream.signed(a, [*X, x], [*Y, y], candidates))
                learn(vector[-1])
            else:
                vector.append(self.stream.signed(a, X, Y))
        self.read.append(tuple(vector))
        return vector


def deltas(payload, step, near):
    """§5.4."""
    if step == 0:
        check(payload == b"", "deltas without a step")
        return [(0, 0, 0)] * len(near)
    return vectors_of(payload, near)


def vectors_of(payload, near):
    """§5.4, and FIXS of §5.5."""
    vectors = Vectors(payload)
    for i, neighbours in enumerate(near):
        below = [v for v in neighbours if v < i]
        vectors.next(below, min(len(below), 3), min(len(neighbours), 15))
    vectors.stream.end()
    return vectors.read


def refinements(payload, near, values):
    """§5.5; `values` are the vectors of §5.4."""
    vectors, sizes = Vectors(payload, 1), [sum(map(abs, vector)) for vector in values]
    for i, neighbours in enumerate(near):
        below, valence = [v for v in neighbours if v < i], len(neighbours)
        more = wrapped(len(below) * sum(sizes[v] for v in neighbours)) // max(valence, 1)
        vectors.next(below, min(len(below), 3), min(valence, 15), None, more, 2 * sizes[i])
    vectors.stream.end()
    return vectors.read


def parallelograms(faces):
    """§5.6: of each vertex i the (a, b, o), in the order of the faces (a, b, i)."""
    sides, found = {}, {}
    for at, (a, b, c) in enumerate(faces):
        for half in (a, b, c), (b, c, a), (c, a, b):
            sides.setdefault(frozenset(half[:2]), []).append((*half, at))
    for first, second in (pair[:2] for pair in sides.values() if len(pair) > 1):
        for (a, b, i, at), o in (first, second[2]), (second, first[2]):
            if max(a, b, o) < i:
                found.setdefault(i, []).append((at, a, b, o))
    return {i: [row[1:] for row in sorted(rows)] for i, rows in found.items()}


class Grid:
    """§5.6: what is known when a grid point is read, and what was learnt from those before."""

    def __init__(self, faces, inner):
        self.points, self.around, self.inner = [], parallelograms(faces), inner
        self.errors, self.fates = {}, [[0] * 3 for _ in range(3)]

    def look(self, i, below):
        """Set class, predictions P and candidates C of each axis for vertex i; return m, H."""
        g, inner = self.points, self.inner.get(i, [])
        of, self.quads = inner + self.around.get(i, []), bool(inner)
        close = inner or of
        before = g[-1] if g else (0, 0, 0)
        mean = [sum(g[v][a] for v in below) // len(below) for a in range(3)] if below else before
        if not of:
            self.kind, last = min(len(below), 3), g[below[-1]] if below else before
            rows = zip(mean, last, before, strict=True)
            self.P = [[m, near, p, m, m] for m, near, p in rows]
            self.C = [[P[1], P[2], P[0]] for P in self.P]
            return 0, [0, 0, 0]
        m, k, shapes = len(of), len(close), [self.shape(*row) for row in close]
        a, b, o = close[shapes.index(max(shapes))]
        if self.distance(b, o) < self.distance(a, o):
            a, b = b, a
        self.kind = 4 + 10 * min(m, 3) + max(shapes) + 40 * self.quads
        sums = [[g[a][x] + g[b][x] - g[o][x] for a, b, o in of] for x in range(3)]
        self.C = list(zip(g[a], g[b], g[o], strict=True))
        all_of = [(2 * sum(s) + m) // (2 * m) for s in sums]
        last = all_of if inner else mean if below else [0] * 3
        self.P = [
            [(2 * sum(s[:k]) + k) // (2 * k), near, 2 * near - apex, near + far - apex, x]
            for s, (near, far, apex), x in zip(sums, self.C, last, strict=True)
        ]
        return m, [max(s) - min(s) for s in sums]

    def distance(self, v, w):
        return sum(abs(x - y) for x, y in zip(self.points[v], self.points[w], strict=True))

    def shape(self, a, b, o):
        one, other = self.distance(a, o), self.distance(b, o)
        return 8 * min(one, other) // max(one, other, 1)

    def choose(self, a):
        E = self.errors.setdefault((a, self.kind), [0] * 5)
        P, F, q = self.P[a], self.fates[a], 0  # noqa: N806
        for i in range(1, 5):
            if E[i] * (1 if q or (i == 4 and self.quads) else 3) < E[q]:
                q = i
        W = [x - P[q] for x in self.C[a]]

        def learn(r):
            for i in range(3):
                F[i] = (2 * F[i] + (r == W[i])) % 16
            for i in range(5):
                E[i] += 16 * abs(P[q] + r - P[i]) - (E[i] >> 8)
            self.point.append(clamp(P[q] + r, -(1 << 40), 1 << 40))

        x = 8 * (5 * self.kind + q) + min(level(abs(P[0] - P[1])) // 2, 7)
        candidates = [(w, 2 * f + (w == 0)) for w, f in zip(W, F, strict=True)]
        return x, side(P[1] - P[q]), candidates, learn


def grid_points(payload, faces, near, inner):
    """§5.6."""
    grid, vectors = Grid(faces, inner), Vectors(payload)
    for i, neighbours in enumerate(near):
        below = [v for v in neighbours if v < i]
        m, hints = grid.look(i, below)
        grid.point = []
        vectors.next(below, min(m, 3), level(sum(hints)) // 2, hints, choose=grid.choose)
        grid.points.append(tuple(grid.point))
    vectors.stream.end()
    return grid.points, []


def rooted_points(payload, faces, near, inner, exponents):
    """§5.19."""
    parts, roots, payload = spec_steps.roots(payload, near[: len(exponents)], exponents)
    points, _ = grid_points(payload, faces, near, inner)
    for part, root in zip(parts, roots, strict=True):
        check(points[part[0]] == (0, 0, 0), "a root that is not at itself")
        for v in part:
            points[v] = tuple(x + y for x, y in zip(points[v], root, strict=True))
    return points, []


# ---- §5.12: exact coordinates ---------------------------------------------------------------


class Form:
    """A form and what follows from it: x is the places of the grid less its own."""

    def __init__(self, key, grid, base, places, digits, usual):
        self.key, self.base, self.places, self.digits, self.usual = key, base, places, digits, usual
        self.x, self.w, self.top = grid - places, max(usual - 8, 0), base ** max(digits - 1, 0)
        check(usual <= 60, "usual length")
        if base == 2:
            check(-971 <= places <= 1074 and 1 <= digits <= 53, "a binary form")
            check(self.x >= 58 - (1 << 61 - digits), "a binary form far off the grid")
        else:
            check(base == 10 and 0 <= places <= 22 and 1 <= digits <= 17, "a decimal form")
            check(0 <= self.x <= 18, "a decimal form far off the grid")

    def next_to(self, p):
        """The index next to a place, and y."""
        n = 0
        while self.base**n <= abs(p):
            n += 1
        e = max(n - self.x - self.digits, 0)
        y = e + self.x
        m = self.scaled(abs(p) + (self.base**y // 2 if y > 0 else 0), -y)
        index = m + e * (self.base - 1) * self.top
        return (-index if p < 0 else index), y

    def parts(self, index):
        e = max((abs(index) - self.top) // ((self.base - 1) * self.top), 0)
        return abs(index) - e * (self.base - 1) * self.top, e

    def scaled(self, z, y):
        return z * self.base**y if y >= 0 else z // self.base**-y

    def place(self, index):
        m, e = self.parts(index)
        size = min(self.scaled(m, min(e + self.x, 99)), 1 << 56)
        return -size if index < 0 else size

    def number(self, index, single):
        m, e = self.parts(index)
        check(e < 4096, "a coordinate that is too large")
        check(self.base == 2 or m * 10**e < 1 << 53, "a decimal that is too long")
        exact = Fraction(m * self.base**e) / Fraction(self.base) ** self.places
        check(exact < 1 << 1023, "a coordinate that is too large")
        number = float(exact)
        if single and self.base == 10:
            number = as_single(number)
        return -number if index < 0 else number

    def units(self, z, y):
        return z // self.base**y if y >= 0 else min(z, 1 << 29) << min(-y, 32)


def as_single(number):
    """The binary32 number next to one of binary64."""
    check(abs(number) < 2.0**128 - 2.0**103, "a number too large for binary32")
    return struct.unpack("<f", struct.pack("<f", number))[0]


class Conversion:
    """What becomes of the sources of an axis."""

    def __init__(self, table, flags, single):
        count, self.deviations = flags >> 4 & 3, flags >> 7
        self.single, self.early = single, single and not flags & 64
        check(count < 3, "operations")
        check(not flags & 64 or (single and count == 2), "a conversion in binary64")
        self.operations = [table.unpack("Bd") for _ in range(count)]
        for operator, operand in self.operations:
            check(operator < 3 and 2.0**-1022 <= abs(operand) <= 1e150, "an operation")

    def ordinal(self, number, back=False):
        """The ordinal of a number, or the number that has it."""
        half = 1 << (31 if self.single else 63)
        codes = ("<I", "<f") if self.single else ("<Q", "<d")
        if not back:
            (b,) = struct.unpack(codes[0], struct.pack(codes[1], number))
            return b if b < half else half - 1 - b
        check(-half <= number < half, "an ordinal of no number")
        b = number if number >= 0 else half - 1 - number
        (number,) = struct.unpack(codes[1], struct.pack(codes[0], b))
        check(math.isfinite(number), "a coordinate that is not finite")
        return number

    def result(self, source, deviation):
        x = source
        for operator, operand in self.operations:
            x = (x + operand, x * operand, x / operand)[operator]
            check(math.isfinite(x), "a coordinate that is not finite")
            x = as_single(x) if self.early else x
        if self.single and (self.operations or self.deviations):
            x = as_single(x)
        check(self.deviations or deviation == 0, "a deviation that there is not")
        return self.ordinal(self.ordinal(x) + deviation, back=True) if self.deviations else x


class Axis:
    """The forms of an axis, what was read of it, and what is known of the next vertex."""

    def __init__(self, table, number, width):
        self.number, (flags, grid) = number, table.unpack("Bh")
        count, self.raw, self.zeros = flags & 3, flags >> 2 & 1, flags >> 3 & 1
        check(count < 3 and count + self.raw, "flags of an axis")
        self.conversion = Conversion(table, flags, width == 32)
        keys = ((number, i) for i in range(count))
        self.forms = [Form(key, grid, *table.unpack("BhBB")) for key in keys]
        check(len({form.base for form in self.forms}) < 2, "forms of two bases")
        self.kinds = [*range(count), *[2] * self.raw]
        self.f, self.places, self.errors, self.numbers = [], [], [], []

    def read(self, stream, i, known, guesses, width, E, N):
        """Read the coordinate of vertex i; return f, and N for the next axis."""
        c, r = len(known), sum(self.f[v] in (1, 2) for v in known)
        T, before = (self.f[-1], self.errors[-1]) if i else (0, 0)
        p, H = self.predicted(known, guesses)
        kinds = list(self.kinds)
        for bit in range(len(kinds) - 1):
            keys = (4 * r // max(c, 1), E), (r, c), (T, E)
            if not self.bit(stream, ("choice", bit), keys):
                break
            kinds.pop(0)
        f = kinds[0]
        if f == 2:
            self.add_raw(p, width, stream.raw(width))
            return f, N
        form = self.forms[f]
        index, y = form.next_to(p)
        M, w = sum(abs(self.errors[v]) for v in known), form.w
        here = level(form.units(4 * M // max(c, 1), y) >> w)
        hint, last = (level(form.units(z, y) >> w) for z in (H, abs(before)))
        K = min(len(guesses), 3)
        lengths = (here, K), (here, N), (here, last), (hint, here)
        lengths += (hint // 2, N // 2, K), (here // 2, N // 2, K)
        slope = sum((self.errors[v] > 0) - (self.errors[v] < 0) for v in known)
        signs = side(slope), slope, (side(before), side(slope))
        v = self.distance(stream, form, lengths, here, signs)
        index += v
        place, negative = form.place(index), False
        if index == 0 and f == 0 and self.zeros:
            alike = sum(self.f[v] == 3 for v in known)
            negative = self.bit(stream, ("zero",), (None, alike, T))
        number = -0.0 if negative else form.number(index, self.conversion.single)
        self.known(3 if negative else f, place, clamp(place - p, -(1 << 56), 1 << 56), number)
        size = level(abs(v) >> w)
        return f, (N + size + 1) // 2 if self.number else size

    def add_raw(self, p, width, bits):
        code = "<f" if width == 32 else "<d"
        self.known(2, p, 0, struct.unpack(code, bits.to_bytes(width // 8, "little"))[0])

    def coordinates(self, deviations):
        """Of what was read."""
        found = []
        for f, number, deviation in zip(self.f, self.numbers, deviations, strict=True):
            check(f != 2 or deviation == 0, "a deviation of a raw number")
            number = number if f == 2 else self.conversion.result(number, deviation)
            found.append(self.bounded(f, number))
        return found

    def bounded(self, f, number):
        """What a coordinate is; `f` is 2 if it is raw."""
        check(abs(number) <= 1e150, "a coordinate that is too large")
        return number

    def known(self, f, place, error, number):
        self.f.append(f)
        self.places.append(place)
        self.errors.append(error)
        self.numbers.append(number)

    def predicted(self, known, guesses):
        g = self.places
        found = [g[a] + g[b] - g[o] for a, b, o in guesses[:8]]
        if found:
            p = (2 * sum(found) + len(found)) // (2 * len(found))
            return clamp(p, -(1 << 56), 1 << 56), max(found) - min(found)
        if known:
            return sum(g[v] for v in known) // len(known), 0
        return (g[-1] if g else 0), 0

    def bit(self, stream, what, contexts, mixer=None, key=None):
        name = (self.number, key, *what)
        keys = [(*name, i, context) for i, context in enumerate(contexts)]
        return stream.predicted((self.number, key, *(mixer or what)), keys, 255)

    def distance(self, stream, form, lengths, here, signs):
        def longer(k):
            return self.bit(stream, ("length", k), lengths, None, form.key)

        k = form.usual
        if longer(k):
            k += 1
            while k <= 61 and longer(k):
                k += 1
        else:
            while k and not longer(k - 1):
                k -= 1
        size = min(k, 1)
        for _ in range(min(k - 1, 3)):
            below = "below", k, size
            size = 2 * size + self.bit(stream, below, (None, here), ("below",), form.key)
        size = size << max(k - 4, 0) | stream.raw(max(k - 4, 0))
        return -size if k and self.bit(stream, ("sign",), signs, None, form.key) else size


def read_axes(payload, near, around, axis_of):
    """Three axes that `axis_of` makes, read, their coordinates, and the bytes before the stream.

    `around` gives the parallelograms of an element.
    """
    table = Bytes(payload)
    (width,) = table.unpack("B")
    check(width in (32, 64), "width")
    axes = [axis_of(table, a, width) for a in range(3)]
    forms, vectors = payload[: table.at], [(0, 0, 0)] * len(near)
    if any(axis.conversion.deviations for axis in axes):
        (size,) = table.unpack("I")
        check(table.at + size <= len(payload), "truncated")
        vectors = vectors_of(payload[table.at + size :], near)
        payload = payload[: table.at + size]
    stream = Stream(payload[table.at :])
    for i, neighbours in enumerate(near):
        known, E, N = [v for v in neighbours if v < i][:8], 0, 0
        for axis in axes:
            f, N = axis.read(stream, i, known, around(i), width, E, N)
            E = 3 * E + f
    stream.end()
    deviations = zip(*vectors, strict=True) if vectors else [()] * 3
    numbers = [a.coordinates(some) for a, some in zip(axes, deviations, strict=True)]
    return [*zip(*numbers, strict=True)], forms


def coordinates(payload, faces, near, inner):
    """§5.12: the coordinates as integers of 64 bits, and the bytes before the stream."""
    guesses = parallelograms(faces)

    def around(i):
        return inner.get(i, []) + guesses.get(i, [])

    rows, forms = read_axes(payload, near, around, Axis)
    return [struct.unpack("<3q", struct.pack("<3d", *row)) for row in rows], [tuple(forms)]


# ---- §5.11: order ---------------------------------------------------------------------------

FIRST, OLDEST, NEWEST = 0, 1, 2
NEXT, NEAR, ANY = 0, 1, 2


def near_class(x, y):
    return clamp(x - y, -2, 3) + 2


class Steps:
    """What both streams of an order have in common."""

    def __init__(self, payload, count, rings):
        self.stream = Stream(payload)
        self.distances = Vectors(b"", 1)
        self.distances.stream = self.stream
        self.left, self.last, self.ways = list(range(count)), -1, [0] * 4
        self.trails, self.trail, self.rings = [(0, 0, 0)] * 32, 0, rings

    def next(self):
        return next((e for e in self.left if e > self.last), self.left[0])

    def way(self, follows, any_anchor):
        h, f = tuple(self.ways), level(abs(self.trails[0][1])) // 2
        way = ANY
        for k in (NEXT, NEAR) if any_anchor else (NEXT,):
            keys = [("way", k, h), ("way 2", k, h[-2:], follows), ("way 3", k, h[-1], f)]
            if self.stream.predicted(("way", k), keys, 255):
                way = k
                break
        self.ways = [*self.ways[1:], way]
        return way

    def any(self):
        return self.left[self.stream.index(len(self.left))]

    def anchor(self):
        before, node = tuple(self.ways[-3:-1]), 1
        for _ in range(5):
            keys = ("trail", self.trail, node), ("trail 2", before, node)
            node = 2 * node + self.stream.predicted("trail", keys, 255)
        self.trail = t = node - 32
        a, d1, d2 = self.trails[t]
        self.distances.read = [(d2,), (d1,)]  # as if of two neighbours, the second one just before
        return a + self.distances.next((0, 1), min(t, 3), 0, [abs(d2)])[0]

    def candidates(self, anchor, fits):
        found = [e for e in self.rings[anchor][:64] if fits(e)][:16]
        check(found, "no candidate at an anchor")
        return found

    def leave(self, vertex, element):
        ring = self.rings[vertex]
        at = ring.index(element)
        self.rings[vertex] = ring[at + 1 :] + ring[:at]

    def follow(self, x):
        trails = self.trails
        t = next((t for t in range(31) if abs(x - trails[t][0]) <= 12), 31)
        a, d1, _ = trails.pop(t)
        trails.insert(0, (x, x - a, d1) if abs(x - a) <= 12 else (x, 0, 0))

    def placed(self, element):
        self.left.remove(element)
        self.last = element


def order_of_vertices(payload, near, newest):
    """The vertex at each place."""
    steps = Steps(payload, len(near), [list(ring) for ring in near])
    places, order, before, chosen = {}, [], (0, 0), (0, 0)

    def around(v):
        return [places[w] for w in near[v] if w in places]

    def ends(v):
        return (min(around(v)), max(around(v))) if around(v) else (-1, -1)

    while steps.left:
        i = len(order)
        follows = around(steps.next()) and 1 + (ends(steps.next())[1] == i - 1)
        way = steps.way(follows or 0, i > 0)
        if way == NEXT:
            v = steps.next()
        elif way == ANY:
            v = steps.any()
        else:
            place = steps.anchor()
            check(0 <= place < i, "an anchor without a place")
            found = steps.candidates(order[place], lambda w: ends(w)[newest] == place)  # noqa: B023
            for k, v in enumerate(found):
                (p, q), n = ends(v), min(len(around(v)), 3)
                w = near_class(p, before[0]), int(q == i - 1)
                third = n, min(k, 3), near_class(q, before[1])
                keys = ("v", w, n), ("v 2", w, chosen), ("v 3", *third)
                if v == found[-1] or steps.stream.predicted("candidate", keys, 255):
                    break
            chosen = w
        before = ends(v)
        steps.follow(before[newest] if around(v) else i)
        for w in near[v]:
            steps.leave(w, v)
        places[v] = i
        order.append(v)
        steps.placed(v)
    steps.stream.end()
    return order


def order_of_faces(payload, faces, polygons, places, kind):
    """The polygon at each place and where it begins; `places` gets the rest of them.

    `faces` are the lowest ones of the polygons; each polygon is its vertices, and where in it the
    corners of its face are.
    """
    none, laters = 1 << 60, (0, 0, 0, 0)
    corners = [[] for _ in range(1 + max(chain(*faces)))]
    for e, v in enumerate(chain(*faces)):
        corners[v].append(e)
    steps = Steps(payload, len(faces), corners)
    order, begins, recent = [], [], [(None,) * 3] * 2
    m_before, u_before, straight = 0, 0, (False, False)

    def place(v):
        return places.get(v, none)

    def corner(face, kind):
        """The corner of the oldest or newest vertex."""
        at = [places.get(v, none if kind == OLDEST else -1) for v in faces[face]]
        return at.index(min(at) if kind == OLDEST else max(at))

    def alike(others, here):
        if others[0] is None:
            return False
        turns = [[place(others[(i + j) % 3]) for j in range(3)] for i in range(3)]
        return any(len({x - y for x, y in zip(turn, here, strict=True)}) == 1 for turn in turns)

    while steps.left:
        way = steps.way(sum(v in recent[0] for v in faces[steps.next()]), places)
        begin = None
        if way == NEXT:
            f = steps.next()
        elif way == ANY:
            f = steps.any()
        else:
            anchor = steps.anchor()
            hub = [v for v in places if places[v] == anchor]
            check(hub, "an anchor without a place")
            fits = lambda e: kind == FIRST or corner(e // 3, kind) == e % 3  # noqa: E731
            found = steps.candidates(hub[0], fits)
            for k, e in enumerate(found):
                f, j = divmod(e, 3)
                s, s2 = (sum(v in others for v in faces[f]) for others in recent)
                here = [place(faces[f][(j + i) % 3]) for i in range(3)]
                m = min(here[1:]) if kind == NEWEST else max(here[1:])
                lead = near_class(m, m_before) if m < 1 << 50 else 6
                z, y = here.count(none), tuple(alike(others, here) for others in recent)
                keys = ("f", s, s2, z), ("f 2", lead, s, z), ("f 3", lead, y, min(k, 3))
                if e == found[-1] or steps.stream.predicted("candidate", keys, 255):
                    break
            m_before = min(m, 1 << 50)
            begin = j if kind == FIRST else None
        if begin is None:
            r = corner(f, kind or OLDEST)
            turned = [faces[f][(r + i) % 3] for i in range(3)]
            where = tuple(recent[0].index(v) if v in recent[0] else 3 for v in turned)
            b1, b2 = place(turned[1]), place(turned[2])
            b = 0 if b1 < b2 else 1 if b1 > b2 else 2
            mask, v = tuple(x < 3 for x in where), -r % 3
            u = 2
            for x in (0, 1):
                second = mask, b, u_before
                keys = ("u", x, where, u_before), ("u 2", x, *second), ("u 3", x, v, straight)
                if steps.stream.predicted(("u", x), keys, 255):
                    u = x
                    break
            u_before, straight = u, (straight[1], u == v)
            begin = (r + u) % 3
        names, at = polygons[f]
        polygon = names[at[begin] :] + names[: at[begin]]
        later, most = 0, (at[(begin + 1) % 3] - at[begin]) % len(names) - 1
        while later < most:
            first, second = polygon[later : later + 2]
            i, i2 = (recent[0].index(v) if v in recent[0] else 3 for v in (first, second))
            b1, b2 = place(first), place(second)
            b = 0 if b1 < b2 else 1 if b1 > b2 else 2
            contexts = (i, i2, b), laters, (min(later, 3), b, laters[2:])
            keys = [("later", x, context) for x, context in enumerate(contexts)]
            bit = steps.stream.predicted("later", keys, 255)
            laters = *laters[1:], bit
            if not bit:
                break
            later += 1
        polygon = polygon[later:] + polygon[:later]
        order.append(f)
        begins.append((at[begin] + later) % len(names))
        for j, v in enumerate(faces[f]):
            steps.leave(v, 3 * f + j)
        recent = [tuple(polygon[:3]), recent[0]]
        for v in polygon:
            places.setdefault(v, len(places))
        steps.follow(place(faces[f][begin if kind == FIRST else corner(f, kind)]))
        steps.placed(f)
    steps.stream.end()
    return order, begins


def read_order(payload, faces, polygons, n):
    """The vertex and the polygon at each place, and the corners at which the polygons begin."""
    table = Bytes(payload)
    ends, told = list(chain(*faces)), []
    for polygon in polygons:
        at = {h: k for k, fan in enumerate(polygon) for h in fan}
        low = 3 * (min(at) // 3)
        told.append(([ends[fan[0]] for fan in polygon], [at[low + c] for c in range(3)]))
    faces = [[names[k] for k in at] for names, at in told]
    near = neighbours_of_polygons([names for names, _ in told], n)
    (plan,), size = table.unpack("B"), table.varint()
    check(plan < 16 and plan & 3 < 3 and table.at + size <= len(payload), "plan or size of ORDR")
    of_vertices, of_faces = payload[table.at :][:size], payload[table.at + size :]
    if not plan & 8:
        order = order_of_vertices(of_vertices, near, plan >> 2 & 1)
        places = {v: i for i, v in enumerate(order)}
        return order, *order_of_faces(of_faces, faces, told, places, plan & 3)
    names = {}
    face_order = order_of_faces(of_faces, faces, told, names, plan & 3)
    for v in range(len(near)):
        names.setdefault(v, len(names))
    vertex = sorted(names, key=names.get)
    renamed = [sorted(names[w] for w in near[v]) for v in vertex]
    order = order_of_vertices(of_vertices, renamed, plan >> 2 & 1)
    return [vertex[v] for v in order], *face_order


# ---- §5.9, §5.10: from the manifold to the mesh ----------------------------------------------


def neighbours_of(faces, n):
    graph = [set() for _ in range(n)]
    for face in faces:
        for v in face:
            graph[v] |= {w for w in face if w != v}
    return [sorted(neighbours) for neighbours in graph]


def turned_over(face):
    return face[0], face[2], face[1]


class Manifold:
    """The faces of CONN; `across` has (face, place) of the half-edge that runs back along one."""

    def __init__(self, faces, n):
        self.faces, self.near = faces, neighbours_of(faces, n)
        sides = {}
        for f, face in enumerate(faces):
            for i in range(3):
                check((face[i], face[i - 2]) not in sides, "faces that disagree along an edge")
                sides[face[i], face[i - 2]] = f, i
        back = {place: sides.get((b, a)) for (a, b), place in sides.items()}
        self.across = back
        self.border = {v for (a, b), at in sides.items() if back[at] is None for v in (a, b)}
        self.fans = [self.fan(v) for v in range(n)]

    def fan(self, v):
        """The corners (face, place) of a vertex, and whether its fan is closed (§5.10)."""
        corners = [(f, face.index(v)) for f, face in enumerate(self.faces) if v in face]
        first = [(f, i) for f, i in corners if self.across[f, (i + 2) % 3] is None]
        check(len(first) <= 1 and corners, "a vertex of several fans, or of none")
        fan = (first or corners)[:1]
        while (at := self.across[fan[-1]]) is not None and (at[0], (at[1] + 1) % 3) != fan[0]:
            fan.append((at[0], (at[1] + 1) % 3))
        check(len(fan) == len(corners), "a vertex of several fans")
        return fan, not first


class Stitching:
    """§5.9; without a payload the mesh is the manifold."""

    def __init__(self, payload, manifold, used, total, face_count):
        self.m, self.total = manifold, total
        n, faces = len(manifold.near), len(manifold.faces)
        self.points, self.turned = list(range(n)), [0] * faces
        self.repeats, self.degenerate = [(0, 0)] * faces, []
        if payload is not None:
            table = Bytes(payload)
            _, _, turned, repeated = (table.varint() for _ in range(4))
            check(turned <= 1 and repeated <= face_count - faces, "counts of STCH")
            self.stream = Stream(payload[table.at :])
            self.stitch()
            check(max(self.points, default=-1) + 1 == used, "number of points")
            self.turned = self.turn() if turned else self.turned
            self.repeats = self.repeat(repeated) if repeated else self.repeats
            self.collapse(face_count - faces - repeated)
            self.stream.end()
            check(turned == max(self.turned, default=0), "nothing is turned")
            check(face_count > faces or turned or used < n, "nothing to describe")
        self.surface = [tuple(self.points[v] for v in face) for face in manifold.faces]
        own = zip(self.surface, self.turned, strict=True)
        self.faces = [turned_over(face) if turned else face for face, turned in own]
        for f, counts in enumerate(self.repeats):
            face = self.faces[f]
            self.faces += counts[0] * [face] + counts[1] * [turned_over(face)]
        self.faces += [(a, a, b) for a, b in self.degenerate]

    def bit(self, name, *contexts):
        keys = [(name, i, context) for i, context in enumerate(contexts)]
        return self.stream.predicted(name, keys, 255)

    def stitch(self):
        self.points, members, flags = [], [], [0, 0]
        for v, neighbours in enumerate(self.m.near):
            below = [u for u in neighbours if u < v]
            taken = {self.points[u] for u in below}
            found = self.candidates(v, below, taken, members)
            b, s = v in self.m.border, sum(len(members[self.points[u]]) > 1 for u in below)
            g, f = flags[-2:]
            votes = min(found[0][1], 7) if found else 0
            first = b, min(s, 3), min(len(below), 3)
            point = len(members)
            if v and self.bit("stitched", first, (b, f, g, min(s, 1)), (b, votes, f)):
                point = self.match(found, len(members))
                check(point not in taken, "a face with two corners at one point")
            else:
                members.append([])
            flags.append(int(point < len(members) - 1 or members[point] != []))
            members[point].append(v)
            self.points.append(point)

    def candidates(self, v, below, taken, members):
        """[point, votes] in their order."""
        found, looks, border = [], 0, self.m.border
        for u in below:
            for t in reversed(members[self.points[u]]):
                if looks == 256:
                    break
                looks += 1
                for w in self.m.near[t]:
                    if w >= v or looks == 256:
                        break
                    looks += 1
                    point = self.points[w]
                    if point in taken or (t == u and not {u, v, w} <= border):
                        continue
                    k = next((k for k, one in enumerate(found) if one[0] == point), len(found))
                    if k == 16:
                        continue
                    if k == len(found):
                        found.append([point, 0])
                    found[k][1] += 2 if (v in border) == (w in border) else 1
                    found.sort(key=lambda one: -one[1])  # stable
        return found

    def match(self, found, count):
        for k, (point, votes) in enumerate(found):
            rival = min(found[k + 1][1], 7) if k + 1 < len(found) else 0
            if self.bit("matched", (min(k, 7), min(votes, 15)), (min(votes, 7), rival)):
                return point
        point = self.stream.index(count)
        check(point not in [one[0] for one in found], "a candidate read as an index")
        return point

    def lower(self, f):
        """The faces across the edges of a face that come before it."""
        sides = [self.m.across[f, i] for i in range(3)]
        return [side[0] for side in sides if side and side[0] < f]

    def turn(self):
        bits = [0, 0]
        for f in range(len(self.m.faces)):
            t2, t1 = bits[-2:]
            lower = self.lower(f)
            cd = len(lower), sum(bits[2 + g] for g in lower)
            bits.append(self.bit("turned", (t1, t2), cd, (cd, t1, t2)))
        return bits[2:]

    def repeat(self, rest):
        all_counts = []
        for f in range(len(self.m.faces)):
            counts = []
            for way in range(2):
                a = min(all_counts[-1][way], 3) if f else 0
                m = min(max((all_counts[g][way] for g in self.lower(f)), default=0), 3)
                k = 0
                while rest and self.bit("repeated", (way, min(k, 3), a), (way, min(k, 3), m)):
                    k, rest = k + 1, rest - 1
                counts.append(k)
            all_counts.append(counts)
        check(rest == 0, "number of repeats")
        return all_counts

    def collapse(self, count):
        near = neighbours_of([[self.points[v] for v in f] for f in self.m.faces], self.total)
        last = 0, -1
        for _ in range(count):
            a = last[0] + self.stream.number("gap", "gap") - 1
            check(a < self.total, "a degenerate face")
            if near[a] and self.bit("adjacent", ()):
                b = near[a][self.stream.index(len(near[a]))]
            else:
                b = self.stream.index(self.total)
                check(b not in near[a], "a neighbour read as a point")
            check((a, b) >= last, "degenerate faces out of order")
            last = a, b
            self.degenerate.append(last)


class Classes:
    """§5.10: `numbers`, the class of each corner, and `counts`, how many each point has."""

    def __init__(self, payload, s):
        self.stream, self.s = Stream(payload), s
        self.r1 = self.r2 = self.several = 0
        self.at_ends = {}  # (face, place) of a half-edge: 1 or 2
        visits = self.visits()
        base, self.counts, self.numbers = 0, [], {}
        for point in range(s.total):
            here = self.classes(visits[point])
            self.numbers |= {corner: base + one for corner, one in here.items()}
            self.counts.append(len(set(here.values())))
            self.several = int(self.counts[-1] > 1)
            base += self.counts[-1]

    def place(self, f, i):
        """The place in the face of the mesh of a corner of the manifold."""
        return f, (0, 2, 1)[i] if self.s.turned[f] else i

    def visits(self):
        """For each point: (corner of the mesh, kind, half-edge, closing half-edge, like)."""
        s = self.s
        out = [[] for _ in range(s.total)]
        for v, (fan, closed) in enumerate(s.m.fans):
            closing = fan[-1] if closed else None
            for k, (f, i) in enumerate(fan):
                spoke = fan[k - 1] if k else None
                out[s.points[v]].append((self.place(f, i), int(k == 0), spoke, closing, None))
        at = len(s.m.faces)
        for f, counts in enumerate(s.repeats):
            for way in counts[0] * [0] + counts[1] * [1]:
                for i, point in enumerate(s.faces[at]):
                    like = f, (0, 2, 1)[i] if way else i
                    out[point].append(((at, i), 2, None, None, like))
                at += 1
        for f in range(at, len(s.faces)):
            for i, point in enumerate(s.faces[f]):
                out[point].append(((f, i), 3, None, None, None))
        return out

    def far(self, half_edge):
        back = half_edge and self.s.m.across[half_edge]
        return self.at_ends.get(back, 0) if back else 3

    def classes(self, visits):
        """The class of each corner of a point."""
        found = [self.far(spoke) for _, _, spoke, _, _ in visits]
        seen = found.count(2)
        seen += sum(kind == 1 and self.far(closing) == 2 for _, kind, _, closing, _ in visits)
        out, x, y, before, start = {}, 0, 0, None, 0
        for at, (corner, kind, spoke, closing, like) in enumerate(visits):
            one = 0
            if out:
                expected = out[like or before]
                rest = found[at + 1 :]
                z = rest.index(2) + 1 if 2 in rest else 0
                n = found[at:].count(0)
                numbers = found[at], min(seen, 3), min(x, 3)
                c, back = len(set(out.values())), self.far(closing)
                contexts = (
                    (kind, found[at], self.r1, self.r2),
                    (numbers, kind),
                    (numbers, min(n, 3)),
                    (found[at], min(y, 7), min(z, 7)),
                    (kind, min(c, 4), self.several, back == 2),
                )
                same = self.bit("same", *contexts)
                self.r1, self.r2 = self.r2, same
                y += y > 0
                one = expected
                if not same:
                    one, x, y = (
                        self.other(expected, c, (kind, back, min(c, 4)), found[at]),
                        x + 1,
                        1,
                    )
                if spoke:
                    self.at_ends[spoke] = 1 if same else 2
            if spoke is None:
                start = one
            if closing:
                self.at_ends[closing] = 1 if start == one else 2
            out[corner] = one
            before = corner
        return out

    def bit(self, name, *contexts):
        keys = [(name, i, context) for i, context in enumerate(contexts)]
        return self.stream.predicted(name, keys, 255)

    def other(self, expected, c, context, far):
        if c == 1 or self.bit("new", context, (min(c, 15), far)):
            return c
        one = self.stream.index(c - 1)
        return one + (one >= expected)


class Copies(Classes):
    """§5.10: `faces` over vertices, and the point of each vertex."""

    def __init__(self, payload, s, vertex_count):
        table = Bytes(payload)
        total, loose = table.varint(), table.varint()
        super().__init__(payload[table.at :], s)
        counts = self.counts
        more = self.loose(loose, total) if loose else [0] * total
        self.stream.end()
        first, base, shift = 0, 0, []
        self.points = []
        for point in range(total):
            size = max(counts[point], 1) + more[point]
            self.points += [point] * size
            shift.append(first - base)
            first, base = first + size, base + counts[point]
        check(first == vertex_count and total < vertex_count, "number of vertices")
        self.faces = [
            tuple(self.numbers[f, i] + shift[p] for i, p in enumerate(face))
            for f, face in enumerate(s.faces)
        ]

    def loose(self, rest, total):
        out = [0]
        for _ in range(total):
            k = 0
            while rest and self.bit("more", (min(k, 3), min(out[-1], 3)), min(k, 15)):
                k, rest = k + 1, rest - 1
            out.append(k)
        check(rest == 0, "number of further vertices")
        return out[1:]


# ---- Positions ------------------------------------------------------------------------------


def least_squares(delta, near, anchors, points):
    """§5.4: [L; S] x = [delta; p], by component, about the mean of its anchors, for the digits."""
    x = np.zeros_like(delta)
    for part in spec_steps.components(near):
        names, own = {v: i for i, v in enumerate(part)}, [a in set(part) for a in anchors]
        held = [names[a] for a in anchors if a in names]
        n, centre = len(part), points[own].sum(axis=0) / len(held)
        system = np.zeros((n + len(held), n))
        for i, v in enumerate(part):
            system[i, i] = len(near[v])
            system[i, [names[w] for w in near[v]]] = -1
        system[n + np.arange(len(held)), held] = 1
        right = np.concatenate((delta[part], points[own] - centre))
        x[part] = np.linalg.lstsq(system, right, rcond=None)[0] + centre
    return x


def normals(x, faces, step):
    """§5.5."""
    s, m = np.zeros_like(x), np.zeros((len(x), 1))
    for face in faces:
        a, b, c = x[list(face)]
        cross = np.cross(b - a, c - a)
        for v in face:
            s[v] += cross
            m[v] += np.linalg.norm(cross)
    return s / (np.linalg.norm(s, axis=1, keepdims=True) + 1e-3 * (m + step**2))


def positions(p, faces, near, exact, expected=None):
    """§5.3 to §5.6, §5.19, §5.22: the positions that the integers stand for."""
    origin, step = np.array([p["x"], p["y"], p["z"]]), p["step"]
    if p["method"] == LOSSLESS:
        return np.array(exact["vectors"], np.int64).view(np.float64)
    indices = [index for (index,) in exact["anchors"]]
    exponents = exact["exponents"][0] if exact["exponents"] else [0] * len(near)
    r = np.array([spec_steps.ratio(e) for e in exponents])[:, None]
    names = "vectors", "points", "isolated", "corrections"
    vectors, points, isolated, fixes = (np.array(exact[k], float).reshape(-1, 3) for k in names)
    fine = np.array(exact["refinements"], float).reshape(-1, 1)
    free = np.ones((len(vectors) - len(r), 1))
    of_vectors = np.concatenate((r, free))
    held = r[indices] if indices else free[:0]
    all_of_them = [vectors * of_vectors, points * held, isolated, fine * r[: len(fine)], fixes]
    units, of_cells = exact["units"][0] if exact["units"] else [], exact["cells"]
    for k, unit in enumerate(units):
        count = len(of_cells) // len(units)
        all_of_them.append(np.ldexp(np.array(of_cells[k * count :][:count], float), unit))
    largest = max(float(np.abs(one).max(initial=0)) for one in all_of_them)
    check(
        largest * max(step * p["coarse"], p["anchor_step"]) + max(map(abs, origin)) <= 1e152,
        "positions that are too large",
    )
    if p["method"] == CARTESIAN:
        return origin + vectors * (step * of_vectors)
    system = near, indices, origin + points * (p["anchor_step"] * held)
    y = np.zeros((2, len(indices), 3))
    if units:
        y[: len(units)] = spec_cells.added(units, of_cells, step, near, indices, r[:, 0])

    def solved(delta, stage):
        if p["interpolated"]:
            return spec_cells.interpolated(delta, *system, y[stage])
        return least_squares(delta, *system)

    delta = vectors * (p["coarse"] * step * r)
    if expected is not None:
        delta += expected
    x = solved(delta, 0)
    if p["method"] == REFINED:
        delta += fine * (step * r) * normals(x, faces, p["coarse"] * step * r)
        x = solved(delta, 1)
    if exact["corrections"]:
        x = x + step * r * fixes
    return np.concatenate((x, origin + isolated * p["anchor_step"]))


# ---- All of it ------------------------------------------------------------------------------

# §5.7, in the order of the digest
EXACT = (
    *("faces", "copied", "vectors", "anchors", "points", "isolated", "refinements", "corrections"),
    *("forms", "exponents", "units", "cells"),
)


def decode(data, cut=False, pose=None):
    """Return vertices (n, 3), faces (m, 3), or a list of polygons, and by their names integers.

    Vertices are those of a pose, where one is named; attributes those at rest. The integers are
    those of the digest; "attributes" are `spec_attributes.Decoded`; "told" is what PART
    tells, with the precision of the source; "stage" is that of a file which may be cut; "frames"
    are the vertices of further frames.
    """
    import spec_attributes  # which is made of what is here

    vertex_count, face_count, sections, following = container(data, cut)
    stage, p = as_far(parameters(sections["PARM"], vertex_count), sections, following)
    if "meta" in sections:
        check_meta(sections["meta"])
    total = vertex_count
    if "COPY" in sections:
        total = Bytes(sections["COPY"]).varint()
        check(p["isolated"] <= total < vertex_count, "counts of COPY")
    n, m = total - p["isolated"], face_count
    if "STCH" in sections:
        table = Bytes(sections["STCH"])
        n, m = table.varint(), table.varint()
        check(total - p["isolated"] <= n <= 3 * m and m <= face_count, "counts of STCH")
    geometry = {CARTESIAN: "CART", LOSSLESS: "EXAC"}.get(p["method"], "ANCH")
    # §5.18
    held = {
        "CONN": m,
        geometry: p["isolated"] * (3 if p["method"] == LOSSLESS else 1),
        "STCH": face_count - m,
        "COPY": vertex_count - total,
    }
    lacking = 0
    for name, elements in held.items():
        bytes_needed = (elements + 15199) // 15200 - 4
        lacking += max(0, bytes_needed - len(sections.get(name, b"")))
    if lacking or "FILL" in sections:
        check(lacking and sections.get("FILL") == bytes(lacking), "bytes of FILL")
    faces = Region(sections["CONN"], n, m).faces
    points, used = range(total), total - p["isolated"]
    surface = final = faces
    if {"STCH", "COPY", "POLY", "ATTR"} & set(sections):
        manifold = Manifold(faces, n)
        stitching = Stitching(sections.get("STCH"), manifold, used, total, face_count)
        surface, final = stitching.surface, stitching.faces
    exact = {name: [] for name in (*EXACT, "attributes")}
    if "COPY" in sections:
        copies = Copies(sections["COPY"], stitching, vertex_count)
        points, final = copies.points, copies.faces
        exact["copied"] = [points]
    exact["faces"] = final
    near, across, glued = neighbours_of(surface, used), {}, [-1] * (3 * face_count)
    if "POLY" in sections:
        across = in_mesh(manifold, stitching.turned)
        glue = Glue(sections["POLY"], final, across)
        glued = glue.glued
        near = seen_neighbours(surface, manifold, across, glued, stitching.turned, used)
    ends, corners = list(chain(*final)), polygons(final, glued)
    rows = [[ends[fan[0]] for fan in polygon] for polygon in corners]
    inner = inner_parallelograms([[points[v] for v in row] for row in rows])
    exponents = [0] * len(near)
    if "STEP" in sections:
        exponents = spec_steps.exponents(sections["STEP"], p["step"], near)
        exact["exponents"] = [exponents]
    if p["method"] in (CARTESIAN, LOSSLESS):
        mesh = surface, near + [[] for _ in range(p["isolated"])], inner
        if "STEP" in sections:
            found = rooted_points(sections[geometry], *mesh, exponents)
        else:
            read = grid_points if p["method"] == CARTESIAN else coordinates
            found = read(sections[geometry], *mesh)
        exact["vectors"], exact["forms"] = found
    else:
        exact |= read_anchors(sections["ANCH"], p, near, exponents)
        exact["vectors"] = [(0, 0, 0)] * len(near)
        if "DELT" in sections:
            exact["vectors"] = deltas(sections["DELT"], p["step"], near)
    if p["method"] == REFINED:
        exact["refinements"] = refinements(sections["NORM"], near, exact["vectors"])
    if "CELL" in sections:
        stages, anchors = (2 if p["method"] == REFINED else 1), [v for (v,) in exact["anchors"]]
        units, many = spec_cells.units_of(sections["CELL"], stages, p, near, anchors)
        exact["units"], exact["cells"] = [units], vectors_of(sections["CELL"][stages:], [[]] * many)
        check(any(map(any, exact["cells"])), "vectors of cells that are all 0")
    if "FIXS" in sections:
        check(p["step"] > 0, "corrections without a step")
        exact["corrections"] = vectors_of(sections["FIXS"], near)
    triangles = [[points[v] for v in face] for face in final]
    of_triangle = {h // 3: i for i, row in enumerate(corners) for fan in row for h in fan}
    near_faces = neighbours_of_faces(triangles, [of_triangle[f] for f in range(face_count)])
    if "ATTR" in sections:
        mesh = spec_attributes.Mesh(vertex_count, final, corners, near_faces, stitching)
        exact["attributes"] = spec_attributes.read_attributes(sections["ATTR"], mesh)
    kept, told = [], ([], {}, [], b"")
    if "PART" in sections:
        told = read_parts(sections["PART"], near_faces)
    if "ORDR" in sections:
        kept = read_order(sections["ORDR"], final, corners, vertex_count)
    found, of_surface = {}, (near, [v for (v,) in exact["anchors"]])
    if "POSE" in sections:
        found = spec_poses.poses(sections["POSE"], *of_surface, vectors_of)
    words = [struct.pack("<q", x) for name in EXACT for row in exact[name] for x in row]
    words += [struct.pack("<q", x) for x in chain(*kept, glued if "POLY" in sections else ())]
    words += [struct.pack("<q", x) for one in exact["attributes"] for x in one.digest()]
    words += [struct.pack("<q", x) for x in told[3]]
    for _, _, of_face, transforms in told[0]:
        words += [struct.pack("<q", x) for x in of_face] + (transforms or [])
    words += [struct.pack("<q", x) for x in spec_poses.words(found)]
    digest = hashlib.blake2b(b"".join(words), digest_size=8).digest()
    check("CHEK" not in sections or digest == sections["CHEK"], "digest")
    exact["stage"] = stage
    rest = positions(p, surface, near, exact)
    exact["frames"] = []
    if "FRAM" in sections:
        import spec_frames  # likewise

        mesh = surface, near + [[] for _ in range(p["isolated"])], inner
        further = spec_frames.frames(sections["FRAM"], p, near, mesh, surface, exact, rest)
        exact["frames"] = [frame[list(points)] for frame in further]
    x = rest[list(points)]
    exact["attributes"] = [one.decoded(x) for one in exact["attributes"]]
    if pose is not None:
        moved, _ = spec_poses.posed(found[pose], rest[:used], *of_surface)
        x = np.concatenate((moved, rest[used:]))[list(points)]
    if kept:
        order, polygon_order, begins = kept
        sources = spec_attributes.sources(kept, rows)
        exact["attributes"] = [one.taken(sources) for one in exact["attributes"]]
        x, names = x[order], {v: i for i, v in enumerate(order)}
        exact["frames"] = [frame[order] for frame in exact["frames"]]
        pairs = zip(polygon_order, begins, strict=True)
        rows = [[names[v] for v in rows[i][k:] + rows[i][:k]] for i, k in pairs]
        divisions = [(*part[:2], [part[2][i] for i in polygon_order], part[3]) for part in told[0]]
        told = divisions, *told[1:]
    exact["told"] = *told[:3], "float32" if p["flags"] & 2 else "float64"
    return x, rows if "POLY" in sections else np.array(rows), exact
