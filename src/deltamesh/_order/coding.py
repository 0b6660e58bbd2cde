"""Keeping the order of vertices and faces: permutations of a known mesh in, bytes out, and back.

An order is not without information: n! of them want log2(n!) bits. Those of real files follow the
mesh, more or less: strips, scan lines, several of them in turns. Either all vertices come first, in
steps over the mesh, and the faces are told by them; or the faces come first, and the vertices that
they are the first to use come next, as most programs number them. The encoder tries.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.adjacency import adjacency_of_edges, edges_between
from deltamesh._graph.permutations import inverse
from deltamesh._kernels.coding import face_order, steps, vertex_order
from deltamesh._kernels.coding.coder import Coder
from deltamesh._order.reordering import Order, rows_of
from deltamesh._shape.polygons import Polygons
from deltamesh._streams import entropy
from deltamesh_formats.container.reader import read_varint, take
from deltamesh_formats.container.writer import write_varint
from deltamesh_formats.errors import FormatError

_Ints = NDArray[np.int64]
_Stream = Callable[["_Rows", Order, int, int, int | None], bytes]

# Plans are compared on so many vertices and faces, at most: enough to tell, seconds for any mesh.
SAMPLE = 1 << 17
# How much shorter than a rank an anchor has to seem before it is used, in bits.
MARGINS = (0, 2, 4)

# The bits of a plan: the anchors of faces; the newest neighbours as anchors; faces first.
ANCHORS, NEWEST, FACES_FIRST = 3, 4, 8


class _Rows(NamedTuple):
    """Polygons, each told by a triangle of it.

    Attributes
    ----------
    faces : int64 (p, 3)
        The vertices of the lowest triangle of each.
    corners : int64 (c,), offsets : int64 (p + 1,)
        The vertices of all corners.
    within : int64 (p, 3)
        Which corner of the polygon each corner of its triangle is.
    """

    faces: _Ints
    corners: _Ints
    offsets: _Ints
    within: _Ints


def _rows(faces: _Ints, polygons: Polygons) -> _Rows:
    """Return the polygons of triangles (m, 3)."""
    offsets, lowest = polygons.offsets, polygons.lowest
    within = polygons.of_corners.reshape(-1, 3)[lowest] - offsets[:-1, None]
    return _Rows(faces[lowest], faces.ravel()[polygons.corners], offsets, within)


def _renamed(rows: _Rows, names: _Ints) -> _Rows:
    return rows._replace(faces=names[rows.faces], corners=names[rows.corners])


def encode_order(faces: _Ints, polygons: Polygons, order: Order) -> bytes:
    """Return the payload of ORDR.

    Parameters
    ----------
    faces : int64 (m, 3)
        Of the mesh as it is decoded; any triangles.
    polygons : Polygons
        Of these.
    order : Order
        Of all vertices, isolated ones too, and all polygons.
    """
    rows = _rows(faces, polygons)
    plan, margins = _choose(rows, order)
    of_vertices, of_faces = (
        code(rows, order, plan, margin, None)
        for code, margin in zip((_vertex_stream, _face_stream), margins, strict=True)
    )
    return bytes([plan]) + write_varint(len(of_vertices)) + of_vertices + of_faces


def _choose(rows: _Rows, order: Order) -> tuple[int, list[int]]:
    """Return the plan that seems best, and the margins of its two streams."""

    def size(code: _Stream, plan: int, margin: int) -> float:
        count = len(order.vertices) if code is _vertex_stream else len(order.faces)
        return len(code(rows, order, plan, margin, SAMPLE)) * max(1.0, count / SAMPLE)

    plans = {}
    for first in (0, FACES_FIRST):
        sizes = {key: size(_vertex_stream, first | key, 0) for key in (0, NEWEST)}
        others = {key: size(_face_stream, first | key, 0) for key in range(ANCHORS)}
        key, other = min(sizes, key=sizes.__getitem__), min(others, key=others.__getitem__)
        plans[first | key | other] = sizes[key] + others[other]
    plan = min(plans, key=plans.__getitem__)
    margins = [
        min(MARGINS, key=lambda margin: size(code, plan, margin))
        for code in (_vertex_stream, _face_stream)
    ]
    return plan, margins


def _vertex_stream(rows: _Rows, order: Order, plan: int, margin: int, stop: int | None) -> bytes:
    """Return the stream of the first `stop` vertices."""
    vertices = order.vertices
    if plan & FACES_FIRST:
        names = _by_use(rows, order)
        rows, vertices = _renamed(rows, names), names[vertices]
    coder = _encoder(len(vertices), stop)
    status = _code_vertices(coder, rows, plan, vertices, margin, stop)
    return _finished(coder, status)


def _face_stream(rows: _Rows, order: Order, plan: int, margin: int, stop: int | None) -> bytes:
    """Return the stream of the first `stop` faces."""
    n = len(order.vertices)
    places = np.full(n, -1) if plan & FACES_FIRST else inverse(order.vertices)
    coder = _encoder(len(order.faces), stop)
    status = _code_faces(coder, rows, plan, places, order.faces, order.turns, margin, stop)
    return _finished(coder, status)


def _encoder(count: int, stop: int | None) -> Coder:
    elements = count if stop is None else min(count, stop)
    return entropy.encoder(elements, steps.SLOTS, steps.MIXERS)


def _finished(coder: Coder, status: int) -> bytes:
    if status != steps.OK:
        raise AssertionError("no permutation")
    return entropy.finish(coder)


def _by_use(rows: _Rows, order: Order) -> _Ints:
    """Return the place of each vertex (n,) if places go by their first use in a face."""
    places = np.full(len(order.vertices), -1)
    used = rows.corners[rows_of(rows.offsets, order.faces, order.turns)[0]]
    vertices, first = np.unique(used, return_index=True)
    places[vertices[np.argsort(first)]] = np.arange(len(vertices))
    return _with_the_unused(places)


def _with_the_unused(places: _Ints) -> _Ints:
    """Give the last places to the vertices that have none yet, in ascending order."""
    unused = np.flatnonzero(places < 0)
    places[unused] = len(places) - len(unused) + np.arange(len(unused))
    return places


def decode_order(payload: memoryview, faces: _Ints, polygons: Polygons, vertex_count: int) -> Order:
    """Return what `encode_order` was given.

    Parameters
    ----------
    payload : memoryview
    faces : int64 (m, 3)
    polygons : Polygons
    vertex_count : int
        With isolated vertices.

    Raises
    ------
    FormatError
        If no encoder has written the payload; the offset counts from its beginning.
    """
    plan = take(payload, 0, 1)[0]
    if plan >= 2 * FACES_FIRST or plan & 3 == ANCHORS:
        raise FormatError("an unknown plan of the order", 0)
    size, at = read_varint(payload, 1)
    if size > len(payload) - at:
        raise FormatError("the order of the vertices is longer than its section", 1)
    rows = _rows(faces, polygons)
    vertices = np.empty(vertex_count, dtype=np.int64)
    order, turns = np.empty((2, len(rows.faces)), dtype=np.int64)
    if plan & FACES_FIRST:
        places = np.full(vertex_count, -1)
        _read_faces(payload[at + size :], at + size, rows, plan, places, order, turns)
        names = _with_the_unused(places)
        _read_vertices(payload[at : at + size], at, _renamed(rows, names), plan, vertices)
        vertices = inverse(names)[vertices]
    else:
        _read_vertices(payload[at : at + size], at, rows, plan, vertices)
        places = inverse(vertices)
        _read_faces(payload[at + size :], at + size, rows, plan, places, order, turns)
    return Order(vertices, order, turns)


def _read_vertices(stream: memoryview, at: int, rows: _Rows, plan: int, vertices: _Ints) -> None:
    coder = entropy.decoder(stream, steps.SLOTS, steps.MIXERS)
    if _code_vertices(coder, rows, plan, vertices) != steps.OK:
        raise FormatError("the order of the vertices is corrupt", at)
    entropy.check_end(coder, at)


def _read_faces(
    stream: memoryview, at: int, rows: _Rows, plan: int, places: _Ints, order: _Ints, turns: _Ints
) -> None:
    coder = entropy.decoder(stream, steps.SLOTS, steps.MIXERS)
    if _code_faces(coder, rows, plan, places, order, turns) != steps.OK:
        raise FormatError("the order of the faces is corrupt", at)
    entropy.check_end(coder, at)


def _code_vertices(
    coder: Coder,
    rows: _Rows,
    plan: int,
    vertices: _Ints,
    margin: int = 0,
    stop: int | None = None,
) -> int:
    n = len(vertices)
    first, last = rows.offsets[:-1], rows.offsets[1:] - 1
    after = np.arange(1, len(rows.corners) + 1)
    after[last] = first
    pairs = edges_between(rows.corners, rows.corners[after], n)
    indptr, indices = adjacency_of_edges(pairs, n)
    # By columns, the entries of a symmetric matrix are those by rows, mirrored.
    mirror = inverse(np.argsort(indices, kind="stable"))
    newest = 1 if plan & NEWEST else 0
    stop = len(vertices) if stop is None else stop
    status: int = vertex_order.code_vertices(
        coder, indptr, indices, mirror, newest, vertices, margin, stop
    )
    return status


def _code_faces(
    coder: Coder,
    rows: _Rows,
    plan: int,
    places: _Ints,
    order: _Ints,
    turns: _Ints,
    margin: int = 0,
    stop: int | None = None,
) -> int:
    stop = len(order) if stop is None else stop
    placed = int(np.count_nonzero(places >= 0))
    anchors = plan & ANCHORS
    status: int = face_order.code_faces(
        coder, *rows, places, placed, anchors, order, turns, margin, stop
    )
    return status
