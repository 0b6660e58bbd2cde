"""Slow, obvious twins of the kernels of polygons, over sets, dictionaries and searches."""

from __future__ import annotations

import collections
import itertools


def after(h):
    return h - h % 3 + (h + 1) % 3


def before(h):
    return h - h % 3 + (h + 2) % 3


class Merging:
    """Triangles that are merged one by one; `ends` are the vertices of each half-edge."""

    def __init__(self, faces, candidate):
        corners = [v for face in faces for v in face]
        self.ends = [(corners[h], corners[after(h)]) for h in range(len(corners))]
        self.candidate = {h: g for h, g in enumerate(candidate) if g >= 0}
        self.open, self.merged = set(self.candidate), {}
        self.numbers = collections.defaultdict(itertools.count().__next__)

    def polygon(self, h):
        """The faces that are merged with that of h, one over the other."""
        found, todo = set(), [h // 3]
        while todo:
            face = todo.pop()
            if face not in found:
                found.add(face)
                todo += [
                    self.merged[g] // 3 for g in range(3 * face, 3 * face + 3) if g in self.merged
                ]
        return found

    def size(self, h):
        return len(self.polygon(h)) + 2

    def opened(self, h):
        return sum(g // 3 in self.polygon(h) for g in self.open)

    def may(self, h, g, most):
        return g // 3 not in self.polygon(h) and self.size(h) + self.size(g) - 2 <= most

    def glue(self, h, g):
        self.merged[h], self.merged[g] = g, h

    def bit(self, coder, bit, mixer, contexts):
        slots = [self.numbers[mixer, i, context] for i, context in enumerate(contexts)]
        return coder.bit(bit, slots, mixer)

    def expected(self, v, own):
        """How many edges are still to be hidden at v, if it is one of quads; how many are left."""
        pairs = {frozenset((h, self.candidate[h])) for h in self.open}
        left = sum(self.ends[min(pair)].count(v) for pair in pairs)
        seen = {frozenset(p) for p in self.candidate.items()} - pairs
        alone = [h for h in range(len(self.ends)) if h not in self.candidate]
        count = sum(self.ends[min(p)].count(v) for p in seen if min(p) not in self.merged)
        count += sum(self.ends[h].count(v) for h in alone)
        border = any(v in self.ends[h] for h in alone)
        return min(max(count + left + border - 4, -1), 3), min(left - own, 3)

    def beyond(self, h):
        def look(e, like):
            if e not in self.candidate or e in self.open:
                return 0
            if e in self.merged:
                return 4
            g = self.candidate[e]
            other = before if like is after else after
            return 1 if like(g) in self.merged else 2 if other(g) in self.merged else 3

        return look(after(h), before), look(before(h), after)

    def code_hidden(self, coder, wanted, least, most, explicit):
        for h in range(len(self.ends)):
            g = self.candidate.get(h)
            if g is None or h not in self.open or g // 3 > h // 3:
                continue
            bit = int(wanted.get(h) == g)
            x, y, i, j = self.size(h), self.size(g), self.opened(h), self.opened(g)
            if not self.may(h, g, most):
                bit = 0
            elif not explicit and ((x < least and i == 1) or (y < least and j == 1)):
                bit = 1
            else:
                joined = x > 3, y > 3
                (a, b), p, q = self.ends[h], self.ends[before(h)][0], self.ends[before(g)][0]
                contexts = [
                    (min(x, 6), min(y, 6), min(i, 4), min(j, 4)),
                    (self.expected(a, 1), self.expected(b, 1), joined),
                    (self.expected(p, 0), self.expected(q, 0), joined),
                    (self.beyond(h), self.beyond(g), joined),
                ]
                bit = self.bit(coder, bit, 0, contexts)
            self.open -= {h, g}
            if bit:
                self.glue(h, g)

    def code_explicit_pairs(self, coder, wanted, most, total, code_below):
        """Return whether it comes to the total."""
        bits = [0, 0, 0, 0]
        for h, (a, b) in enumerate(self.ends):
            across = [g for g, ends in enumerate(self.ends) if ends == (b, a)]
            live = [g for g in across if g > h and g not in self.merged]
            if not total or h in self.merged or self.size(h) >= most or not live:
                continue
            fit = [g for g in live[:64] if self.may(h, g, most)][:16]
            x, n = min(self.size(h), 6), min(len(fit), 3)
            contexts = [(x, n, h % 3), (x, *bits[-4:]), (x, n, h in self.candidate)]
            bits.append(self.bit(coder, int(h in wanted), 1, contexts))
            if not bits[-1]:
                continue
            for k, g in enumerate(fit):
                y = min(self.size(g), 6)
                contexts = [(min(k, 7), min(len(fit) - 1 - k, 3)), (y, h % 3, g % 3)]
                if self.bit(coder, int(wanted.get(h) == g), 2, contexts):
                    break
            else:
                rank = across.index(wanted[h]) if wanted else 0
                g = across[code_below(coder, rank, len(across))]
                if g not in live or g in fit or not self.may(h, g, most):
                    return False
            self.glue(h, g)
            total -= 1
        return total == 0


def candidates(faces, manifold, opposite, reversed_):
    """The candidate of each half-edge, -1 without; `manifold` is how many faces are of it."""
    corners = [v for face in faces for v in face]
    ends = [(corners[h], corners[after(h)]) for h in range(len(corners))]

    def of_mesh(h):
        return 3 * (h // 3) + 2 - h % 3 if reversed_[h // 3] else h

    found = {}
    for h in range(3 * manifold):
        g = opposite[h]
        if g >= 0 and ends[of_mesh(h)] == ends[of_mesh(g)][::-1]:
            found[of_mesh(h)] = of_mesh(g)
    rest = collections.defaultdict(list)
    for h, (a, b) in enumerate(ends):
        if h not in found and a != b:
            rest[a, b].append(h)
    for (a, b), halfedges in rest.items():
        found |= dict(zip(halfedges, rest.get((b, a), []), strict=False))
    return [found.get(h, -1) for h in range(len(ends))]


def outlines(merged):
    """The polygons as lists of corners: the one outside, and those of all triangles there."""
    count = len(merged)
    inner = {h: g for h, g in enumerate(merged) if g >= 0}
    # Corners that are one: where a half-edge begins, and where the one ends that it is merged with.
    same = {h: {h} for h in range(count)}
    for h, g in inner.items():
        both = same[h] | same[after(g)]
        for corner in both:
            same[corner] = both
    found, done = [], set()
    for face in range(count // 3):
        if face in done:
            continue
        start = max(range(3 * face, 3 * face + 3), key=lambda h: (len(same[h]), -h))
        outline, corner = [], same[start]
        while not outline or corner is not same[start]:
            (outside,) = [h for h in corner if h not in inner]
            outline.append((outside, corner))
            done |= {h // 3 for h in corner}
            corner = same[after(outside)]
        found.append(outline)
    return found


def choose(near, cut):
    """Diagonals breadth first; `near[q]` has (quad, whether to differ), `cut` what is given."""
    votes = collections.Counter()
    done, cut = set(), list(cut)
    for seed in range(len(cut)):
        queue = [] if seed in done else [seed]
        done.add(seed)
        for q in queue:
            if cut[q] < 0:
                cut[q] = int(votes[q, 1] > votes[q, 0])
            for r, unlike in near[q]:
                votes[r, cut[q] ^ unlike] += 1
                if r not in done:
                    done.add(r)
                    queue.append(r)
    return cut
