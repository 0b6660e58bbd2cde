"""Coding the connectivity: a closed manifold in, bytes out, and back.

The payload is three counts (boundary loops, boundary edges, joins), which bound the work and the
memory of the decoder, then what the range coder writes (`deltamesh._kernels.coding.connectivity`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.coding.connectivity import (
    HALFEDGE,
    NEW_VERTEX,
    OK,
    OLD_VERTEX,
    Region,
    grow,
)
from deltamesh._kernels.coding.front import JOINS, new_front
from deltamesh._kernels.coding.valence import MIXERS, MODEL_SIZE, PRIOR, SLOTS
from deltamesh._shape.topology import Topology
from deltamesh._streams import entropy
from deltamesh_formats.container.reader import read_varint
from deltamesh_formats.container.writer import write_varint
from deltamesh_formats.errors import FormatError


@dataclass(frozen=True)
class Connectivity:
    """A mesh in coding order.

    Attributes
    ----------
    faces : int64 (m, 3)
        In the order in which both sides visit them.
    order : int64 (n,)
        The vertex of the topology that each vertex was; isolated ones are not among them.
    starts : int64 (m,)
        The half-edge of the topology with which each face begins.
    """

    faces: NDArray[np.int64]
    order: NDArray[np.int64]
    starts: NDArray[np.int64]


def encode_connectivity(topology: Topology) -> tuple[bytes, Connectivity]:
    """Code the faces of a topology; return the payload and the mesh in coding order."""
    face_count, degree = len(topology.faces), topology.valence
    halfedges = np.empty(3 * face_count, dtype=HALFEDGE)
    halfedges["origin"], halfedges["opposite"] = topology.faces.ravel(), topology.opposite
    halfedges["node"] = -1
    old = np.empty(len(degree), dtype=OLD_VERTEX)
    old["degree"], old["new"] = degree, -1
    region = _region(halfedges, old, int(np.count_nonzero(degree)), face_count)
    front = new_front(len(region.vertices) + face_count)
    coder = entropy.encoder(face_count, SLOTS, MIXERS)
    coder.memory[: len(PRIOR)] = PRIOR
    if grow(coder, front, region, topology.loop_count, topology.vertex_count) != OK:
        raise AssertionError("the region grower lost its way in a manifold")
    counts = (topology.loop_count, topology.boundary_edge_count, int(front.counts[JOINS]))
    return b"".join(map(write_varint, counts)) + entropy.finish(coder), _open(region)


def decode_connectivity(
    payload: memoryview, vertex_count: int, face_count: int
) -> NDArray[np.int64]:
    """Return the faces, int64 (face_count, 3); `vertex_count` is without isolated vertices.

    Raises
    ------
    FormatError
        If no encoder has written the payload; the offset counts from its beginning.
    """
    loops, at = read_varint(payload, 0)
    border, at = read_varint(payload, at)
    joins, at = read_varint(payload, at)
    if loops > border or border > 3 * face_count or joins > face_count + border:
        raise FormatError("the counts of the connectivity contradict each other", 0)
    halfedges, old = np.empty(0, dtype=HALFEDGE), np.empty(0, dtype=OLD_VERTEX)
    region = _region(halfedges, old, vertex_count + loops, face_count + border)
    front = new_front(vertex_count + loops + joins)
    coder = entropy.decoder(payload[at:], SLOTS, MIXERS)
    coder.memory[: len(PRIOR)] = PRIOR
    status = grow(coder, front, region, loops, vertex_count)
    if status != OK or front.counts[JOINS] != joins:
        raise FormatError("the connectivity is corrupt", at)
    entropy.check_end(coder, at)
    faces = _open(region).faces
    if len(faces) != face_count:
        raise FormatError("the connectivity has another number of faces than the header", at)
    if np.bincount(faces.ravel(), minlength=vertex_count).min(initial=1) == 0:
        raise FormatError("a vertex of the connectivity that is in no face", at)
    return faces


def _region(
    halfedges: NDArray[np.void], old: NDArray[np.void], vertices: int, faces: int
) -> Region:
    model = np.zeros(MODEL_SIZE, dtype=np.int64)
    return Region(
        halfedges=halfedges,
        old=old,
        faces=np.empty((faces, 3), dtype=np.int64),
        vertices=np.zeros(vertices, dtype=NEW_VERTEX),
        model=model,
        starts=np.empty(len(halfedges) // 3, dtype=np.int64),
    )


def _open(region: Region) -> Connectivity:
    """Take away the vertices that close the boundary loops, and their faces."""
    real = ~region.vertices["is_loop"]
    index = np.cumsum(real) - 1
    kept = real[region.faces].all(axis=1)
    starts = region.starts[kept] if len(region.starts) else region.starts
    return Connectivity(index[region.faces[kept]], region.vertices["old"][real], starts)
