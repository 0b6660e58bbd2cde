"""Fronts of a region that grows over a closed triangle mesh; `src/core/front.h`."""

from __future__ import annotations

import ctypes
from ctypes import byref, c_int64, c_void_p
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.core import LIBRARY, address, call, constant, ints_out, invoke, number
from deltamesh_formats.array_types import Ints

_BUCKETS = constant("DM_BUCKETS")

NODE = np.dtype(
    [
        ("vertex", np.int64),
        ("free", np.int64),
        ("successor", np.int64),  # the neighbours on the front
        ("predecessor", np.int64),
        ("behind", np.int64),  # the vertex of the visited face at the gate that is not on it
        ("gate", np.int64),  # the half-edge of the unvisited face at the gate; encoder only
        ("older", np.int64),  # the neighbours in the bucket
        ("newer", np.int64),
        ("index", np.int64),  # in Front.live
    ]
)


class Counts(ctypes.Structure):
    """Numbers of a front; `dm_front` of the core."""

    _fields_: ClassVar = [
        ("nodes", c_void_p),
        ("live", c_void_p),
        ("capacity", c_int64),
        ("node_count", c_int64),  # so far, as the three that follow
        ("vertex_count", c_int64),
        ("face_count", c_int64),
        ("join_count", c_int64),
        ("live_count", c_int64),  # on a front now
        ("lowest", c_int64),  # a lower bound of the lowest bucket in use
        ("oldest", c_int64 * _BUCKETS),
        ("newest", c_int64 * _BUCKETS),
    ]


class Front(NamedTuple):
    """All fronts.

    Attributes
    ----------
    counts : Counts
    nodes : NODE (capacity,)
    live : int64 (capacity,)
        The nodes that are on a front, in no order.
    """

    counts: Counts
    nodes: NDArray[Any]
    live: Ints

    @property
    def pointer(self) -> object:
        """What the core takes."""
        return byref(self.counts)


LIBRARY.dm_choose_pivot.restype = c_int64


def new_front(capacity: int) -> Front:
    """Return an empty front for at most `capacity` nodes."""
    nodes, live = np.empty(capacity, dtype=NODE), np.empty(capacity, dtype=np.int64)
    front = Front(Counts(), nodes, live)
    invoke("dm_start_front", front.pointer, address(nodes), ints_out(live, capacity), capacity)
    return front


def add_node(front: Front, vertex: int, free: int) -> int:
    """Make a new live node; the caller links it."""
    node = number()
    call("dm_add_node", front.pointer, vertex, free, byref(node))
    return node.value


def remove_node(front: Front, node: int) -> None:
    """Take a node off the buckets and the live nodes; the caller mends the front."""
    call("dm_remove_node", front.pointer, node)


def set_free(front: Front, node: int, free: int) -> None:
    """Change the number of free edges of a node."""
    call("dm_set_free", front.pointer, node, free)


def choose_pivot(front: Front) -> int:
    """Return the oldest node with the fewest free edges, -1 when all fronts are closed."""
    return invoke("dm_choose_pivot", front.pointer)
