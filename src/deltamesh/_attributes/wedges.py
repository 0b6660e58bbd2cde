"""Wedges of an attribute: classes of the corners at a point that share a row of values.

A seam is an edge across which the wedges differ; positions do not know of it.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from deltamesh._kernels.coding import wedges as kernels
from deltamesh._kernels.coding.coder import Coder
from deltamesh._shape.polygons import Polygons
from deltamesh._shape.structure import Structure
from deltamesh._shape.wedges import code_wedges
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh_formats.array_types import Ints

_UNKNOWN: Final = np.zeros(0, dtype=np.int64)


def encode_wedges(structure: Structure, polygons: Polygons, rows: Ints) -> tuple[bytes, Ints]:
    """Return the stream of wedges, and the wedge of each corner of the triangles, int64 (3 m,).

    Parameters
    ----------
    structure : Structure
    polygons : Polygons
    rows : int64 (c,)
        Any numbers >= 0 at the corners of the polygons; equal ones at a point are of a wedge.
    """
    wedges = rows[polygons.of_corners]

    def run(coder: Coder) -> None:
        wedges[:] = code_wedges(coder, structure.corners, wedges)

    return encode_with(kernels.MODEL, len(wedges), run), wedges


def decode_wedges(payload: memoryview, begin: int, end: int, structure: Structure) -> Ints:
    """Return the wedges: the mirror of `encode_wedges`.

    Raises
    ------
    FormatError
    """

    def run(coder: Coder) -> Ints:
        return code_wedges(coder, structure.corners, _UNKNOWN)

    return decode_with(kernels.MODEL, payload[begin:end], run, begin)
