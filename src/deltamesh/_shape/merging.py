"""Section POLY: the triangles that are merged into polygons.

The payload is the number of polygons, the least and the largest number of corners, and the number
of explicit pairs, then a range coded stream: which half-edges are merged with their candidates, and
the explicit pairs of others (`hidden_edges` and `merged_pairs` in `deltamesh._kernels.coding`).
M. Isenburg, J. Snoeyink, "Face Fixer: compressing polygon meshes with properties", SIGGRAPH 2000,
code polygons edge by edge, too.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from deltamesh._graph.halfedges import ends
from deltamesh._kernels.coding import hidden_edges as kernels
from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.merged_pairs import code_explicit_pairs
from deltamesh._shape.draft import ShapeDraft
from deltamesh._shape.merge_candidates import merged_halfedges
from deltamesh._shape.structure import Structure
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh_formats.array_types import Ints
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.fields import read_varint, write_varint
from deltamesh_formats.errors import FormatError


def applies(draft: ShapeDraft) -> bool:
    """Return whether a polygon is cut into several triangles."""
    polygon = draft.input.triangles.polygon
    return bool((polygon[1:] == polygon[:-1]).any())


def encode(draft: ShapeDraft) -> tuple[bytes, ShapeDraft]:
    """Return the payload of POLY, and the draft with its polygons; the mirror is `decode`."""
    triangles, structure = draft.input.triangles, draft.structure
    merged = merged_halfedges(triangles, draft.triangle_provenance.corners)
    sizes = np.bincount(triangles.polygon) + 2
    payload = encode_merged(structure.faces, structure.merge_candidates, merged, sizes)
    return payload, replace(draft, structure=replace(structure, merged=merged))


def decode(payload: memoryview, container: Container, structure: Structure) -> Structure:
    """Return the structure with its polygons: the mirror of `encode`.

    Raises
    ------
    FormatError
        If no encoder has written the payload; the offset counts from its beginning.
    """
    merged = decode_merged(payload, structure.faces, structure.merge_candidates)
    return replace(structure, merged=merged)


def encode_merged(faces: Ints, candidate: Ints, merged: Ints, sizes: Ints) -> bytes:
    """Return the payload of POLY.

    Parameters
    ----------
    faces : int64 (m, 3)
        Of the mesh, in coding order.
    candidate, merged : int64 (3 m,)
        As `merge_candidates` and `merged_halfedges` return them.
    sizes : int64 (p,)
        Corners of the polygons.
    """
    m, least, most = len(faces), int(sizes.min()), int(sizes.max())
    explicit = (merged >= 0) & (merged != candidate)
    total = int(np.count_nonzero(explicit)) // 2
    pairs, others = np.where(explicit, merged, -1), np.where(explicit, -1, merged)
    stream = encode_with(
        kernels.MODEL,
        3 * m,
        lambda coder: _code(coder, faces, candidate, others, pairs, least, most, total),
    )
    return b"".join(map(write_varint, (len(sizes), least, most, total))) + stream


def decode_merged(payload: memoryview, faces: Ints, candidate: Ints) -> Ints:
    """Return the merged half-edges, int64 (3 m,): the mirror of `encode_merged`.

    Raises
    ------
    FormatError
        If no encoder has written the payload; the offset counts from its beginning.
    """
    count, at = read_varint(payload, 0)
    least, at = read_varint(payload, at)
    most, at = read_varint(payload, at)
    total, at = read_varint(payload, at)
    m = len(faces)
    if not 0 < count < m or not 3 <= least <= most <= m + 2 or total > m - count:
        raise FormatError("the counts of the polygons contradict those of the header", 0)
    merged = np.full(3 * m, -1, dtype=np.int64)
    none = np.zeros(0, dtype=np.int64)

    def run(coder: Coder) -> Ints:
        sizes = _code(coder, faces, candidate, merged, none, least, most, total)
        if sizes is None:
            raise FormatError("explicit pairs: a half-edge that cannot be merged, or too few", at)
        return sizes

    sizes = decode_with(kernels.MODEL, payload[at:], run, at)
    if len(sizes) != count or sizes.min() != least or sizes.max() != most:
        raise FormatError("the polygons have other numbers of corners than announced", at)
    return merged


def _code(
    coder: Coder,
    faces: Ints,
    candidate: Ints,
    merged: Ints,
    pairs: Ints,
    least: int,
    most: int,
    total: int,
) -> Ints | None:
    """Code the merged half-edges, filled in when decoding; return the sizes of the polygons.

    None for a corrupt stream. pairs : int64 (3 m,), the explicit ones; empty when decoding.
    """
    m = len(faces)
    parent, size = np.arange(m), np.full(m, 3)
    corners, count = faces.ravel(), int(faces.max()) + 1
    more = total > 0
    kernels.code_hidden(coder, corners, count, candidate, merged, parent, size, least, most, more)
    if more and not code_explicit_pairs(
        coder, candidate, pairs, merged, parent, size, most, total, *halfedge_groups(faces)
    ):
        return None
    sizes: Ints = size[parent == np.arange(m)]
    return sizes


def halfedge_groups(faces: Ints) -> tuple[Ints, Ints, Ints, Ints]:
    """Return half-edges grouped by their two ends; see `merged_pairs.code_explicit_pairs`."""
    start, end = ends(faces)
    n = int(faces.max()) + 1
    keys, group = np.unique(start * n + end, return_inverse=True)
    back = keys % n * n + keys // n
    across = np.searchsorted(keys, back)
    across[across == len(keys)] = 0
    across = np.where(keys[across] == back, across, -1)
    bounds = np.concatenate(([0], np.cumsum(np.bincount(group, minlength=len(keys)))))
    return np.argsort(group, kind="stable"), group.astype(np.int64), across, bounds
