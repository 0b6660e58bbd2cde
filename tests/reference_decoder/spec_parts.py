"""§5.15 of `formats/SPEC.md`, to be read beside it: parts, names, metadata and words."""

from __future__ import annotations

import struct
import sys
import zlib

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    import zstandard

from spec_coder import Bytes, Stream, check
from spec_labels import labels

KINDS = "object", "mesh", "group", "material", "smoothing"
IDENTITY = struct.pack("<16d", *(i % 5 == 0 for i in range(16)))


def block(table, most):
    (form,), size = table.unpack("B"), table.varint()
    check(form <= 2 and size <= most, "form or size of a block")
    if form == 0:
        return table.unpack(f"{min(size, len(table.data))}s")[0]
    length = table.varint()
    check(length < size, "a packed block that is not shorter")
    (packed,) = table.unpack(f"{min(length, len(table.data))}s")
    unpacked = (inflated if form == 1 else unframed)(packed, size)
    check(len(unpacked) == size, "size of a packed block")
    return unpacked


def inflated(packed, size):
    inflater = zlib.decompressobj(-15)
    try:
        unpacked = inflater.decompress(packed, size + 1)
    except zlib.error as error:
        check(False, str(error))
    check(inflater.eof and not inflater.unused_data, "end of a deflate stream")
    return unpacked


def unframed(packed, size):
    """Header of the frame by RFC 8878, section 3.1.1.1; its blocks by a library of Zstandard."""
    table = Bytes(packed)
    magic, descriptor = table.unpack("IB")
    check(magic == 0xFD2FB528 and descriptor & 31 == 0, "a frame of another kind")
    flag, single = descriptor >> 6, descriptor >> 5 & 1
    if not single:
        (window,) = table.unpack("B")
        check(window <= 0x68, "window of a frame")
    check(flag or single, "a frame without a size")
    (held,) = table.unpack("BHIQ"[flag])
    check(held + 256 * (flag == 1) == size, "size of a frame")
    if sys.version_info >= (3, 14):
        one = zstd.ZstdDecompressor()
        try:
            unpacked = one.decompress(packed, size + 1)
        except zstd.ZstdError as error:
            check(False, str(error))
        check(one.eof and not one.unused_data, "end of a frame")
        return unpacked
    try:
        return zstandard.ZstdDecompressor().decompress(packed, allow_extra_data=False)
    except zstandard.ZstdError as error:
        check(False, str(error))


def string(table):
    (text,) = table.unpack(f"{min(table.varint(), len(table.data))}s")
    return text.decode("utf-8", "surrogatepass")


def strings(table):
    return [string(table) for _ in range(table.varint())]


def read_text(text):
    """[kind, partly, moved, names] of each division, metadata, what was lost."""
    table, divisions, metadata = Bytes(text), [], {}
    for _ in range(table.varint()):
        (byte,) = table.unpack("B")
        kind, partly, moved = byte & 7, byte >> 3 & 1, byte >> 4 & 1
        check(byte < 32 and kind <= 4, "kind of a division")
        check(KINDS[kind] not in [row[0] for row in divisions], "a kind that comes twice")
        divisions.append((KINDS[kind], partly, moved, strings(table)))
    for _ in range(table.varint()):
        name = string(table)
        check(name not in metadata, "a key that comes twice")
        metadata[name] = strings(table)
    lost = strings(table)
    check(table.at == len(text), "text is too long")
    check(divisions or metadata or lost, "nothing to tell")
    return divisions, metadata, lost


def read_labels(table, near):
    (payload,) = table.unpack(f"{min(table.varint(), len(table.data))}s")
    return labels(payload, near)


def read_numbers(table, count, total):
    """The number that each label stands for."""
    check(count <= total, "more labels than parts")
    (payload,) = table.unpack(f"{min(table.varint(), len(table.data))}s")
    stream, left, last, bits, numbers = Stream(payload), list(range(total)), -1, (0, 0, 0), []
    for _ in range(count):
        number = next((x for x in left if x > last), left[0])
        bit = stream.predicted("next", [("next", bits)], 255)
        bits = *bits[1:], bit
        if not bit:
            other = left[stream.index(len(left))]
            check(other != number, "the next part read as another")
            number = other
        left.remove(number)
        numbers.append(number)
        last = number
    stream.end()
    return numbers


def read_transforms(table, count):
    """Of each part the 16 numbers of its matrix, row by row, as bytes."""
    size = (count + 7) // 8
    data = Bytes(block(table, size + 128 * count))
    (mask,) = data.unpack(f"{size}s")
    moved = [mask[i >> 3] >> (i & 7) & 1 for i in range(8 * size)]
    check(not any(moved[count:]), "bits after the parts")
    others = sum(moved)
    (planes,) = data.unpack(f"{128 * others}s")
    check(data.at == len(data.data), "transforms are too long")
    rows = [planes[i :: others or 1] for i in range(others)]
    check(IDENTITY not in rows, "an identity among the transforms")
    rows = iter(rows)
    return [next(rows) if bit else IDENTITY for bit in moved[:count]]


def read_parts(payload, near):
    """Divisions (kind, names, part of each face, transforms), metadata, lost, the text."""
    table = Bytes(payload)
    text = block(table, 1 << 24)
    divisions, metadata, lost = read_text(text)
    parts = []
    for kind, partly, moved, names in divisions:
        found = read_labels(table, near)
        numbers = read_numbers(table, max(found) + 1, len(names) + partly)
        check(not partly or 0 in numbers, "every face is in a part")
        of_face = [numbers[label] - partly for label in found]
        transforms = read_transforms(table, len(names)) if moved else None
        parts.append((kind, names, of_face, transforms))
    check(table.at == len(payload), "PART is too long")
    return parts, metadata, lost, text


def neighbours_of_faces(triangles, polygon):
    """§5.16; `triangles` by their points, `polygon` the face of each."""
    before, graph = {}, [set() for _ in range(max(polygon) + 1)]
    for triangle, face in zip(triangles, polygon, strict=True):
        for k, v in enumerate(triangle):
            edge = frozenset((v, triangle[(k + 1) % 3]))
            if len(edge) == 1:
                continue
            other = before.get(edge, face)
            if other != face:
                graph[face].add(other)
                graph[other].add(face)
            before[edge] = face
    return [sorted(near) for near in graph]
