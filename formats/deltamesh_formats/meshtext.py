"""What the loaders of trimesh misread without a word, put right or refused before they see it.

Each function takes the bytes of a file and returns bytes that the loader reads faithfully, with
the least numbers of vertices and faces that must come out; `meshfile` compares.
"""

from __future__ import annotations

import json
import re
from typing import Final, TypeAlias

from deltamesh_formats.errors import MeshError

# At least so many vertices, at least so many faces.
Records: TypeAlias = tuple[int, int]

_OBJ_VERTEX: Final = (b"v ", b"v\t")
_OBJ_FACE: Final = (b"f ", b"f\t")
_OBJ_ZERO: Final = re.compile(rb"(?<!\d)0+(?!\d)")
_COMMENT: Final = re.compile(rb"#[^\r\n]*")
# Vertex records of these begin with x, y, z; those of 4OFF and nOFF do not.
_OFF_KEYWORD: Final = re.compile(rb"\s*((?:ST)?C?N?OFF)\b")
_PLY_ELEMENT: Final = re.compile(rb"^\s*element\s+(\w+)\s+(\d+)", re.MULTILINE)
_PLY_ASCII: Final = re.compile(rb"^\s*format\s+ascii", re.MULTILINE)
_PLY_FACES_LAST: Final = re.compile(
    rb"element\s+face\s+\d+\s+property\s+list(?!.*element)", re.DOTALL
)
_STL_NAME: Final = re.compile(rb"^([ \t]*(?:end)?solid)\b.*$", re.MULTILINE | re.IGNORECASE)
_STL_HEADER: Final = 84
_STL_FACET: Final = 50
# glTF primitives of triangles, strips, and what is no face at all: points and lines.
_GLB_MODES: Final = frozenset(range(6))
_GLB_COMPRESSED: Final = frozenset(
    {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"}
)


def plain_obj(data: bytes) -> tuple[bytes, Records]:
    """Keep of an OBJ the positions and the faces over them alone, with indices from 1.

    Given texture coordinates, normals, groups and materials, trimesh drops isolated vertices and
    reorders faces; it counts relative indices from the end of the file, not from their line.
    """
    for end in (b"\\\r\n", b"\\\n"):
        data = data.replace(end, b" ")
    lines = [line.lstrip() for line in _COMMENT.sub(b"", data).splitlines()]
    vertices = [b"v " + line[2:] for line in lines if line[:2] in _OBJ_VERTEX]
    faces = [b"f " + line[2:] for line in lines if line[:2] in _OBJ_FACE]
    text = re.sub(rb"/\S*", b"", b"\n".join(faces))
    if b"-" in text:
        text = b"\n".join(_absolute_faces(lines))
    if _OBJ_ZERO.search(text):
        raise MeshError("a face has the vertex index 0, but OBJ counts from 1")
    return b"\n".join([*vertices, text, b""]), (len(vertices), len(faces))


def _absolute_faces(lines: list[bytes]) -> list[bytes]:
    """Return the face lines with -1, the last vertex above the line, and so on made absolute."""
    count, faces = 0, []
    for line in lines:
        if line[:2] in _OBJ_VERTEX:
            count += 1
        elif line[:2] in _OBJ_FACE:
            indices = [int(corner.partition(b"/")[0]) for corner in line[2:].split()]
            # Beyond the first vertex there is nothing: 0, which is refused.
            absolute = [i if i >= 0 else max(count + 1 + i, 0) for i in indices]
            faces.append(b"f " + b" ".join(b"%d" % i for i in absolute))
    return faces


def plain_ply(data: bytes) -> tuple[bytes, Records]:
    """Check the header of a PLY: trimesh takes half an ASCII file for a whole one."""
    end = data.find(b"end_header")
    if not data.startswith(b"ply"):
        raise MeshError("it does not begin with 'ply'")
    if end < 0:
        raise MeshError("its header has no end: is it cut short?")
    # A comment may be in any encoding. Edges would make trimesh return a path, not a mesh.
    header = data[:end].decode("ascii", "replace").encode("ascii", "replace")
    header = re.sub(rb"(?m)^(\s*element\s+)edge\b", rb"\1_edge", header)
    counts = {name: int(number) for name, number in _PLY_ELEMENT.findall(header)}
    if counts.get(b"tristrips") and not counts.get(b"face"):
        raise MeshError("its faces are triangle strips, which are not read")
    body = data[end:]
    if _PLY_ASCII.search(header):
        lines = [line for line in body.splitlines() if line and not line.isspace()]
        _check_lines(lines[1:], sum(counts.values()), bool(_PLY_FACES_LAST.search(header)))
        body = b"\n".join(lines)
    return header + body, (counts.get(b"vertex", 0), counts.get(b"face", 0))


def _check_lines(lines: list[bytes], records: int, faces_last: bool) -> None:
    """Refuse an ASCII PLY that ends too early, between its lines or within the last face."""
    if len(lines) < records:
        raise MeshError(f"{len(lines)} lines for {records} records: is it cut short?")
    last = lines[-1].split() if lines and faces_last else [b"0"]
    if last[0].isdigit() and len(last) <= int(last[0]):
        raise MeshError("its last face is incomplete: is it cut short?")


def plain_off(data: bytes) -> tuple[bytes, Records]:
    """Put each record of an OFF on a line of its own, as trimesh wants it and OFF does not."""
    text = _COMMENT.sub(b"", data)
    keyword = _OFF_KEYWORD.match(text)
    if keyword is None:
        raise MeshError("it does not begin with 'OFF' (or COFF, NOFF, STOFF)")
    lines = [line.split() for line in text[keyword.end() :].splitlines()]
    lines = [line for line in lines if line]
    numbers = [number for line in lines for number in line]
    if numbers[:1] == [b"BINARY"]:
        raise MeshError("binary OFF is not read")
    if len(numbers) < 3:
        raise MeshError("it has no counts of vertices, faces and edges: is it cut short?")
    n, m, records = int(numbers[0]), int(numbers[1]), lines[1:]
    if not _one_a_line(records, n, m):
        records = _regrouped(numbers[3:], n, m)
    body = b"\n".join(b" ".join(record) for record in records)
    return b"OFF\n%d %d 0\n%s\n" % (n, m, body), (n, m)


def _one_a_line(records: list[list[bytes]], n: int, m: int) -> bool:
    return (
        len(records) >= n + m
        and all(len(record) >= 3 for record in records[:n])
        and all(record[0].isdigit() and len(record) > int(record[0]) for record in records[n:][:m])
    )


def _regrouped(numbers: list[bytes], n: int, m: int) -> list[list[bytes]]:
    """Cut a stream of numbers into n positions and m faces; without colours it is unambiguous."""
    if 0 <= n <= len(numbers) and 0 <= m <= len(numbers):
        records = [numbers[3 * i : 3 * i + 3] for i in range(n)]
        position = 3 * n
        for _ in range(m):
            size = int(numbers[position]) + 1 if position < len(numbers) else 1
            records.append(numbers[position : position + size])
            position += size
        if position == len(numbers):
            return records
    raise MeshError("its records do not fit its counts of vertices and faces: is it cut short?")


def plain_stl(data: bytes) -> tuple[bytes, Records]:
    """Tell binary from ASCII, and drop names, which trimesh searches for keywords."""
    facets = int.from_bytes(data[_STL_HEADER - 4 : _STL_HEADER], "little")
    expected = _STL_HEADER + _STL_FACET * facets
    if len(data) == expected:
        return data, (3 * facets, facets)
    lower = data.lower()
    if lower.lstrip().startswith(b"solid") and (b"facet" in lower or b"endsolid" in lower):
        text = _STL_NAME.sub(rb"\1", data).decode("ascii", "replace").encode("ascii", "replace")
        facets = lower.count(b"endfacet")
        return text, (3 * facets, facets)
    message = f"neither an ASCII STL nor a binary one, whose header of {facets} facets would mean"
    raise MeshError(f"{message} {expected} bytes: it has {len(data)}")


def check_glb(data: bytes) -> None:
    """Refuse what trimesh reads as zeros (compressed, sparse), unscaled, or not at all (fans)."""
    if data[:4] != b"glTF":
        raise MeshError("it does not begin with 'glTF'")
    size = int.from_bytes(data[12:16], "little")
    tree = json.loads(data[20 : 20 + size])
    for name in sorted(_GLB_COMPRESSED.intersection(tree.get("extensionsRequired", ()))):
        raise MeshError(f"it needs the glTF extension {name}, which is not read")
    accessors = tree.get("accessors", [])
    for mesh in tree.get("meshes", []):
        for primitive in mesh["primitives"]:
            if primitive.get("mode", 4) not in _GLB_MODES:
                raise MeshError("it holds a triangle fan, which is not read")
            used = [primitive["attributes"].get("POSITION"), primitive.get("indices")]
            for accessor in (accessors[i] for i in used if i is not None):
                if "sparse" in accessor or accessor.get("normalized"):
                    raise MeshError("it holds sparse or normalized accessors, which are not read")
