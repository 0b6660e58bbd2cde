"""§5.14 and §5.17 of `formats/SPEC.md`, to be read beside it: attributes and unit normals."""

from __future__ import annotations

import math
import struct
from itertools import chain

import numpy as np
from spec_coder import Bytes, RefusedError, check, level, wrapped
from spec_decoder import Axis, Classes, Grid, Vectors, read_axes, vectors_of
from spec_labels import labels

VERTEX, CORNER, FACE = "vertex", "corner", "face"
ROLES = "normal", "uv", "colour", "other"
TYPES = (*"?BHIQbhiqefd", "ff", "dd")  # as of `struct`
INTEGERS, EXACT, GRID, OCTAHEDRAL = range(4)
CODINGS = (INTEGERS,), (EXACT, GRID, OCTAHEDRAL), (EXACT,)


# ---- §5.14: the table -----------------------------------------------------------------------


class Entry:
    """An entry: its fields by their names, and what follows from them."""

    def __init__(self, table, before):
        (name,) = table.unpack(f"{min(table.varint(), len(table.data))}s")
        self.name = name.decode("utf-8", "surrogatepass")
        what, flags = table.unpack("BB")
        self.width, self.at = table.varint(), len(before)
        domain, type_ = what & 3, what >> 4
        check(domain < 3 and type_ < len(TYPES) and flags < 128, "what or flags of an attribute")
        self.domain, self.role = (VERTEX, CORNER, FACE)[domain], ROLES[what >> 2 & 3]
        self.type, self.coding = TYPES[type_], flags >> 4 & 3
        check(self.coding in CODINGS[(type_ > 8) + (type_ > 11)], "coding of a type")
        self.normalized, self.partly, self.mixed = (bool(flags & bit) for bit in (1, 2, 8))
        self.first = flags >> 6  # 1: the first unit has no value
        check(self.partly or not self.first, "the first of units that all have values")
        self.classes = table.varint() if self.domain == CORNER else None
        if self.domain == CORNER and self.classes > 1:
            check(self.classes - 2 < len(before), "classes of an attribute that is not before")
            check(before[self.classes - 2].classes == 0, "classes of one without")
        self.palette = table.varint() if flags & 4 else None
        check(self.palette != 0, "a palette without rows")
        self.limbs = 1
        if self.coding == INTEGERS:
            self.origin, self.bits, self.limbs = table.unpack("QBB")
            check(1 <= self.bits <= 29 and 1 <= self.limbs <= -(-64 // self.bits), "bits, limbs")
        elif self.coding != EXACT:
            self.bits, error = table.unpack("Bd")
            check(0 <= error < math.inf, "error of an attribute")
        if self.coding == GRID:
            (self.density,), self.bits = table.unpack("d"), 29
            check(0 < self.density < math.inf, "density of an attribute")
            check(self.width <= len(table.data), "width of an attribute")
            self.origin = table.unpack(f"{self.width}d")
            check(all(map(math.isfinite, self.origin)), "origin of an attribute")
        if self.coding == OCTAHEDRAL:
            check(self.width == 3 and 2 <= self.bits <= 30, "octahedral normals")
            check(self.palette is None, "octahedral normals with a palette")
        if self.mixed:
            plain = self.coding == GRID or (self.coding == INTEGERS and self.limbs == 1)
            check(plain and self.width >= 3, "mixed columns")
        self.columns = self.width * self.limbs * len(self.type)
        several = 1 if self.coding == OCTAHEDRAL else -(-self.columns // 3)
        several += (self.classes == 0) + self.partly + (self.palette is not None)
        check(several <= len(table.data), "more streams than bytes")
        self.sizes = [table.varint() for _ in range(several)]


def entries(table):
    found = []
    count = table.varint()
    check(count >= 1, "no attributes")
    for _ in range(min(count, len(table.data))):
        found.append(Entry(table, found))
    return found


# ---- §5.14: units ---------------------------------------------------------------------------


class Units:
    """Neighbours and parallelograms of units.

    elements: the unit of each element; of_corners: that of each corner of the polygons.
    """

    def __init__(self, near, around, elements=None, of_corners=None):
        self.near, self.around = near, around
        self.elements, self.of_corners = elements, of_corners

    def __len__(self):
        return len(self.near)

    def among(self, kept):
        """Some of them only, numbered anew."""
        new = {old: i for i, old in enumerate(kept)}
        near = [[new[w] for w in self.near[v] if w in new] for v in kept]
        around = {
            new[i]: [tuple(map(new.get, row)) for row in self.around[i] if new.keys() >= {*row}]
            for i in kept
            if i in self.around
        }
        return Units(near, around)


def of_triangles(triangles, count):
    """The neighbours and the parallelograms of units that are corners of triangles."""
    near = [set() for _ in range(count)]
    for triangle in triangles:
        for v in triangle:
            near[v] |= {w for w in triangle if w != v}
    return [sorted(ring) for ring in near], parallelograms(triangles)


def parallelograms(triangles):
    """Of each unit i the (a, b, o), in the order of the half-edges from a to b."""
    halves = [tuple(t[(i + j) % 3] for j in range(3)) for t in triangles for i in range(3)]
    pairs, found = {}, {}
    for h, (a, b, _) in enumerate(halves):
        pairs.setdefault(frozenset((a, b)), []).append(h)
    for h, (a, b, i) in enumerate(halves):
        pair = pairs[frozenset((a, b))][:2]
        if h in pair and len(pair) == 2:
            o = halves[sum(pair) - h][2]
            if max(a, b, o) < i:
                found.setdefault(i, []).append((a, b, o))
    return found


class Mesh:
    """What the units of attributes are told by: the mesh in the order of the file.

    faces: triples of vertices; polygons: of each, for each of its corners, the corners 3 f + c of
    faces there; near_faces: the neighbours of the polygons; stitching: of §5.9.
    """

    def __init__(self, vertex_count, faces, polygons, near_faces, stitching):
        self.vertex_count, self.faces, self.polygons = vertex_count, faces, polygons
        self.near_faces, self.stitching = near_faces, stitching
        self.ends, self.corners = [*chain(*faces)], [*chain(*polygons)]

    def vertices(self):
        n = self.vertex_count
        of_corners = [self.ends[fan[0]] for fan in self.corners]
        return Units(*of_triangles(self.faces, n), range(n), of_corners)

    def by_faces(self, domain):
        of_corners = [p for p, corners in enumerate(self.polygons) for _ in corners]
        elements = of_corners if domain == CORNER else range(len(self.polygons))
        return Units(self.near_faces, {}, elements, of_corners)

    def classes(self, payload):
        classes = Classes(payload, self.stitching)
        classes.stream.end()
        of = classes.numbers
        triangles = [tuple(of[f, i] for i in range(3)) for f in range(len(self.faces))]
        flat = [*chain(*triangles)]
        several = [{flat[c] for c in fan} for fan in self.corners]
        check(all(len(one) == 1 for one in several), "a corner of two classes")
        elements = [flat[fan[0]] for fan in self.corners]
        return Units(*of_triangles(triangles, sum(classes.counts)), elements, elements)

    def sums(self, weights, units, positions):
        """§5.17: the s of each unit."""
        out, units_of = np.zeros((len(units), 3)), iter(units.of_corners)
        for polygon in self.polygons:
            v = np.array([positions[self.ends[fan[0]]] for fan in polygon])
            for s in corner_vectors(v - v[0], weights):
                out[next(units_of)] += s
        return out


# ---- §5.14: columns -------------------------------------------------------------------------


def grid_points(payload, units):
    """§5.6, of units."""
    grid, vectors = Grid([], {}), Vectors(payload)
    grid.around = units.around
    for i, neighbours in enumerate(units.near):
        below = [v for v in neighbours if v < i]
        m, hints = grid.look(i, below)
        grid.point = []
        vectors.next(below, min(m, 3), level(sum(hints)) // 2, hints, choose=grid.choose)
        grid.points.append(tuple(grid.point))
    vectors.stream.end()
    return grid.points


class Number(Axis):
    """§5.12, of numbers of a type; its coordinates are their bits."""

    def __init__(self, table, number, width, code):
        super().__init__(table, number, width)
        self.code = code
        check(width == 32 or code == "d", "width of exact numbers")

    def add_raw(self, p, width, bits):
        if self.code == "d" and width == 32:
            nan = bits & 0x7FFFFFFF > 0x7F800000
            (number,) = struct.unpack("<f", struct.pack("<I", bits | nan << 22))
            bits = bits_of(number, "d")
        check(self.code != "e" or bits < 1 << 16, "more than a binary16 number")
        self.known(2, p, 0, bits)

    def bounded(self, f, number):
        if f == 2:
            return number
        number = super().bounded(f, number)
        try:
            bits = bits_of(number, self.code)
        except OverflowError:
            raise RefusedError("a number too large for its type") from None
        (same,) = struct.unpack("<" + self.code, struct.pack("<" + self.code, number))
        check(same == number, "a number that is none of its type")
        return bits


def bits_of(number, code):
    return int.from_bytes(struct.pack("<" + code, number), "little")


def exact(payload, units, code):
    def axis(table, number, width):
        return Number(table, number, width, code)

    return read_axes(payload, units.near, lambda i: units.around.get(i, []), axis)[0]


class Decoded:
    """What an attribute is: of each element whether it has a value, and the values."""

    def __init__(self, entry, has, values, weights):
        self.entry, self.has, self.values, self.weights = entry, has, values, weights

    def taken(self, sources):
        """Its elements in another order; `sources` are for each domain."""
        at = sources[self.entry.domain]
        return Decoded(self.entry, self.has[at], self.values[at], self.weights)


class Attribute:
    """An attribute: its entry, `units`, and of each unit the row, -1 for none."""

    def __init__(self, entry, streams, units, mesh):
        self.entry, self.units, self.mesh = entry, units, mesh
        has = [1] * len(units)
        if entry.partly:
            has = labels(streams.pop(0), units.near)
            check(max(has, default=0) <= 1, "labels of units that have a value")
            has = [label == entry.first for label in has]
        kept = [v for v, one in enumerate(has) if one]
        rows, some = range(len(kept)), units.among(kept)
        if entry.palette is not None:
            rows = labels(streams.pop(0), some.near)
            check(max(rows, default=-1) + 1 == entry.palette, "rows of a palette")
            some = Units([[]] * entry.palette, {})
        if entry.coding == OCTAHEDRAL:
            rows = kept
        self.rows = [-1] * len(units)
        for v, row in zip(kept, rows, strict=True):
            self.rows[v] = row
        self.has, self.normals = has, None
        if entry.coding == OCTAHEDRAL:
            self.normals = Normals(streams[0], entry.bits, units)
            self.integers = self.normals.vectors
        else:
            self.integers, self.values = self.columns(streams, some)

    def columns(self, streams, units):
        entry, blocks = self.entry, []
        for stream in streams:
            if entry.coding == EXACT:
                blocks.append(exact(stream, units, entry.type[0]))
            else:
                blocks.append(grid_points(stream, units))
        rows = [[*chain(*row)] for row in zip(*blocks, strict=True)] or [[]] * len(units)
        for row in rows:
            check(not any(row[entry.columns :]), "numbers where no column is")
            del row[entry.columns :]
            if entry.mixed:
                row[0] += row[1]
                row[2] += row[1]
            if entry.coding != EXACT:
                check(all(0 <= x < 1 << entry.bits for x in row), "columns out of their bits")
        if entry.coding == EXACT:
            return rows, rows
        if entry.coding == GRID:
            return rows, [
                [o + c / entry.density for o, c in zip(entry.origin, row, strict=True)]
                for row in rows
            ]
        starts = range(0, entry.columns, entry.limbs)
        return rows, [[self.integer(row[k : k + entry.limbs]) for k in starts] for row in rows]

    def integer(self, limbs):
        entry = self.entry
        number = sum(c << j * entry.bits for j, c in enumerate(limbs))
        check(number < 1 << 64, "a number of more than 64 bits")
        number = (entry.origin + number) % (1 << 64)
        if entry.type in "bhiq":
            number -= (number >> 63) << 64
        check(entry.type != "?" or number in (0, 1), "a truth value")
        try:
            struct.pack("<" + entry.type, number)
        except struct.error:
            raise RefusedError("a number that is none of its type") from None
        return number

    def decoded(self, positions):
        """Of each element whether it has a value, and the values, 0 without one."""
        entry, code = self.entry, self.entry.type
        dtype = np.dtype({"ff": "c8", "dd": "c16"}.get(code, code))
        rows = None if self.normals else self.values
        if self.normals:
            rows = self.normals.values(self.mesh.sums(self.normals.weights, self.units, positions))
        elif entry.coding == EXACT:
            words = np.array(rows, f"u{dtype.itemsize // len(code)}")
            rows = words.reshape(len(rows), entry.columns).view(dtype)
        table = np.array(rows, dtype).reshape(len(rows), entry.width)
        of = np.array([self.rows[unit] for unit in self.units.elements])
        out = np.zeros((len(of), entry.width), dtype)
        out[of >= 0] = table[of[of >= 0]]
        return Decoded(entry, of >= 0, out, self.normals and self.normals.weights)

    def digest(self):
        """§5.7."""
        rows = (row for row in self.rows if row >= 0)
        return map(wrapped, chain(self.units.elements, self.has, rows, *self.integers))


# ---- §5.17: octahedral normals --------------------------------------------------------------

G = np.array((2, 3, 6)) / 7
TURN = np.array(((6, -3, 2), (2, 6, 3), (-3, -2, 6))) / 7
AREA, ANGLE, EQUAL, NONE = range(4)


class Normals:
    """The integers of unit vectors, and their values once there are positions."""

    def __init__(self, payload, bits, units):
        table = Bytes(payload)
        own, plan = table.unpack("BB")
        check(own == bits and plan < 8, "bits or plan of normals")
        self.weights, self.h = plan & 3, (1 << bits - 1) - 1
        stream = payload[2:]
        self.vectors = grid_points(stream, units) if plan & 4 else vectors_of(stream, units.near)
        for state, a, b in self.vectors:
            check(state in (0, 1, 2) and max(abs(a), abs(b)) <= self.h, "state or point")
            check(state != 0 or self.weights != NONE, "a normal relative to nothing")
            check(state != 2 or a == b == 0, "a point of no direction")

    def direction(self, a, b):
        z = self.h - abs(a) - abs(b)
        if z < 0:
            x, y = self.h - abs(b), self.h - abs(a)
            a, b = (-x if a < 0 else x), (-y if b < 0 else y)
        u = np.array((a, b, z), float)
        return u / np.linalg.norm(u)

    def values(self, sums):
        """The normals; `sums` are the s of the elements."""
        return [
            self.value(state, self.direction(a, b), s)
            for (state, a, b), s in zip(self.vectors, sums, strict=True)
        ]

    def value(self, state, d, s):
        if state:
            return d * (state == 1)
        p = s / np.linalg.norm(s) if s.any() else G
        w, k = TURN @ d, p + G
        k = k / np.linalg.norm(k)
        return 2 * (k @ w) * k - w


def corner_vectors(v, weights):
    """§5.17: the vector of each corner of a polygon with corners at v."""
    area = np.cross(v, np.roll(v, -1, axis=0)).sum(axis=0)
    if weights == AREA:
        return [area] * len(v)
    size = np.linalg.norm(area)
    unit = area / size if size else area
    if weights == ANGLE:
        return [unit * angle(v[i + 1 - len(v)] - v[i], v[i - 1] - v[i]) for i in range(len(v))]
    return [unit] * len(v)


def angle(x, y):
    if not (x.any() and y.any()):
        return 0.0
    return math.atan2(np.linalg.norm(np.cross(x, y)), x @ y)


# ---- All of it ------------------------------------------------------------------------------


def read_attributes(payload, mesh):
    """The attributes, in the order of the file."""
    table = Bytes(payload)
    given, shared, at = [], {}, 0
    for k, entry in enumerate(entries(table)):
        at, streams = at or table.at, []
        for size in entry.sizes:
            check(at + size <= len(payload), "a stream beyond the end")
            streams.append(payload[at : at + size])
            at += size
        if entry.domain == VERTEX:
            units = mesh.vertices()
        elif entry.domain == FACE or entry.classes == 1:
            units = mesh.by_faces(entry.domain)
        elif entry.classes == 0:
            units = shared[k] = mesh.classes(streams.pop(0))
        else:
            units = shared[entry.classes - 2]
        given.append(Attribute(entry, streams, units, mesh))
    check(at == len(payload), "bytes after the streams")
    return given


def sources(kept, polygons):
    """§5.11: of each domain the elements of the file, in the order of the result."""
    order, polygon_order, begins = kept
    starts = np.cumsum([0, *map(len, polygons)])
    corners = [
        starts[p] + (begin + i) % len(polygons[p])
        for p, begin in zip(polygon_order, begins, strict=True)
        for i in range(len(polygons[p]))
    ]
    return {VERTEX: order, CORNER: corners, FACE: polygon_order}
