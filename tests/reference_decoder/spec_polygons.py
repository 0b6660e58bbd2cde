"""§5.13 of `formats/SPEC.md`, to be read beside it: faces that are glued to polygons."""

from __future__ import annotations

from spec_coder import Bytes, Stream, check, clamp


def after(h):
    return h - h % 3 + (h + 1) % 3


def before(h):
    return h - h % 3 + (h + 2) % 3


def in_mesh(manifold, turned):
    """The half-edge of the mesh across from each of the manifold's faces, None without one."""

    def half_edge(f, i):
        return 3 * f + (2 - i if turned[f] else i)

    pairs = manifold.across.items()
    return {half_edge(*side): back and half_edge(*back) for side, back in pairs}


class Glue:
    """What POLY says; `glued` has the half-edge that each one is glued to, -1 for none."""

    def __init__(self, payload, faces, across):
        table = Bytes(payload)
        self.count, self.least, self.most, self.listed = (table.varint() for _ in range(4))
        m = len(faces)
        check(1 <= self.count < m and self.listed <= m - self.count, "counts of POLY")
        check(3 <= self.least <= self.most <= m + 2, "sizes of POLY")
        self.stream = Stream(payload[table.at :])
        self.ends = [(face[c], face[(c + 1) % 3]) for face in faces for c in range(3)]
        self.named = {}  # the half-edges that each pair of ends and each vertex names
        for h, ends in enumerate(self.ends):
            for key in {ends, *ends}:
                self.named.setdefault(key, []).append(h)
        self.glued, self.open = [-1] * (3 * m), [False] * (3 * m)
        self.polygon = {f: [f] for f in range(m)}  # the faces of the polygon of each face
        self.pair(across)
        self.hide()
        if self.listed:
            self.list()
        self.stream.end()
        sizes = [len(faces) + 2 for f, faces in self.polygon.items() if f == min(faces)]
        check(len(sizes) == self.count, "number of polygons")
        check((min(sizes), max(sizes)) == (self.least, self.most), "sizes of the polygons")

    def pair(self, across):
        self.partner = [-1] * len(self.ends)
        for h, g in across.items():
            if g is not None and self.ends[h] == self.ends[g][::-1]:
                self.partner[h] = g
        ways = {}
        for h, ends in enumerate(self.ends):
            if self.partner[h] < 0 and ends[0] != ends[1]:
                ways.setdefault(ends, []).append(h)
        for ends in ways:
            if ends[0] < ends[1]:
                for h, g in zip(ways[ends], ways.get(ends[::-1], []), strict=False):
                    self.partner[h], self.partner[g] = g, h

    def bit(self, name, *contexts):
        keys = [(name, i, context) for i, context in enumerate(contexts)]
        return self.stream.predicted(name, keys, 255)

    def size(self, h):
        return len(self.polygon[h // 3]) + 2

    def allowed(self, h, g):
        one = self.polygon[h // 3] is self.polygon[g // 3]
        return not one and self.size(h) + self.size(g) - 2 <= self.most

    def openings(self, h):
        return sum(self.open[3 * f + c] for f in self.polygon[h // 3] for c in range(3))

    def glue(self, h, g):
        self.glued[h], self.glued[g] = g, h
        joined = self.polygon[h // 3] + self.polygon[g // 3]
        for f in joined:
            self.polygon[f] = joined

    # The first pass: partners

    def hide(self):
        self.open = [g >= 0 for g in self.partner]
        for h, g in enumerate(self.partner):
            if g < 0 or g // 3 > h // 3 or not self.open[h]:
                continue
            if self.allowed(h, g):
                forced = any(self.size(e) < self.least and self.openings(e) == 1 for e in (h, g))
                glued = (not self.listed and forced) or self.hidden(h, g)
            else:
                glued = False
            self.open[h] = self.open[g] = False
            if glued:
                self.glue(h, g)

    def hidden(self, h, g):
        x, y = (min(self.size(e), 6) for e in (h, g))
        i, j = (min(self.openings(e), 4) for e in (h, g))
        J = x > 3, y > 3  # noqa: N806
        a, b = (self.ends[e][0] for e in (h, g))
        p, q = (self.ends[before(e)][0] for e in (h, g))
        return self.bit(
            "hidden",
            (x, y, i, j),
            (self.around(a, 1), self.around(b, 1), J),
            (self.around(p, 0), self.around(q, 0), J),
            (self.beside(h), self.beside(g), J),
        )

    def around(self, v, less):
        """E(v) for `less` = 1, F(v) for `less` = 0."""
        l = s = alone = 0  # noqa: E741
        for h in self.named[v]:
            g, here = self.partner[h], self.ends[h].count(v)
            if g < 0:
                s, alone = s + here, alone or here > 0
            elif h < g:
                l += here * self.open[h]  # noqa: E741
                s += here * (not self.open[h] and self.glued[h] < 0)
        return clamp(s + l - 4 + alone, -1, 3), min(l - less, 3)

    def beside(self, h):
        """A(h)."""
        return self.known(after(h), before), self.known(before(h), after)

    def known(self, e, named):
        """B(e, f)."""
        g = self.partner[e]
        if g < 0 or self.open[e]:
            return 0
        if self.glued[e] >= 0:
            return 4
        if self.glued[named(g)] >= 0:
            return 1
        return 2 if max(self.glued[after(g)], self.glued[before(g)]) >= 0 else 3

    # The second pass: pairs that are listed

    def list(self):
        bits, rest = (0, 0, 0, 0), self.listed
        for h, (u, v) in enumerate(self.ends):
            if not rest:
                break
            across = self.named.get((v, u), [])
            live = [g for g in across if self.glued[g] < 0 and g > h]
            if self.glued[h] >= 0 or self.size(h) >= self.most or not live:
                continue
            fits = [g for g in live[:64] if self.allowed(h, g)][:16]
            x, n = min(self.size(h), 6), min(len(fits), 3)
            third = x, n, self.partner[h] >= 0
            bit = self.bit("listed", (x, n, h % 3), (x, bits), third)
            bits = *bits[1:], bit
            if bit:
                rest -= 1
                self.glue(h, self.chosen(h, across, live, fits))
        check(rest == 0, "pairs that are listed")

    def chosen(self, h, across, live, fits):
        n = len(fits)
        for k, g in enumerate(fits):
            y = min(self.size(g), 6)
            if self.bit("chosen", (min(k, 7), min(n - 1 - k, 3)), (y, h % 3, g % 3)):
                return g
        g = across[self.stream.index(len(across))]
        check(g in live and self.allowed(h, g) and g not in fits, "a pair")
        return g


def corners_at(h, glued):
    """The corners of faces that are one of their polygon, where h begins; the polygon's first."""
    fan = [h]
    while glued[fan[0]] >= 0:
        fan.insert(0, after(glued[fan[0]]))
    while glued[before(fan[-1])] >= 0:
        fan.append(glued[before(fan[-1])])
    return fan


def polygons(faces, glued):
    """Of each polygon the corners, each with its corners of faces, the polygon's own first."""
    found, taken = [], set()
    for f in range(len(faces)):
        if f in taken:
            continue
        starts = [corners_at(3 * f + c, glued) for c in range(3)]
        sizes = [len(fan) for fan in starts]
        polygon = [starts[sizes.index(max(sizes))]]
        while True:
            h = after(polygon[-1][0])
            while glued[h] >= 0:
                h = after(glued[h])
            if h == polygon[0][0]:
                break
            polygon.append(corners_at(h, glued))
        found.append(polygon)
        taken |= {h // 3 for fan in polygon for h in fan}
    return found


def neighbours_of_polygons(rows, n):
    """Vertices that follow each other in a polygon."""
    graph = [set() for _ in range(n)]
    for row in rows:
        for v, w in zip(row, [*row[1:], row[0]], strict=True):
            if v != w:
                graph[v].add(w)
                graph[w].add(v)
    return [sorted(near) for near in graph]


def seen_neighbours(surface, manifold, across, glued, turned, n):
    """§5.4: the graph of the faces without the edges that are hidden everywhere."""
    graph = [set() for _ in range(n)]
    for f, i in manifold.across:
        h = 3 * f + (2 - i if turned[f] else i)
        if across[h] is None or glued[h] != across[h]:
            v, w = surface[f][i], surface[f][(i + 1) % 3]
            graph[v].add(w)
            graph[w].add(v)
    return [sorted(near) for near in graph]


def inner_parallelograms(rows):
    """§5.6: of each vertex i the (a, b, o), in the order of the polygons."""
    found = {}
    for row in rows:
        for k, i in enumerate(row):
            a, b, o = (row[(k + turn) % 4] for turn in (3, 1, 2)) if len(row) == 4 else (i,) * 3
            if max(a, b, o) < i:
                found.setdefault(i, []).append((a, b, o))
    return found
