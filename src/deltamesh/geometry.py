"""What the two geometry methods share: what they are given, and what they make of it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from deltamesh.laplacian import adjacency
from deltamesh_formats.errors import FormatError
from deltamesh_formats.layout import CRC_SIZE, Section


@dataclass(frozen=True)
class Surface:
    """Connectivity in coding order, and what follows from it.

    Attributes
    ----------
    faces : int64 (m, 3)
    graph : pair of int64 arrays
        Neighbours of the vertices of the faces, as of `laplacian.adjacency`.
    isolated_count : int
        Vertices without a face; they come after the others.
    """

    faces: NDArray[np.int64]
    graph: tuple[NDArray[np.int64], NDArray[np.int64]]
    isolated_count: int

    @property
    def vertex_count(self) -> int:
        """Number of vertices of the faces."""
        return len(self.graph[0]) - 1


def surface_of(faces: NDArray[np.int64], vertex_count: int, isolated_count: int) -> Surface:
    """Return a `Surface` with its graph."""
    return Surface(faces, adjacency(faces, vertex_count), isolated_count)


@dataclass(frozen=True)
class Integers:
    """The integers of a geometry, exactly as they are entropy-coded.

    Attributes
    ----------
    values : int64 (n, 3)
        Quantized delta coordinates, or grid points with the isolated vertices last.
    anchors : int64 (k,)
    positions : int64 (k, 3)
        Grid points of the anchors.
    isolated : int64 (i, 3)
        Grid points of the isolated vertices.
    refinements : int64 (n, 1)
        Of the deltas along the normals; empty where there are none.
    """

    values: NDArray[np.int64]
    anchors: NDArray[np.int64]
    positions: NDArray[np.int64]
    isolated: NDArray[np.int64]
    refinements: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 1), np.int64))


NONE = np.zeros(0, dtype=np.int64)
NO_POINTS = np.zeros((0, 3), dtype=np.int64)


def digest(faces: NDArray[np.int64], integers: Integers, copied: NDArray[np.int64] = NONE) -> bytes:
    """Return the checksum of everything exact that a decoder makes (SPEC.md 5.7)."""
    i = integers
    arrays = (faces, copied, i.values, i.anchors, i.positions, i.isolated, i.refinements)
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
