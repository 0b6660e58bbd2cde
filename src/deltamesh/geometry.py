"""What the two geometry methods share: what they are given, and what they make of it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.errors import FormatError
from deltamesh_formats.layout import Section

CRC_SIZE = 4


@dataclass(frozen=True)
class Surface:
    """Connectivity in coding order, and what follows from it.

    Attributes
    ----------
    faces : int64 (m, 3)
    vertex_count : int
        Vertices of the faces.
    isolated_count : int
        Vertices without a face; they come after the others.
    """

    faces: NDArray[np.int64]
    vertex_count: int
    isolated_count: int


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
    """

    values: NDArray[np.int64]
    anchors: NDArray[np.int64]
    positions: NDArray[np.int64]
    isolated: NDArray[np.int64]


NONE = np.zeros(0, dtype=np.int64)
NO_POINTS = np.zeros((0, 3), dtype=np.int64)


def digest(faces: NDArray[np.int64], integers: Integers) -> bytes:
    """Return the checksum of everything exact that a decoder makes (SPEC.md 5.6)."""
    arrays = (faces, integers.values, integers.anchors, integers.positions, integers.isolated)
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
