"""Region growing over a closed triangle mesh, one valence a vertex; `src/core/connectivity.c`."""

from __future__ import annotations

from ctypes import c_void_p
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.front import Front
from deltamesh._kernels.core import OK, address, call, ints_out
from deltamesh_formats.array_types import Ints

HALFEDGE = np.dtype([("start", np.int64), ("opposite", np.int64), ("node", np.int64)])
OLD_VERTEX = np.dtype([("degree", np.int64), ("new", np.int64)])
NEW_VERTEX = np.dtype([("valence", np.int64), ("old", np.int64), ("is_loop", np.int64)])


class Region(NamedTuple):
    """The mesh that is visited (empty arrays when decoding), and what is found.

    Attributes
    ----------
    halfedges : HALFEDGE (3 f,)
        Of the closed mesh: the vertex at which each starts; its opposite; -1, replaced while the
        mesh is visited.
    old : OLD_VERTEX (n,)
        Valence of each vertex; its new index, -1 before its visit.
    faces : int64 (f, 3), vertices : NEW_VERTEX (n,)
        The closed mesh in the order of the visit.
    starts : int64 (f,)
        The half-edge with which each face begins; empty when decoding.
    """

    halfedges: NDArray[Any]
    old: NDArray[Any]
    faces: Ints
    vertices: NDArray[Any]
    starts: Ints


def grow(c: Coder, front: Front, r: Region, loops: int, loop_start: int) -> bool:
    """Visit all faces; return False for a stream that no encoder has written."""
    f = len(r.faces)
    status = call(
        "dm_grow",
        c.pointer,
        front.pointer,
        _records(r.halfedges, HALFEDGE),
        len(r.halfedges),
        _records(r.old, OLD_VERTEX),
        len(r.old),
        ints_out(r.faces, f, 3),
        f,
        _records(r.vertices, NEW_VERTEX),
        len(r.vertices),
        ints_out(r.starts, 0 if c.registers.decoding else f),
        loops,
        loop_start,
    )
    return status == OK


def _records(array: NDArray[Any], dtype: np.dtype[Any]) -> c_void_p:
    if array.dtype != dtype or not array.flags.c_contiguous or not array.flags.writeable:
        raise ValueError(f"an array of {array.dtype}, where the core takes one of {dtype}")
    return address(array)
