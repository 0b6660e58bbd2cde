"""Reader of PLY: text and binary of either byte order, properties of any type and name.

It keeps properties of vertices and faces, lists of faces with as many numbers for each corner,
comments and obj_info. Triangle strips become triangles, beside the faces if there are some. Other
elements and lists are named as lost.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any, Final, NamedTuple

import numpy as np

from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles import plain_text, text
from deltamesh_formats.meshfiles.ply.body import Ascii, Binary
from deltamesh_formats.meshfiles.ply.header import Element, Header, read_header
from deltamesh_formats.meshfiles.ply.misfits import misfit
from deltamesh_formats.meshfiles.ply.properties import GROUPS, INDICES, POSITION, WEDGE_UV, role_of
from deltamesh_formats.meshfiles.ply.records import Column, read_rows
from deltamesh_formats.meshfiles.triangle_strips import triangles_of_strips
from deltamesh_formats.polymesh.mesh import Attribute, Domain, PolyMesh

_OF_FACES: Final = ("face", "tristrips")
_KEPT: Final = ("vertex", *_OF_FACES)
_NO_END: Final = re.compile(rb"[^\n]+")


def read(data: bytes) -> PolyMesh:
    """Read a PLY.

    Raises
    ------
    MeshError
        For a file that is not valid, with the line or the byte at fault where there is one.
    """
    plain = plain_text.utf8(data)
    header = read_header(plain)
    if header.order and plain_text.wide_encoding(data):
        raise MeshError("its header is UTF-16 text, but announces a binary body")
    tables, lost = _tables(plain, header)
    vertices = tables.get("vertex", {})
    if not all(name in vertices and vertices[name].counts is None for name in POSITION):
        raise MeshError("its vertices have no properties x, y and z")
    positions = [vertices.pop(name).values for name in POSITION]
    single = all(axis.dtype.itemsize < 8 and axis.dtype.kind == "f" for axis in positions)
    faces, strips = tables.get("face", {}), tables.get("tristrips", {})
    polygons, triangles = _faces(faces), _triangles(strips)
    attributes, unlike = _scalars(vertices, "vertex"), _lists(vertices)
    of_faces = _scalars(faces, "face")
    wedges, others = _corner_attributes(faces, polygons.sizes)
    of_faces += wedges
    lost += [f"lists {name} of vertices" for name in unlike]
    lost += [f"lists {name} of faces" for name in others]
    lost += [f"properties {name} of triangle strips" for name in strips]
    if len(triangles.sizes):
        strips_first = next(name for name in tables if name in _OF_FACES) == "tristrips"
        of_faces = [_joined_attribute(a, triangles, strips_first) for a in of_faces]
        both = (triangles, polygons) if strips_first else (polygons, triangles)
        polygons = _Polygons(*map(np.concatenate, zip(*both, strict=True)))
    metadata = {"comments": tuple(header.comments), "obj_info": tuple(header.obj_info)}
    return PolyMesh(
        np.stack(positions, axis=1).astype(np.float64),
        polygons.corners,
        np.concatenate(([0], np.cumsum(polygons.sizes))).astype(np.int64),
        (*attributes, *(a for a in of_faces if len(a.values))),
        metadata={key: said for key, said in metadata.items() if said},
        lost=tuple(lost),
        precision="float32" if single else "float64",
    )


def _tables(data: bytes, header: Header) -> tuple[dict[str, dict[str, Column]], list[str]]:
    """Return the columns of each element, and descriptions of those that are not kept."""
    body: Ascii | Binary = Binary(data[header.body :], header.order)
    if not header.order:
        marked = plain_text.without_end_marks(plain_text.with_line_feeds(data))
        plain = plain_text.without_inner_marks(marked)
        above = text.blanked(_NO_END, plain[: header.body])
        body = Ascii(text.split_lines(above + plain[header.body :]))
    elements = header.elements if header.order else list(map(_as_written, header.elements))
    try:
        return _columns(body, elements)
    except MeshError as error:
        found = misfit(body, elements) if isinstance(body, Ascii) else None
        raise found or error from None


def _columns(
    body: Ascii | Binary, elements: list[Element]
) -> tuple[dict[str, dict[str, Column]], list[str]]:
    tables: dict[str, dict[str, Column]] = {}
    at, lost = 0, []
    for element in elements:
        columns, at = read_rows(body, at, element)
        if element.name in _KEPT and element.name not in tables:
            tables[element.name] = columns
        elif element.count:
            lost.append(f"elements {element.name}")
    left = len(body.cells) - at
    if left and isinstance(body, Ascii):
        raise body.error(at, f"{left} numbers follow the last element")
    if left:
        lost.append(f"{left} bytes after the last element")
    return tables, lost


def _as_written(element: Element) -> Element:
    """Return an element of a text with float64 positions, which may have more digits."""
    types = {name: "f8" for name in POSITION if element.name == "vertex"}
    properties = [replace(p, type=types.get(p.name, p.type)) for p in element.properties]
    return replace(element, properties=properties)


class _Polygons(NamedTuple):
    """Vertex indices, polygon after polygon, and the number of corners of each."""

    corners: Ints
    sizes: Ints


def _faces(faces: dict[str, Column]) -> _Polygons:
    """Return the polygons of the faces, and take their list from the columns."""
    indices = _indices(faces)
    if indices is not None and indices.counts is not None:
        return _Polygons(indices.values.astype(np.int64), indices.counts)
    if any(len(column.values) for column in faces.values()):
        raise MeshError("its faces have no list vertex_indices of whole numbers")
    return _Polygons(np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64))


def _triangles(strips: dict[str, Column]) -> _Polygons:
    """Return the triangles of the strips, and take their list from the columns."""
    indices = _indices(strips)
    if indices is None or indices.counts is None:
        return _Polygons(np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64))
    ends = np.cumsum(indices.counts)[:-1]
    # A strip ends where -1 is, and at the end of a list.
    triangles = triangles_of_strips(np.insert(indices.values.astype(np.int64), ends, -1))
    return _Polygons(triangles.ravel(), np.full(len(triangles), 3, dtype=np.int64))


def _joined_attribute(attribute: Attribute, triangles: _Polygons, first: bool) -> Attribute:
    """Return an attribute of faces, or of their corners, beside triangles, which have no row."""
    others = triangles.sizes if attribute.domain == "face" else triangles.corners
    none, rows = np.full(len(others), -1, dtype=np.int64), attribute.rows()
    return replace(attribute, index=np.concatenate((none, rows) if first else (rows, none)))


def _indices(columns: dict[str, Column]) -> Column | None:
    """Remove the list of vertex indices from the columns of faces and return it."""
    for name in INDICES:
        column = columns.get(name)
        if column is not None and column.counts is not None and column.values.dtype.kind in "iu":
            return columns.pop(name)
    return None


def _scalars(columns: dict[str, Column], domain: Domain) -> list[Attribute]:
    """Return the attributes of the properties that are single numbers; some belong together."""
    names = [name for name, column in columns.items() if column.counts is None]
    kinds = {name: columns[name].values.dtype for name in names}
    found, i = [], 0
    while i < len(names):
        name, role, width = _group(names, i)
        if len({kinds[each] for each in names[i : i + width]}) > 1:
            name, role, width = names[i], role_of(names[i]), 1
        values = np.stack([columns[each].values for each in names[i : i + width]], axis=1)
        normalized = role == "colour" and values.dtype.kind == "u"
        found.append(Attribute(name, domain, values, role, normalized=normalized))
        i += width
    return found


def _group(names: list[str], i: int) -> tuple[str, Any, int]:
    """Return name, role and number of properties of the attribute that begins at the i-th."""
    for group in GROUPS:
        if tuple(names[i : i + len(group.properties)]) == group.properties:
            return group.name, group.role, len(group.properties)
    stem, width = names[i].removesuffix("_0"), 1
    if stem != names[i]:
        while i + width < len(names) and names[i + width] == f"{stem}_{width}":
            width += 1
    name = stem if width > 1 else names[i]
    return name, role_of(name), width


def _lists(columns: dict[str, Column]) -> list[str]:
    return [name for name, column in columns.items() if column.counts is not None]


def _corner_attributes(
    columns: dict[str, Column], sizes: Ints
) -> tuple[list[Attribute], list[str]]:
    """Return attributes of the lists with as many numbers for each corner, and names of others."""
    found, others = [], []
    for list_name in _lists(columns):
        column = columns[list_name]
        counts = column.counts
        assert counts is not None
        has = counts > 0
        width = int(counts[has][0] // sizes[has][0]) if has.any() and sizes[has][0] else 0
        if width == 0 or (counts[has] != width * sizes[has]).any():
            if has.any():
                others.append(list_name)
            continue
        index = None
        if not has.all():
            of_corner = np.repeat(has, sizes)
            index = np.where(of_corner, np.cumsum(of_corner) - 1, -1)
        name = "uv" if list_name == WEDGE_UV else list_name
        values, role = column.values.reshape(-1, width), role_of(name)
        normalized = role == "colour" and values.dtype.kind == "u"
        found.append(Attribute(name, "corner", values, role, index, normalized))
    return found, others
