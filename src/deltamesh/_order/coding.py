"""Section ORDR: the order of vertices and polygons to a payload, and back; SPEC.md 5.11.

An order carries information: each of n! needs log2(n!) bits. Those of real files follow the mesh,
more or less: strips, scan lines, several of them in alternation. Either all vertices come first, in
steps over the mesh, and the polygons refer to them; or the polygons come first, and the vertices
that they are the first to use follow in that order, as most programs number them. The encoder
compares these plans.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from deltamesh._graph.adjacency import adjacency_between
from deltamesh._kernels.coding import face_order, steps, vertex_order
from deltamesh._kernels.coding.coder import Coder
from deltamesh._order.reordering import Order, permuted_corners
from deltamesh._shape.polygons import Polygons
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh_formats.array_types import Ints
from deltamesh_formats.container.fields import read_varint, take, write_varint
from deltamesh_formats.container.payload_layout import (
    PLAN_ANCHOR,
    PLAN_NEWEST,
    PLAN_POLYGONS_FIRST,
    POLYGON_ANCHORS,
)
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.permutations import inverse

_Code = Callable[["_Rows", Order, int, int, int | None], bytes]

# Plans are compared on at most so many vertices and polygons, which takes seconds for any mesh.
SAMPLE = 1 << 17
# Bits by which an anchor has to seem shorter than a rank before it is used.
MARGINS = (0, 2, 4)

_ANCHORS = tuple(sorted(POLYGON_ANCHORS.values()))


class _Rows(NamedTuple):
    """Polygons, each represented by one of its triangles.

    Attributes
    ----------
    faces : int64 (p, 3)
        The vertices of the lowest triangle of each.
    corners : int64 (c,), offsets : int64 (p + 1,)
        The vertices of all corners.
    within : int64 (p, 3)
        The corner of the polygon at each corner of its triangle.
    """

    faces: Ints
    corners: Ints
    offsets: Ints
    within: Ints


def _rows(faces: Ints, polygons: Polygons) -> _Rows:
    """Return the polygons of triangles (m, 3)."""
    offsets, lowest = polygons.offsets, polygons.lowest
    within = polygons.of_corners.reshape(-1, 3)[lowest] - offsets[:-1, None]
    return _Rows(faces[lowest], faces.ravel()[polygons.corners], offsets, within)


def _renamed(rows: _Rows, names: Ints) -> _Rows:
    return rows._replace(faces=names[rows.faces], corners=names[rows.corners])


def encode_order(faces: Ints, polygons: Polygons, order: Order) -> bytes:
    """Return the payload of ORDR.

    Parameters
    ----------
    faces : int64 (m, 3)
        Triangles of the mesh as it is decoded.
    polygons : Polygons
        Their polygons.
    order : Order
        Order of all vertices, isolated ones too, and all polygons.
    """
    rows = _rows(faces, polygons)
    plan, margins = _choose(rows, order)
    of_vertices, of_polygons = (
        code(rows, order, plan, margin, None)
        for code, margin in zip((_vertex_stream, _polygon_stream), margins, strict=True)
    )
    return bytes([plan]) + write_varint(len(of_vertices)) + of_vertices + of_polygons


def _choose(rows: _Rows, order: Order) -> tuple[int, list[int]]:
    """Return the plan that seems best, and the margins of its two streams."""

    def size(code: _Code, plan: int, margin: int) -> float:
        count = len(order.vertices) if code is _vertex_stream else len(order.polygons)
        return len(code(rows, order, plan, margin, SAMPLE)) * max(1.0, count / SAMPLE)

    plans = {}
    for first in (0, PLAN_POLYGONS_FIRST):
        sizes = {key: size(_vertex_stream, first | key, 0) for key in (0, PLAN_NEWEST)}
        others = {key: size(_polygon_stream, first | key, 0) for key in _ANCHORS}
        key, other = min(sizes, key=sizes.__getitem__), min(others, key=others.__getitem__)
        plans[first | key | other] = sizes[key] + others[other]
    plan = min(plans, key=plans.__getitem__)
    margins = [
        min(MARGINS, key=lambda margin: size(code, plan, margin))
        for code in (_vertex_stream, _polygon_stream)
    ]
    return plan, margins


def _vertex_stream(rows: _Rows, order: Order, plan: int, margin: int, stop: int | None) -> bytes:
    """Return the stream of the first `stop` vertices."""
    vertices = order.vertices
    if plan & PLAN_POLYGONS_FIRST:
        names = _by_use(rows, order)
        rows, vertices = _renamed(rows, names), names[vertices]
    run = partial(_code_vertices, rows=rows, plan=plan, vertices=vertices, margin=margin, stop=stop)
    return _stream(len(vertices), stop, run)


def _polygon_stream(rows: _Rows, order: Order, plan: int, margin: int, stop: int | None) -> bytes:
    """Return the stream of the first `stop` polygons."""
    n = len(order.vertices)
    rank = np.full(n, -1) if plan & PLAN_POLYGONS_FIRST else inverse(order.vertices)
    run = partial(
        _code_polygons, rows=rows, plan=plan, rank=rank, order=order, margin=margin, stop=stop
    )
    return _stream(len(order.polygons), stop, run)


def _stream(count: int, stop: int | None, code: Callable[[Coder], bool]) -> bytes:
    def run(coder: Coder) -> None:
        if not code(coder):
            raise AssertionError("the order is not a permutation")

    return encode_with(steps.MODEL, count if stop is None else min(count, stop), run)


def _by_use(rows: _Rows, order: Order) -> Ints:
    """Return the rank of each vertex (n,) by the first polygon that uses it."""
    rank = np.full(len(order.vertices), -1)
    used = rows.corners[permuted_corners(rows.offsets, order.polygons, order.rotations)[0]]
    vertices, first = np.unique(used, return_index=True)
    rank[vertices[np.argsort(first)]] = np.arange(len(vertices))
    return _with_isolated(rank)


def _with_isolated(rank: Ints) -> Ints:
    """Return ranks (n,) with the last ones given to the vertices without a rank, ascending."""
    isolated = np.flatnonzero(rank < 0)
    rank[isolated] = len(rank) - len(isolated) + np.arange(len(isolated))
    return rank


def decode_order(payload: memoryview, faces: Ints, polygons: Polygons, vertex_count: int) -> Order:
    """Return the order: the mirror of `encode_order`.

    Parameters
    ----------
    payload : memoryview
    faces : int64 (m, 3)
    polygons : Polygons
    vertex_count : int
        Number of vertices, with the isolated ones.

    Raises
    ------
    FormatError
        If no encoder has written the payload; the offset counts from its beginning.
    """
    plan = take(payload, 0, 1)[0]
    if plan >= 2 * PLAN_POLYGONS_FIRST or plan & PLAN_ANCHOR not in _ANCHORS:
        raise FormatError(f"unknown order plan: {plan}", 0)
    size, at = read_varint(payload, 1)
    if size > len(payload) - at:
        raise FormatError("the vertex order is longer than its section", 1)
    rows = _rows(faces, polygons)
    vertices = np.empty(vertex_count, dtype=np.int64)
    order = Order(vertices, *np.empty((2, len(rows.faces)), dtype=np.int64))
    of_vertices, of_polygons = payload[at : at + size], payload[at + size :]
    if plan & PLAN_POLYGONS_FIRST:
        rank = np.full(vertex_count, -1)
        _read_polygons(of_polygons, at + size, rows, plan, rank, order)
        names = _with_isolated(rank)
        _read_vertices(of_vertices, at, _renamed(rows, names), plan, vertices)
        return replace(order, vertices=inverse(names)[vertices])
    _read_vertices(of_vertices, at, rows, plan, vertices)
    _read_polygons(of_polygons, at + size, rows, plan, inverse(vertices), order)
    return order


def _read_vertices(stream: memoryview, at: int, rows: _Rows, plan: int, vertices: Ints) -> None:
    def run(coder: Coder) -> None:
        if not _code_vertices(coder, rows, plan, vertices):
            raise FormatError("the vertex order is corrupt", at)

    decode_with(steps.MODEL, stream, run, at)


def _read_polygons(
    stream: memoryview, at: int, rows: _Rows, plan: int, rank: Ints, order: Order
) -> None:
    def run(coder: Coder) -> None:
        if not _code_polygons(coder, rows, plan, rank, order):
            raise FormatError("the polygon order is corrupt", at)

    decode_with(steps.MODEL, stream, run, at)


def _code_vertices(
    coder: Coder,
    rows: _Rows,
    plan: int,
    vertices: Ints,
    margin: int = 0,
    stop: int | None = None,
) -> bool:
    n = len(vertices)
    first, last = rows.offsets[:-1], rows.offsets[1:] - 1
    after = np.arange(1, len(rows.corners) + 1)
    after[last] = first
    indptr, indices = adjacency_between(rows.corners, rows.corners[after], n)
    # By columns, the entries of a symmetric matrix are those by rows, mirrored.
    mirror = inverse(np.argsort(indices, kind="stable"))
    newest = 1 if plan & PLAN_NEWEST else 0
    stop = len(vertices) if stop is None else stop
    return vertex_order.code_vertices(
        coder, indptr, indices, mirror, newest, vertices, margin, stop
    )


def _code_polygons(
    coder: Coder,
    rows: _Rows,
    plan: int,
    rank: Ints,
    order: Order,
    margin: int = 0,
    stop: int | None = None,
) -> bool:
    polygons, rotations = order.polygons, order.rotations
    stop = len(polygons) if stop is None else stop
    ranked = int(np.count_nonzero(rank >= 0))
    anchors = plan & PLAN_ANCHOR
    return face_order.code_faces(
        coder, *rows, rank, ranked, anchors, polygons, rotations, margin, stop
    )
