"""Section CONN: the connectivity of an oriented manifold.

The payload is three counts (boundary loops, boundary edges, joins), which bound the work and the
memory of the decoder, then a range coded stream (`deltamesh._kernels.coding.connectivity`).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.connectivity import (
    HALFEDGE,
    NEW_VERTEX,
    OLD_VERTEX,
    Region,
    grow,
)
from deltamesh._kernels.coding.front import new_front
from deltamesh._kernels.coding.valence import MODEL
from deltamesh._shape.announced import announced
from deltamesh._shape.coding_order import in_coding_order
from deltamesh._shape.draft import ShapeDraft
from deltamesh._shape.manifold import CodedManifold, Manifold, trivial
from deltamesh._shape.structure import Complex, Structure, structure_of
from deltamesh._shape.topology import Topology, build_topology
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh_formats.array_types import Bools, Ints
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.fields import read_varint, write_varint
from deltamesh_formats.container.layout import ATTRIBUTES, POLYGONS, SPLIT_VERTICES, STITCHES
from deltamesh_formats.errors import FormatError

# The sections whose decoders walk from half-edge to half-edge.
_NEED_MANIFOLD: Final = frozenset({STITCHES, SPLIT_VERTICES, POLYGONS, ATTRIBUTES})


def applies(draft: ShapeDraft) -> bool:
    """Return True: every file has this section."""
    return True


def encode(draft: ShapeDraft) -> tuple[bytes, ShapeDraft]:
    """Return the payload of CONN, and the draft in coding order; the mirror is `decode`."""
    cut = draft.cut
    assert cut is not None
    topology = build_topology(cut.faces, cut.opposite, len(cut.points))
    payload, coded = encode_connectivity(topology)
    return payload, in_coding_order(draft, cut, coded)


def decode(payload: memoryview, container: Container, structure: Structure) -> Structure:
    """Return the structure of a manifold: the mirror of `encode`.

    Raises
    ------
    FormatError
        If no encoder has written the payload, or if a section needs a manifold that its faces do
        not form; the offset counts from its beginning.
    """
    counts = announced(container)
    faces = decode_connectivity(payload, counts.vertices, counts.faces)
    manifold = Manifold(faces, counts.vertices)
    if _NEED_MANIFOLD & container.sections.keys() and not manifold.is_sound:
        raise FormatError("the faces form no manifold", 0)
    stitches, used = trivial(counts.vertices, counts.faces), counts.points - counts.isolated
    return structure_of(Complex(manifold, stitches, used, counts.isolated))


def encode_connectivity(topology: Topology) -> tuple[bytes, CodedManifold]:
    """Code the faces of a topology; return the payload and the manifold in coding order."""
    face_count, degree = len(topology.faces), topology.valence
    halfedges = np.empty(3 * face_count, dtype=HALFEDGE)
    halfedges["start"], halfedges["opposite"] = topology.faces.ravel(), topology.opposite
    halfedges["node"] = -1
    old = np.empty(len(degree), dtype=OLD_VERTEX)
    old["degree"], old["new"] = degree, -1
    region = _region(halfedges, old, int(np.count_nonzero(degree)), face_count)
    front = new_front(len(region.vertices) + face_count)

    def run(coder: Coder) -> None:
        if not grow(coder, front, region, topology.loop_count, topology.vertex_count):
            raise AssertionError("the region grower failed on a manifold")

    stream = encode_with(MODEL, face_count, run)
    del halfedges, old
    region = region._replace(halfedges=region.halfedges[:0], old=region.old[:0])
    counts = (topology.loop_count, topology.boundary_edge_count, front.counts.join_count)
    faces, is_open = _open(region)
    starts, order = region.starts[is_open], region.vertices["old"][region.vertices["is_loop"] == 0]
    manifold = Manifold(faces, len(order))
    payload = b"".join(map(write_varint, counts)) + stream
    return payload, CodedManifold(manifold, order, starts)


def decode_connectivity(payload: memoryview, vertex_count: int, face_count: int) -> Ints:
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

    def run(coder: Coder) -> None:
        sound = grow(coder, front, region, loops, vertex_count)
        if not sound or front.counts.join_count != joins:
            raise FormatError("the connectivity is corrupt", at)

    decode_with(MODEL, payload[at:], run, at)
    faces, _ = _open(region)
    if len(faces) != face_count:
        raise FormatError("the connectivity has another number of faces than the header", at)
    if np.bincount(faces.ravel(), minlength=vertex_count).min(initial=1) == 0:
        raise FormatError("a vertex of the connectivity is in no face", at)
    return faces


def _region(
    halfedges: NDArray[np.void], old: NDArray[np.void], vertices: int, faces: int
) -> Region:
    return Region(
        halfedges=halfedges,
        old=old,
        faces=np.empty((faces, 3), dtype=np.int64),
        vertices=np.zeros(vertices, dtype=NEW_VERTEX),
        starts=np.empty(len(halfedges) // 3, dtype=np.int64),
    )


def _open(region: Region) -> tuple[Ints, Bools]:
    """Return the faces without those that close boundary loops, and which of all faces they are.

    Those of the region are renumbered in place.
    """
    faces, real = region.faces, region.vertices["is_loop"] == 0
    if real.all():
        return faces, np.ones(len(faces), dtype=bool)
    kept = real[faces].all(axis=1)
    faces = faces[kept]
    np.take(np.cumsum(real) - 1, faces, out=faces)
    return faces, kept
