"""§5.16 of `formats/SPEC.md`, to be read beside it: labels of vertices, classes or faces."""

from __future__ import annotations

from spec_coder import Stream, check, slot


def j(x, *rest):
    for y in rest:
        x = 0x2C1B3C6D * x + y
    return x


class Labels:
    """The labels so far, and what was learnt from them."""

    def __init__(self, payload, neighbours):
        self.stream, self.near = Stream(payload), neighbours
        self.read, self.count = [], 0  # n
        self.match, self.length, self.noted = None, 0, {}
        self.firsts, self.expecteds, self.news = [0] * 6, [0] * 3, [0] * 4  # H, G, N

    def bit(self, mixer, *contexts):
        keys = [slot(i, x) % (1 << 18) for i, x in contexts]
        return self.stream.predicted(mixer, keys, 255)

    def back(self, i, steps):
        return self.read[i - steps] if i >= steps else -1

    def next(self):
        i = len(self.read)
        expected = None if self.match is None else self.read[self.match]
        votes, candidates, ahead = self.candidates(i, expected)
        label = self.candidate(i, expected, votes, candidates, ahead)
        if candidates:
            self.firsts = [*self.firsts[1:], int(label == candidates[0])]
        if label is None:
            label = self.another(i, candidates)
        if expected is not None:
            self.expecteds = [*self.expecteds[1:], int(label == expected)]
        self.count = max(self.count, label + 1)
        self.read.append(label)
        self.follow(i, expected)

    def candidates(self, i, expected):
        known = [v for v in self.near[i] if v < i][-8:]
        votes, found = {}, []
        for v in reversed(known):
            label = self.read[v]
            votes[label] = votes.get(label, 0) + 1
            if label not in found:
                found.append(label)
            found.sort(key=lambda one: -votes[one])  # stable
        above = [v for v in self.near[i] if v > i]
        ahead = [self.read[w] for v in above for w in self.near[v] if w < i][:16]
        before = [self.back(i, 1)] if i else []
        for label in (*before, *([] if expected is None else [expected]), *ahead):
            if label not in found:
                found.append(label)
        return votes, found, ahead

    def candidate(self, i, expected, votes, candidates, ahead):
        """The candidate that is the label, None if it is another."""
        k, c, b = sum(votes.values()), len(candidates), self.back(i, 1)
        H, G = (int("".join(map(str, bits)), 2) for bits in (self.firsts, self.expecteds))
        L = self.length
        for r, label in enumerate(candidates):
            v, third = votes.get(label, 0), min(r, 3)
            w, l = (0 if v == 0 else 1 if v < k else 2), int(label == b)  # noqa: E741
            o = candidates[0] if r else candidates[1] if c > 1 else -1
            e = 0 if expected is None else 1 if label == expected else 2
            s = ahead.count(label)
            d = len(ahead) - s
            F = 2 * (4 * min(s, 3) + min(d, 3)) + l
            slope = 3 * min(s, 2) + min(d, 2)
            contexts = (
                2 * (4 * (8 * (16 * min(v, 7) + k) + min(c - r, 4)) + third) + l,
                4 * (3 * (8 * min(L, 15) + G) + e) + third,
                j(label, b, self.back(i, 2)),
                j(label, o, F),
                4 * (8 * F + min(v, 7)) + min(k, 3),
                9 * (2 * (3 * (4 * H + third) + w) + l) + slope,
                8 * (3 * (2 * e + l) + w) + min(L, 7),
            )
            if self.bit(("candidate", min(r, 2)), *enumerate(contexts)):
                return label
        return None

    def another(self, i, candidates):
        n, b = self.count, self.back(i, 1)
        new = 1
        if len(candidates) < n:
            N = int("".join(map(str, self.news)), 2)
            new = self.bit("new", (8, N), (9, 2 * (N % 4) + (b == n - 1)), (10, b))
        self.news = [*self.news[1:], new]
        if new:
            return n
        y = z = 0
        while y + (1 << z) < n:
            Y = (1 << z) + y  # noqa: N806
            contexts = (12, Y), (13, j(Y, b)), (14, j(Y, candidates[0]))
            y += self.bit(("number", z), *contexts) << z
            z += 1
        check(y not in candidates, "a candidate read as another label")
        return y

    def follow(self, i, expected):
        if self.match is not None:
            right = self.read[i] == expected
            self.match, self.length = (self.match + 1, self.length + 1) if right else (None, 0)
        if i >= 3:
            number = slot(16, j(*(self.read[i - k] for k in range(4)))) % (1 << 16)
            if self.match is None:
                self.match = self.noted.get(number)
            self.noted[number] = i + 1


def labels(payload, neighbours):
    """The label of each element; `neighbours` has those of each, ascending."""
    reader = Labels(payload, neighbours)
    for _ in neighbours:
        reader.next()
    reader.stream.end()
    return reader.read
