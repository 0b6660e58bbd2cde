"""§5.19 of `formats/SPEC.md`, to be read beside it: steps by vertex."""

from __future__ import annotations

from spec_coder import Bytes, Stream, check
from spec_labels import labels

QUARTERS = 1.0, 0.8408964152537145, 0.7071067811865476, 0.5946035575013605


def ratio(e):
    return QUARTERS[e % 4] / (1 << e // 4)


def bits_more(e):
    """Of a grid coordinate in a step of exponent e."""
    return -(-e // 4)


def components(near):
    """The vertices of each component, ascending, in the order of the lowest."""
    left, found = dict.fromkeys(range(len(near))), []
    while left:
        reached = [next(iter(left))]
        for v in reached:
            if v in left:
                del left[v]
                reached += [w for w in near[v] if w in left]
        found.append(sorted(set(reached)))
    return found


def exponents(payload, step, near):
    """The exponent of each vertex of the faces."""
    check(step > 0, "STEP in a file of 0 bits")
    table = Bytes(payload)
    (count,) = table.unpack("B")
    check(2 <= count <= 121, "number of exponents")
    different = table.unpack(f"{count}B")
    check(max(different) <= 120 and min(different) == 0, "exponents")
    check(len(set(different)) == count, "an exponent that comes twice")
    of_vertices = labels(payload[table.at :], near)
    check(max(of_vertices) + 1 == count, "number of labels")
    return [different[label] for label in of_vertices]


def roots(payload, near, e):
    """The components, the point of the root of each, and the stream of all vertices."""
    parts, table = components(near), Bytes(payload)
    for part in parts:
        check(len({e[v] for v in part}) == 1, "exponents that differ within a component")
    bits, size = table.unpack("3B"), table.varint()
    check(max(bits) <= 30 and table.at + size <= len(payload), "bits or size of roots")
    stream = Stream(payload[table.at :][:size])
    points = [tuple(stream.raw(n + bits_more(e[part[0]])) for n in bits) for part in parts]
    stream.end()
    return parts, points, payload[table.at + size :]
