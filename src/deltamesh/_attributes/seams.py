"""The corners of a mesh in classes: what shares a row of an attribute at a point.

A seam runs where the classes on both sides of an edge differ; positions do not know of it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.coding import wedges as kernels
from deltamesh._shape.polygons import Polygons
from deltamesh._shape.structure import Structure
from deltamesh._shape.wedges import code_wedges
from deltamesh._streams import entropy

_Ints = NDArray[np.int64]


def encode_classes(structure: Structure, polygons: Polygons, rows: _Ints) -> tuple[bytes, _Ints]:
    """Return the stream of classes, and the class of each corner of the triangles, (3 m,).

    Parameters
    ----------
    structure : Structure
    polygons : Polygons
    rows : int64 (c,)
        Any numbers >= 0 at the corners of the polygons; equal ones at a point are of a class.
    """
    coder = entropy.encoder(len(polygons.of_corners), kernels.SLOTS, kernels.MIXERS)
    classes = code_wedges(coder, structure.corners, rows[polygons.of_corners])
    return entropy.finish(coder), classes


def decode_classes(payload: memoryview, begin: int, end: int, structure: Structure) -> _Ints:
    """Return the classes: the mirror of `encode_classes`.

    Raises
    ------
    FormatError
    """
    coder = entropy.decoder(payload[begin:end], kernels.SLOTS, kernels.MIXERS)
    classes = code_wedges(coder, structure.corners, np.zeros(0, dtype=np.int64))
    entropy.check_end(coder, begin)
    return classes
