"""What the two geometry methods share: what they are given, and what they make of it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from deltamesh.geometry.laplacian import (
    adjacency,
    adjacency_labels,
    adjacency_laplacian,
    adjacency_of_edges,
    edges_between,
)
from deltamesh.shape.topology import NO_QUADS, parallelograms
from deltamesh_formats.errors import FormatError
from deltamesh_formats.layout import CRC_SIZE, Parameters, Section

NO_EDGES: Final = np.zeros(0, dtype=bool)


@dataclass(frozen=True)
class Surface:
    """Connectivity in coding order, and what follows from it.

    Attributes
    ----------
    faces : int64 (m, 3)
    graph : pair of int64 arrays
        Neighbours of the vertices of the faces, as of `laplacian.adjacency`, along the edges of
        polygons.
    isolated_count : int
        Vertices without a face; they come after the others.
    quads : int64 (q, 4)
        The polygons of four corners.
    """

    faces: NDArray[np.int64]
    graph: tuple[NDArray[np.int64], NDArray[np.int64]]
    isolated_count: int
    quads: NDArray[np.int64] = field(default_factory=lambda: NO_QUADS)

    @property
    def vertex_count(self) -> int:
        """Number of vertices of the faces."""
        return len(self.graph[0]) - 1

    @cached_property
    def laplacian(self) -> sparse.csr_array:
        """L = D - A of the graph, float64 (n, n)."""
        return adjacency_laplacian(*self.graph)

    @cached_property
    def labels(self) -> NDArray[np.int64]:
        """The component of each vertex of the faces."""
        return adjacency_labels(*self.graph)

    @cached_property
    def parallelograms(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
        """What predicts each vertex, the isolated ones too, as of `topology.parallelograms`."""
        count = self.vertex_count + self.isolated_count
        return parallelograms(self.faces, count, self.quads)


def surface_of(
    faces: NDArray[np.int64],
    vertex_count: int,
    isolated_count: int,
    hidden: NDArray[np.bool_] = NO_EDGES,
    quads: NDArray[np.int64] = NO_QUADS,
) -> Surface:
    """Return a `Surface` with its graph.

    Half-edges, (3 m,), may be `hidden` within polygons; edges where all are do not count.
    """
    if not len(hidden):
        return Surface(faces, adjacency(faces, vertex_count), isolated_count, quads)
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    pairs = edges_between(start[~hidden], end[~hidden], vertex_count)
    return Surface(faces, adjacency_of_edges(pairs, vertex_count), isolated_count, quads)


@dataclass(frozen=True)
class Integers:
    """The integers of a geometry, exactly as they are entropy-coded.

    Attributes
    ----------
    values : int64 (n, 3)
        Quantized delta coordinates; or grid points, or bit patterns of binary64, with the isolated
        vertices last.
    anchors : int64 (k,)
    positions : int64 (k, 3)
        Grid points of the anchors.
    isolated : int64 (i, 3)
        Grid points of the isolated vertices.
    refinements : int64 (n, 1)
        Of the deltas along the normals; empty where there are none.
    corrections : int64 (n, 3)
        Of the positions, in steps; empty where there are none.
    forms : int64 (k,)
        Bytes that tell how bit patterns are spelled; empty where there are none.
    """

    values: NDArray[np.int64]
    anchors: NDArray[np.int64]
    positions: NDArray[np.int64]
    isolated: NDArray[np.int64]
    refinements: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 1), np.int64))
    corrections: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 3), np.int64))
    forms: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))


# What quantizing returns: what goes into the file, and what a decoder will make of it.
Quantized = tuple[Parameters, Integers, NDArray[np.float64]]

NONE = np.zeros(0, dtype=np.int64)
NO_POINTS = np.zeros((0, 3), dtype=np.int64)


def digest(
    faces: NDArray[np.int64],
    copied: NDArray[np.int64],
    integers: Integers,
    order: Iterable[NDArray[np.int64]] = (),
) -> bytes:
    """Return the checksum of everything exact that a decoder makes (SPEC.md 5.7).

    Parameters
    ----------
    faces : int64 (m, 3)
    copied : int64 (n,) or (0,)
        The point of each vertex, where some have several.
    integers : Integers
    order : int64 arrays
        Of vertices, faces and corners, where it is kept.
    """
    i = integers
    arrays = (
        *(faces, copied, i.values, i.anchors, i.positions, i.isolated, i.refinements),
        *(i.corrections, i.forms, *order),
    )
    result = hashlib.blake2b(digest_size=8)
    for array in arrays:
        result.update(np.ascontiguousarray(array, dtype="<i8").data)
    return result.digest()


@contextmanager
def payload_of(section: Section) -> Iterator[memoryview]:
    """Give the payload of a section; a `FormatError` in it gets its place in the file."""
    payload = memoryview(section.payload)
    try:
        yield payload
    except FormatError as error:
        start = section.offset + section.size - CRC_SIZE - len(payload)
        raise FormatError(f"{section.id}: {error.reason}", start + (error.offset or 0)) from None
