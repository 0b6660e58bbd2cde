"""Slow, obvious twins of the fast code: Python integers, dense matrices, loops over everything."""

from __future__ import annotations

import collections
import itertools
import math

import numpy as np

# ---- Laplacian, anchors, metrics, correspondence --------------------------------------------


def laplacian(faces, n):
    """D - A, entry by entry."""
    matrix = np.zeros((n, n))
    for face in faces:
        for a, b in itertools.permutations(face, 2):
            if a != b:
                matrix[a, b] = -1.0
    return matrix - np.diag(matrix.sum(axis=1))


def least_squares(matrix, anchors, delta, positions):
    """Dense [L; S] x = [delta; c] in the least-squares sense."""
    S = np.eye(len(matrix))[anchors]
    return np.linalg.lstsq(
        np.concatenate((matrix, S)), np.concatenate((delta, positions)), rcond=None
    )[0]


def solve_by_elimination(matrix, b):
    """Solve a dense system by elimination, row by row, and by substitution."""
    M, x = matrix.astype(float), b.astype(float)
    n = len(M)
    for k in range(n):
        for i in range(k + 1, n):
            if M[i, k]:
                share = M[i, k] / M[k, k]
                M[i, k:] -= share * M[k, k:]
                x[i] -= share * x[k]
    for k in reversed(range(n)):
        x[k] = (x[k] - M[k, k + 1 :] @ x[k + 1 :]) / M[k, k]
    return x


def factor_entries(matrix, order):
    """Entries of the triangular factor, by playing the elimination game on a dense matrix."""
    filled = matrix.toarray()[order][:, order] != 0
    for i in range(len(filled)):
        below = np.flatnonzero(filled[i + 1 :, i]) + i + 1
        filled[np.ix_(below, below)] = True
    return int(np.tril(filled).sum())


def solution_by_component(matrix, anchors, delta, positions):
    """The least-squares solution of each component by itself, about the mean of its anchors."""
    x = np.zeros_like(delta)
    for first in lowest_of_components(matrix):
        part = np.flatnonzero(np.array(graph_distances(matrix, [first])) < len(matrix))
        own = np.isin(anchors, part)
        centre = positions[own].mean(axis=0)
        held = np.searchsorted(part, anchors[own])
        right = delta[part], positions[own] - centre
        x[part] = least_squares(matrix[np.ix_(part, part)], held, *right) + centre
    return x


def graph_distances(matrix, sources):
    """Edges from each vertex to the nearest source; n where there is none."""
    n = len(matrix)
    distance, ring, steps = [n] * n, set(sources), 0
    while ring:
        for v in ring:
            distance[v] = steps
        ring = {w for v in ring for w in np.flatnonzero(matrix[v] < 0) if distance[w] == n}
        steps += 1
    return distance


def lowest_of_components(matrix):
    """The vertices that no lower one is connected to."""
    n = len(matrix)
    return [v for v in range(n) if min(graph_distances(matrix, [v])[:v], default=n) == n]


def farthest(matrix, k):
    """Farthest points, all distances from scratch for each of them."""
    anchors = lowest_of_components(matrix)
    while len(anchors) < min(k, len(matrix)):
        anchors.append(int(np.argmax(graph_distances(matrix, anchors))))
    return anchors


def splitmix64(seed, count):
    """The generator as published, in Python integers."""
    mask, state, outputs = 2**64 - 1, seed, []
    for _ in range(count):
        state = (state + 0x9E3779B97F4A7C15) & mask
        z = state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        outputs.append(z ^ (z >> 31))
    return outputs


def greedy_errors(matrix, vertices, delta, anchors, positions):
    """Vertex errors of the dense reconstruction from delta and anchors, 0 at the anchors."""
    x = least_squares(matrix, anchors, delta, positions[anchors])
    errors = np.linalg.norm(x - vertices, axis=1)
    errors[anchors] = 0.0
    return errors


def squared_to_triangle(p, triangle):
    """Squared distance by minimizing over the barycentric coordinates of the four cases."""
    best = min(float(((p - corner) ** 2).sum()) for corner in triangle)
    for a, b in itertools.combinations(triangle, 2):
        if (a != b).any():
            t = (p - a) @ (b - a) / ((b - a) @ (b - a))
            if 0 <= t <= 1:
                best = min(best, float(((p - a - t * (b - a)) ** 2).sum()))
    a, edges = triangle[0], (triangle[1:] - triangle[0]).T
    if np.linalg.matrix_rank(edges) == 2:
        s = np.linalg.lstsq(edges, p - a, rcond=None)[0]
        if (s >= 0).all() and s.sum() <= 1:
            best = min(best, float(((p - a - edges @ s) ** 2).sum()))
    return best


def largest_squared_distance(points, triangles):
    """Of each point from its nearest triangle, the largest."""
    return max(min(squared_to_triangle(p, t) for t in triangles) for p in points)


def dihedral_angles(V, faces):
    """Oriented angle in degrees between the normals at each edge of two faces; edge -> angle."""
    around = {}
    for face in faces:
        for a, b in zip(face, np.roll(face, -1), strict=True):
            around.setdefault(frozenset((int(a), int(b))), []).append((face, V[b] - V[a]))
    angles = {}
    for edge, sides in around.items():
        if len(sides) == 2:
            m, k = (np.cross(V[f[1]] - V[f[0]], V[f[2]] - V[f[0]]) for f, _ in sides)
            cosine = m @ k / np.sqrt((m @ m) * (k @ k))
            sign = np.sign(np.cross(m, k) @ sides[0][1])
            angles[edge] = sign * np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    return angles


# ---- Range coder ----------------------------------------------------------------------------


class RangeCoder:
    """The coder with mixing as its definition reads, in integers without a width.

    Encoding keeps one number of any length, so that a carry is an addition and nothing is held
    back. `slots` and `mixers` are as of `entropy.encoder`; `data` is what a decoder reads.
    """

    def __init__(self, tables, slots, mixers, weight_sum, data=None):
        self.stretch, self.squash, self.rate = (table.tolist() for table in tables)
        self.slots = [(1 << 21, 0)] * slots  # probability of a one in 2^-22, observations
        sums = [1.0 if n == 1 else weight_sum for n, _ in mixers]
        self.weights = [[round(65536 * s / n)] * n for s, (n, _) in zip(sums, mixers, strict=True)]
        self.limits = [limit for _, limit in mixers]
        self.seen = [0] * len(mixers)
        self.decoding = data is not None
        self.low, self.span, self.shifted = 0, 2**32 - 1, 0
        if self.decoding:
            self.data, self.position = data, 4
            self.code = int.from_bytes(data[:4].ljust(4, b"\0"), "big")

    def _code(self, bit, p):
        """Code a bit that is one with probability p / 65536: ones have the lower part."""
        bound = (self.span >> 16) * p
        if self.decoding:
            bit = int(self.code < bound)
            self.code -= 0 if bit else bound
        elif not bit:
            self.low += bound
        self.span = bound if bit else self.span - bound
        while self.span < 2**24:
            self.span *= 256
            self.low *= 256
            self.shifted += 1
            if self.decoding:
                self.code = 256 * self.code + sum(self.data[self.position : self.position + 1])
                self.position += 1
        return bit

    def raw(self, value, bits):
        coded = [self._code((value >> i) & 1, 32768) for i in reversed(range(bits))]
        return sum(bit << i for i, bit in enumerate(reversed(coded)))

    def bit(self, bit, contexts, mixer):
        weights = self.weights[mixer]
        inputs = [self.stretch[self.slots[c][0] >> 10] for c in contexts]
        dot = sum(w * x for w, x in zip(weights, inputs, strict=True)) >> 16
        p = self.squash[min(max(dot, -2047), 2047) + 2048]
        bit = self._code(bit, p)
        half = 2**13 if self.seen[mixer] < 300 else 2**14
        self.seen[mixer] += 1
        for i, (c, x) in enumerate(zip(contexts, inputs, strict=True)):
            weights[i] += (x * (65536 * bit - p) + half) // (2 * half)
            probability, count = self.slots[c]
            probability += (((bit << 22) - probability) * self.rate[count]) >> 16
            self.slots[c] = probability, min(count + 1, self.limits[mixer])
        return bit

    def finish(self):
        """The number of most zeros at the end in [low, low + span), without them."""
        for bits in (32, 24, 16, 8, 0):
            rounded = -(-self.low >> bits) << bits
            if rounded < self.low + self.span:
                return rounded.to_bytes(4 + self.shifted, "big").rstrip(b"\0")


def code_below(coder, value, bound):
    """The twin of valence.code_below: the fewest bits, or one more."""
    bits = bound.bit_length() - 1
    short = (2 << bits) - bound
    if not coder.decoding:
        coder.raw(value if value < short else value + short, bits + (value >= short))
        return value
    first = coder.raw(0, bits)
    return first if first < short else 2 * first + coder.raw(0, 1) - short


# ---- Connectivity ---------------------------------------------------------------------------


class Node:
    """An appearance of a vertex on a front, with the half-edge of the face beyond its gate."""

    def __init__(self, vertex):
        self.vertex, self.free, self.waiting_since = vertex, None, None
        self.next, self.previous, self.gate = None, None, None


class RegionGrower:
    """The visit of `kernels.connectivity`, with dictionaries and searches over everything.

    `grow()` gives the faces in new labels, and the old vertex of each new label. Before each step,
    the free edges of all nodes are counted in the mesh.
    """

    def __init__(self, faces):
        faces = [tuple(map(int, f)) for f in faces]
        self.left = {(f[i - 2], f[i - 1]): f[i] for f in faces for i in range(3)}
        self.face_of = {(f[i - 1], f[i]): at for at, f in enumerate(faces) for i in range(3)}
        self.todo = dict(enumerate(faces))
        self.degree = collections.Counter(a for a, _ in self.left)
        self.live, self.owner, self.clock = [], {}, 0
        self.faces, self.label = [], {}

    def grow(self):
        while self.todo:
            assert all(node.free == self.count_free(node) for node in self.live)
            if not self.live:
                self.begin(next(iter(self.todo.values())))
                continue
            # The fewest free edges; of these, the one that has had so many for longest.
            pivot = min(self.live, key=lambda node: (min(node.free, 63), node.waiting_since))
            if pivot.free == 0:
                self.close(pivot)
            else:
                self.expand(pivot)
        assert not self.live
        return [tuple(self.label[v] for v in f) for f in self.faces], list(self.label)

    def count_free(self, node):
        """Turn about a node from its gate to the gate before: the edges passed."""
        end, passed = self.left[node.vertex, node.next.vertex], 0
        while self.face_of[node.vertex, end] in self.todo:
            end, passed = self.left[node.vertex, end], passed + 1
        assert end == node.previous.vertex
        return passed

    def visit(self, a, b, c):
        del self.todo[self.face_of[a, b]]
        assert self.left[a, b] == c
        self.faces.append((a, b, c))

    def new_label(self, vertex):
        self.label[vertex] = len(self.label)

    def node(self, vertex, free):
        node = Node(vertex)
        self.live.append(node)
        self.set_free(node, free)
        return node

    def set_free(self, node, free):
        self.clock += 1
        node.free, node.waiting_since = free, self.clock

    def link(self, a, b):
        a.next, b.previous = b, a
        self.owner[a.vertex, b.vertex] = a

    def begin(self, face):
        nodes = []
        for v in face:
            self.new_label(v)
            nodes.append(self.node(v, self.degree[v] - 2))
        self.visit(*face)
        for i in range(3):
            self.link(nodes[i], nodes[i - 1])  # the unvisited side is on the left

    def close(self, node):
        before, after = node.previous, node.next
        self.visit(before.vertex, node.vertex, after.vertex)
        self.live.remove(node)
        if after.next is before:
            assert before.free == after.free == 0
            self.live.remove(before)
            self.live.remove(after)
            return
        self.set_free(before, before.free - 1)
        self.set_free(after, after.free - 1)
        self.link(before, after)

    def expand(self, pivot):
        after = pivot.next
        apex = self.left[pivot.vertex, after.vertex]
        if apex in self.label:
            self.join(pivot, after, apex)
            return
        self.new_label(apex)
        self.visit(pivot.vertex, after.vertex, apex)
        node = self.node(apex, self.degree[apex] - 2)
        self.set_free(pivot, pivot.free - 1)
        self.set_free(after, after.free - 1)
        self.link(pivot, node)
        self.link(node, after)

    def join(self, pivot, after, apex):
        target, side = self.beyond(apex, pivot.vertex)
        self.visit(pivot.vertex, after.vertex, apex)
        twin = self.node(apex, target.free - 2 - side)
        self.set_free(target, side)
        self.set_free(pivot, pivot.free - 1)
        self.set_free(after, after.free - 1)
        self.link(target.previous, twin)
        self.link(pivot, target)
        self.link(twin, after)

    def beyond(self, apex, v):
        """Turn about `apex` from its edge to v: the node at the first gate; the edges passed."""
        passed = 0
        while True:
            v = self.left[v, apex]  # of the face on the left of (v, apex): the next neighbour
            if self.face_of[v, apex] not in self.todo:
                return self.owner[apex, v], passed
            passed += 1


class Waiting:
    """The twin of front.choose_pivot: nodes and free edges, in the order of changes."""

    def __init__(self):
        self.free = {}

    def set_free(self, node, free):
        self.free.pop(node, None)
        self.free[node] = free

    def remove(self, node):
        del self.free[node]

    def pivot(self):
        """The fewest free edges, up to 63; of these, the one that has had so many for longest."""
        return min(self.free, key=lambda node: min(self.free[node], 63), default=-1)


# ---- Geometry -------------------------------------------------------------------------------


def level(x):
    """Two levels an octave, by counting the numbers at which they begin."""
    starts = sorted({1, 2, 3} | {m << e for m in (2, 3) for e in range(1, 70)})
    return min(sum(start <= x for start in starts) + (x >= 2), 31)


def diffuse(neighbours, delta, normals, each, rule, along):
    """Round each row of delta, or its component along the normal, and hand shares of the error on.

    Neighbours are lists, and so are the steps. The order of the operations is that of the kernel,
    for the last digit.
    """
    carried, out = delta.tolist(), []
    for i, (around, n, step) in enumerate(zip(neighbours, normals.tolist(), each, strict=True)):
        a = carried[i]
        earlier, later = ([j for j in around if (j < i) == before] for before in (True, False))
        steps = [dot(a, n) / step] if along else [x / step for x in a]
        pulls = [
            rule.pull / (1 + sum(abs(out[j][k]) for j in earlier) / max(len(earlier), 1))
            for k in range(len(steps))
        ]
        rounded = cheapest(steps, pulls, rule.zone, 1 if along else rule.weight, n)
        if along:
            error = [x - rounded[0] * step * y for x, y in zip(a, n, strict=True)]
        else:
            error = [x - r * step for x, r in zip(a, rounded, strict=True)]
        across = rule.normal * dot(error, n)
        for x in range(3):
            share = rule.tangential * (error[x] - dot(error, n) * n[x]) + across * n[x]
            for j in later:
                carried[j][x] += share / len(later)
        out.append(rounded)
    return np.array(out, dtype=np.int64).reshape(-1, 1 if along else 3)


def cheapest(numbers, pulls, zone, weight, normal):
    """Of all ways to round some numbers up or down, the one that costs the least.

    Of two alike, it is the one whose last numbers are the nearer to 0.
    """

    def cost(candidate):
        squares, across = 0.0, 0.0
        for number, integer, pull, along in zip(numbers, candidate, pulls, normal, strict=False):
            error, size = number - integer, abs(integer)
            squares += error * error + 2 * (pull * size + (zone if size else 0))
            across += error * along
        return squares + (weight - 1) * across * across

    pairs = [(math.trunc(x), math.trunc(x) + (-1 if x < 0 else 1)) for x in numbers]
    every = [candidate[::-1] for candidate in itertools.product(*pairs[::-1])]
    return list(min(every, key=cost))


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def parallelograms(faces):
    """(a, b, o) for each vertex i: i and o are across the edge a-b; i is the last of the four."""
    left = {(f[i - 2], f[i - 1]): f[i] for f in np.asarray(faces).tolist() for i in range(3)}
    found = {}
    for (a, b), apex in left.items():
        if (b, a) in left and max(a, b, left[b, a]) < apex:
            found.setdefault(apex, []).append((a, b, left[b, a]))
    return found


# ---- Numbers ------------------------------------------------------------------------------------


def slot(number, axis, context):
    """The hash of a context: products of 32 bits, as C has them."""
    h = ((4 * number + axis) * 2654435761 + context % 2**31 * 2246822507) % 2**32
    h ^= h // 2**15
    h = h * 739982445 % 2**32
    h ^= h // 2**13
    return h % 2**20


def sign_class(x):
    return (x > 0) + 2 * (x < 0)


def code_number(coder, value, axis, lengths, signs, candidates=(), histories=()):
    """The twin of `numbers.code_number`: the bits of a number as text, one after the other."""
    first = 65 * axis  # its mixers: 32 for the length, 32 for the digits, 1 for the sign
    pairs = list(zip(candidates, histories, strict=True))
    digits = f"{abs(value):b}" if value else ""
    size = 0
    for k in range(31):
        slots = [(slot(i, axis, x) + k) % 2**20 for i, x in enumerate(lengths)]
        for i, (other, fate) in enumerate(pairs):
            order = (abs(other).bit_length() >= k) + (abs(other).bit_length() > k)
            slots.append(slot(8 + i, axis, (3 * fate + order) * 32 + k))
        if not coder.bit(int(len(digits) > k), slots, first + k):
            break
        size += 1
    if size == 0:
        return 0
    slots = [slot(16 + i, axis, x) for i, x in enumerate(signs)]
    for i, (other, fate) in enumerate(pairs):
        told = sign_class(other) if abs(other).bit_length() == size else 0
        slots.append(slot(24 + i, axis, 3 * fate + told))
    negative = coder.bit(int(value < 0), slots, first + 64)
    done = "1"
    for j in range(size - 1):
        node = 8 * size + (int(done, 2) if j < 3 else 0)
        near = lengths[0] if j < 3 else 0
        slots = [slot(32, axis, 32 * node + j), slot(33, axis, 1024 * (32 * node + j) + near)]
        slots.append(slot(34, axis, 64 * int(done, 2) + 2 * size + negative))
        for i, (other, fate) in enumerate(pairs):
            # The digits of the candidate, with so many to come as this number has.
            text = f"{abs(other):b}"
            split = len(text) - (size - 1 - j)
            agrees = split > 0 and text[:split] == done and (other < 0) == bool(negative)
            told = 1 + int(text[split]) if agrees else 0
            slots.append(slot(40 + i, axis, (4 * fate + min(j, 3)) * 3 + told))
        bit = int(digits[j + 1]) if j + 1 < len(digits) else 0
        done += str(coder.bit(bit, slots, first + 32 + j))
    return -int(done, 2) if negative else int(done, 2)


def contexts(axis, known, before, total, along):
    """Of the length and of the sign of a coordinate; `known` are vectors and small classes."""
    count = max(known["count"], 1)
    here, around = level(4 * known["sizes"][axis] // count), level(4 * total // count)
    spent, kind, hint = level(before), known["kind"], level(known["hints"][axis])
    last, mean = known["last"][axis], known["sums"][axis]
    size, positive = level(4 * abs(mean) // count), int(mean > 0)
    # Sums of products may leave 64 bits: they do so as in the kernels.
    agrees = sign_class((along + 2**63) % 2**64 - 2**63)
    lengths = [
        4 * here + kind,
        32 * around + spent,
        32 * here + level(abs(last)),
        32 * hint + here,
        64 * around + 4 * known["all"] + kind,
        64 * (here // 2) + 4 * (spent // 2) + kind,
    ]
    signs = [
        32 * positive + size,
        64 * agrees + 32 * positive + size,
        48 * sign_class(last) + 16 * agrees + 8 * positive + size // 4,
    ]
    return lengths, signs


def gathered(rows, around, i, axes):
    """What the vectors before i tell of it."""
    below = [rows[j] for j in around if j < i]
    sizes = [sum(abs(row[x]) for row in below) for x in range(axes)]
    return {
        "count": len(below),
        "sums": [sum(row[x] for row in below) for x in range(axes)],
        "sizes": sizes + [0] * (3 - axes),
        "hints": [max((abs(row[x]) for row in below), default=0) for x in range(axes)],
        "last": rows[i - 1] if i else [0] * axes,
        "kind": min(len(below), 3),
        "all": min(len(around), 15),
    }


def code_vector(coder, value, known, before=0):
    """The twin of `residual.code_vector`."""
    out, total = [], sum(known["sizes"])
    for axis in range(len(value)):
        spent = before + sum(map(abs, out))
        along = sum(s * v for s, v in zip(known["sums"], out, strict=False))
        made = contexts(axis, known, spent, total, along)
        out.append(code_number(coder, value[axis], axis, *made))
    return out


def code_deltas(coder, neighbours, values):
    """The twin of `delta.code_deltas`; neighbours are lists, values too."""
    out = []
    for i, around in enumerate(neighbours):
        out.append(code_vector(coder, values[i], gathered(out, around, i, 3)))
    return out


def code_refinements(coder, neighbours, deltas, values):
    """The twin of `delta.code_refinements`."""
    out, sizes = [], [sum(map(abs, row)) for row in deltas]
    for i, around in enumerate(neighbours):
        known = gathered(out, around, i, 1)
        known["sizes"][1] = known["count"] * sum(sizes[j] for j in around) // len(around)
        out.append(code_vector(coder, values[i], known, 2 * sizes[i]))
    return out


# ---- Positions ----------------------------------------------------------------------------------

BOUND = 2**40


def distance(p, q):
    return sum(abs(x - y) for x, y in zip(p, q, strict=True))


def predict(values, i, around, corners, inner):
    """The class of vertex i, and for each axis its five predictions, three candidates, spread.

    The first `inner` of the parallelograms are quads.
    """
    before = values[i - 1] if i else [0, 0, 0]
    below = sorted(j for j in around if j < i)
    mean = [sum(values[j][x] for j in below) // len(below) for x in range(3)] if below else before
    if not corners:
        last = values[below[-1]] if below else before
        rows = [
            ([mean[x], last[x], before[x], mean[x], mean[x]], [last[x], before[x], mean[x]], 0)
            for x in range(3)
        ]
        return min(len(below), 3), rows
    shapes = []
    close = corners[:inner] or corners
    for a, b, o in close:
        sides = sorted([distance(values[a], values[o]), distance(values[b], values[o])])
        shapes.append(8 * sides[0] // sides[1] if sides[1] else 0)
    a, b, o = close[shapes.index(max(shapes))]
    near, far = sorted((a, b), key=lambda v: distance(values[v], values[o]))
    rows = []
    for x in range(3):
        all_of = [values[a][x] + values[b][x] - values[o][x] for a, b, o in corners]
        g, h, apex = values[near][x], values[far][x], values[o][x]
        first, every = (
            (2 * sum(some) + len(some)) // (2 * len(some))
            for some in (all_of[: len(close)], all_of)
        )
        around = every if inner else mean[x] if below else 0
        predictions = [first, g, 2 * g - apex, g + h - apex, around]
        rows.append((predictions, [g, h, apex], max(all_of) - min(all_of)))
    return 4 + 10 * min(len(corners), 3) + max(shapes) + 40 * (inner > 0), rows


def code_positions(coder, neighbours, corners, residual_of, within=None):
    """The twin of `parallelogram.code_positions`; gives positions, residuals, largest error sum.

    `residual_of(i, axis, prediction)` is what to encode, 0 to decode; `within` tells how many of
    the parallelograms of a vertex are quads.
    """
    values, residuals = [], []
    errors, fortunes = {}, [[0] * 3 for _ in range(3)]
    for i, around in enumerate(neighbours):
        found = corners.get(i, [])
        inner = (within or {}).get(i, 0)
        kind, rows = predict(values, i, around, found, inner)
        spreads = [row[2] for row in rows]
        known = gathered(residuals, around, i, 3)
        known |= {"hints": spreads, "kind": min(len(found), 3), "all": level(sum(spreads)) // 2}
        made, position = [], []
        for axis, (predictions, places, _) in enumerate(rows):
            fared = errors.setdefault((axis, kind), [0] * 5)
            base, chosen = choose(fared, predictions, inner)
            lengths, signs = contexts(
                axis,
                known,
                sum(map(abs, made)),
                sum(known["sizes"]),
                sum(s * v for s, v in zip(known["sums"], made, strict=False)),
            )
            step = level(abs(predictions[0] - predictions[1])) // 2
            lengths.append((kind * 5 + chosen) * 8 + min(step, 7))
            signs.append(sign_class(predictions[1] - base))
            candidates = [place - base for place in places]
            histories = [2 * f + (w == 0) for f, w in zip(fortunes[axis], candidates, strict=True)]
            r = residual_of(i, axis, base)
            r = code_number(coder, r, axis, lengths, signs, candidates, histories)
            fortunes[axis] = [
                (2 * f + (w == r)) % 16 for f, w in zip(fortunes[axis], candidates, strict=True)
            ]
            errors[axis, kind] = [
                e + 16 * abs(base + r - p) - e // 256
                for e, p in zip(fared, predictions, strict=True)
            ]
            made.append(r)
            position.append(min(max(base + r, -BOUND), BOUND))
        values.append(position)
        residuals.append(made)
    return values, residuals, max((max(e) for e in errors.values()), default=0)


def choose(errors, predictions, inner):
    """The prediction of the least error; the first gives way to one that errs a third as much.

    Where it is that of quads, it gives way to that of all parallelograms as soon as that is better.
    """
    best = min(range(1, 5), key=lambda k: errors[k])
    chosen = best if 3 * errors[best] < errors[0] else 0
    if inner and chosen == 0 and errors[4] < errors[0]:
        chosen = 4
    return predictions[chosen], chosen


# ---- Normals ------------------------------------------------------------------------------------


def normals(V, F, step):
    """The twin of normals.vertex_normals: a loop over the faces."""
    s, area = np.zeros((len(V), 3)), np.zeros(len(V))
    for a, b, c in F:
        cross = np.cross(V[b] - V[a], V[c] - V[a])
        for v in (a, b, c):
            s[v] += cross
            area[v] += np.linalg.norm(cross)
    length = np.linalg.norm(s, axis=1) + 1e-3 * (area + np.ravel(step) ** 2)
    return s / length[:, None]


def facing(V, polygons, elements, count, weights):
    """The twin of surface.surface_normals: corner after corner, as the definition reads."""
    sums = np.zeros((count, 3))
    for polygon, here in zip(polygons, elements, strict=True):
        p = [V[v] - V[polygon[0]] for v in polygon]
        n = len(p)
        area = sum(np.cross(p[i], p[(i + 1) % n]) for i in range(n))
        size = np.linalg.norm(area)
        for i, element in enumerate(here):
            a, b = p[(i + 1) % n] - p[i], p[i - 1] - p[i]
            lengths = np.linalg.norm(a) * np.linalg.norm(b)
            angle = np.arccos(np.clip(a @ b / lengths, -1, 1)) if lengths else 0.0
            share = {0: size, 1: angle, 2: 1.0}[weights]
            sums[element] += share * area / size if size else 0.0
    return sums


def octahedron(a, b, bits):
    """The direction of a point of the square: unfold its corners, then project."""
    h = 2 ** (bits - 1) - 1
    x, y, z = abs(a), abs(b), h - abs(a) - abs(b)
    if z < 0:
        x, y = h - y, h - x
    return np.array([-x if a < 0 else x, -y if b < 0 else y, z]) / np.sqrt(x**2 + y**2 + z**2)


def unit_normal(code, predicted, bits):
    """The twin of octahedral.restored, with a matrix for the half-turn."""
    state, a, b = code
    if state == 2:
        return np.zeros(3)
    direction = octahedron(a, b, bits)
    if state == 1:
        return direction
    pole = np.array([2, 3, 6]) / 7
    axis = predicted / np.linalg.norm(predicted) + pole
    half_turn = 2 * np.outer(axis, axis) / (axis @ axis) - np.eye(3)
    return half_turn @ np.array([[6, -3, 2], [2, 6, 3], [-3, -2, 6]]) @ direction / 7


# ---- Orders -------------------------------------------------------------------------------------


class Left:
    """The twin of kernels.remaining.Remaining: a sorted list."""

    def __init__(self, n):
        self.indices = list(range(n))

    def remove(self, index):
        self.indices.remove(index)

    def next_left(self, index):
        return min((i for i in self.indices if i >= index), default=self.indices[0])

    def count_below(self, index):
        return sum(i < index for i in self.indices)

    def select(self, rank):
        return self.indices[rank]


def rings(groups, count):
    """The twin of kernels.remaining.rings_of: a list of elements a group."""
    return [[e for e, g in enumerate(groups) if g == group] for group in range(count)]


def leave_ring(ring, element):
    """The ring without an element, from the one after it on."""
    at = ring.index(element)
    return ring[at + 1 :] + ring[:at]


def code_choices(coder, numbers, total):
    """The twin of choices.code_choices; None when the next number was passed over, then named."""
    left, done, history = Left(total), [], 0
    for wanted in numbers:
        following = left.next_left(done[-1] + 1 if done else 0)
        bit = coder.bit(int(wanted == following), [history], 0)
        number = following
        if not bit:
            place = code_below(coder, left.count_below(wanted), len(left.indices))
            number = left.select(place)
            if number == following:
                return None
        left.remove(number)
        done.append(number)
        history = (2 * history + bit) % 8
    return done


def fans(opposite):
    """The fan of each corner: corners that can be reached over paired edges, in order."""
    label, count = [-1] * len(opposite), 0
    for first in range(len(opposite)):
        if label[first] >= 0:
            continue
        waiting = [first]
        while waiting:
            h = waiting.pop()
            if label[h] >= 0:
                continue
            label[h] = count
            f, at = divmod(h, 3)
            if opposite[h] >= 0:
                g = opposite[h]
                waiting.append(3 * (g // 3) + (g + 1) % 3)
            before = opposite[3 * f + (at + 2) % 3]
            if before >= 0:
                waiting.append(before)
        count += 1
    return label


def patch(corners, opposite, colours, other_corners, other_opposite, other_colours, h, g):
    """The twin of correspondence.propagate: pairs of vertices and of half-edges, or None."""
    vertices, halfedges, todo = {}, {}, [(h, g)]
    while todo:
        h, g = todo.pop()
        if halfedges.get(h) == g:
            continue
        for i in range(3):
            mine, other = h - h % 3 + (h + i) % 3, g - g % 3 + (g + i) % 3
            if mine in halfedges or other in halfedges.values():
                return None
            halfedges[mine] = other
            a, b = corners[mine], other_corners[other]
            if vertices.setdefault(a, b) != b or colours[a] != other_colours[b]:
                return None
            back, forth = opposite[mine], other_opposite[other]
            if (back < 0) != (forth < 0):
                return None
            if back >= 0:
                todo.append((back, forth))
    return (vertices, halfedges) if len({*vertices.values()}) == len(vertices) else None


def orient(m, pairs):
    """Component of each face, and whether it is turned; a pair that disagrees comes too late."""
    component, side = list(range(m)), [False] * m
    for f, g, twisted in pairs:
        a, b = component[f], component[g]
        if a == b:
            continue
        change = side[f] ^ side[g] ^ twisted
        root = min(a, b)
        for i in range(m):
            if component[i] == max(a, b):
                side[i] ^= change
                component[i] = root
    for root in set(component):
        members = [i for i in range(m) if component[i] == root]
        if 2 * sum(side[i] for i in members) > len(members):
            for i in members:
                side[i] ^= True
    return component, side


# ---- Labels ---------------------------------------------------------------------------------


def beside(faces, polygon):
    """Neighbours of polygons: on each edge, each of its triangles' polygons to the next one."""
    last, links = {}, set()
    for face, mine in zip(faces, polygon, strict=True):
        for i in range(3):
            edge = frozenset((face[i - 3], face[i - 2]))
            if len(edge) == 2:
                links.add(frozenset((mine, last.get(edge, mine))))
                last[edge] = mine
    around = [[] for _ in range(max(polygon, default=-1) + 1)]
    for link in links:
        for a, b in itertools.permutations(link, 2):
            around[a].append(b)
    return [sorted(row) for row in around]


def joined(*parts):
    whole = 0
    for part in parts:
        whole = whole * 0x2C1B3C6D + part
    return whole


def label_slots(number, *contexts):
    return [slot(number + i, 0, x) % 2**18 for i, x in enumerate(contexts)]


def code_labels(coder, neighbours, labels):
    """The twin of `labels.code_labels`; None when a candidate was passed over and then named."""
    done, outcomes, new = [], [0] * 6, [0] * 4
    followers, match, length, right = {}, None, 0, [0] * 3
    for i, wanted in enumerate(labels):
        expected = None if match is None else done[match]
        votes = {}
        known = sorted((u for u in neighbours[i] if u < i), reverse=True)[:8]
        for u in known:
            votes[done[u]] = votes.get(done[u], 0) + 1
        order = _by_votes([done[u] for u in known])
        before, earlier = [*reversed(done[-2:]), -1, -1][:2]
        unknown = [u for u in neighbours[i] if u > i]
        ahead = [done[w] for u in unknown for w in neighbours[u] if w < i][:16]
        for further in (before, expected, *ahead):
            if further not in (*order, -1, None):
                order.append(further)
        found = None
        for k, label in enumerate(order):
            rank, last, vote = min(k, 3), int(label == before), votes.get(label, 0)
            other = -1 if len(order) == 1 else order[1] if k == 0 else order[0]
            matched = 0 if expected is None else 1 + (expected != label)
            share = 0 if vote == 0 else 1 + (vote == len(known))
            way = number_of(outcomes, 2)
            same, differ = ahead.count(label), len(ahead) - ahead.count(label)
            front = (min(same, 3) * 4 + min(differ, 3)) * 2 + last
            slots = label_slots(
                0,
                (((min(vote, 7) * 16 + len(known)) * 8 + min(len(order) - k, 4)) * 4 + rank) * 2
                + last,
                ((min(length, 15) * 8 + number_of(right, 2)) * 3 + matched) * 4 + rank,
                joined(label, before, earlier),
                joined(label, other, front),
                (front * 8 + min(vote, 7)) * 4 + min(len(known), 3),
                (((way * 4 + rank) * 3 + share) * 2 + last) * 9 + min(same, 2) * 3 + min(differ, 2),
                ((matched * 2 + last) * 3 + share) * 8 + min(length, 7),
            )
            if coder.bit(int(wanted == label), slots, min(k, 2)):
                found = label
                break
        if order:
            outcomes = [*outcomes[1:], int(found == order[0])]
        if found is None:
            seen = max(done, default=-1) + 1
            found = _other(coder, wanted, seen, before, order, new)
            if found in order:
                return None
            new = [*new[1:], int(found == seen)]
        done.append(found)
        if expected is not None:
            right = [*right[1:], int(found == expected)]
            length, match = (length + 1, match + 1) if found == expected else (0, None)
        if i >= 3:
            place = slot(16, 0, joined(*reversed(done[-4:]))) % 2**16
            if match is None:
                match = followers.get(place)
            followers[place] = i + 1
    return done


def _by_votes(labels):
    """Those that most have first; of equals, the one that had so many first."""
    order = []
    for end in range(1, len(labels) + 1):
        count = collections.Counter(labels[:end])
        label = labels[end - 1]
        if label in order:
            order.remove(label)
        at = sum(count[other] >= count[label] for other in order)
        order.insert(at, label)
    return order


def number_of(digits, base):
    return sum(d * base**i for i, d in enumerate(reversed(digits)))


def _other(coder, wanted, seen, before, order, new):
    if len(order) == seen:
        return seen
    way = number_of(new, 2)
    slots = label_slots(8, way, 2 * (way % 4) + (before == seen - 1), before)
    if coder.bit(int(wanted == seen), slots, 3):
        return seen
    digits = ""  # the lowest is the last
    while int("1" + digits, 2) < seen:
        node = int("1" + digits, 2)
        slots = label_slots(12, node, joined(node, before), joined(node, order[0]))
        bit = (wanted >> len(digits)) & 1
        digits = str(coder.bit(bit, slots, 4 + len(digits))) + digits
    return int("0" + digits, 2)


# ---- Neighbours and components -----------------------------------------------------------------


def neighbours(pairs, n):
    """The neighbours of each vertex, ascending, by a look at all edges."""
    return [
        sorted([j for i, j in pairs if i == v] + [i for i, j in pairs if j == v]) for v in range(n)
    ]


def component_labels(pairs, n):
    """The lowest vertex of the component of each vertex, then which of these it is."""
    lowest = list(range(n))
    for _ in range(n):
        for i, j in pairs:
            lowest[i] = lowest[j] = min(lowest[i], lowest[j])
    return [sorted(set(lowest)).index(v) for v in lowest]
