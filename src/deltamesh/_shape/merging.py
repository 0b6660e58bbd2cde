"""Coding which triangles make a polygon (section POLY).

A polygon of k corners is k - 2 triangles, glued along k - 3 edges that are hidden then. So edges
that polygons have are told from those that they have not: M. Isenburg, J. Snoeyink, "Face Fixer:
compressing polygon meshes with properties", SIGGRAPH 2000, code polygons edge by edge, too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.halfedges import ends
from deltamesh._kernels.coding import hidden_edges as kernels
from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.merged_pairs import code_listed
from deltamesh._streams import entropy
from deltamesh_formats.container.reader import read_varint
from deltamesh_formats.container.writer import write_varint
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.triangles import Triangles

_Ints = NDArray[np.int64]
_Bools = NDArray[np.bool_]


def glued_halfedges(triangles: Triangles, corners: _Ints) -> _Ints:
    """Return the half-edge that each half-edge of a file is glued to, int64 (3 m,), or -1.

    Parameters
    ----------
    triangles : Triangles
        Of the input, fans.
    corners : int64 (m, 3)
        The corner of them at each corner of the triangles of the file.
    """
    place = np.empty(corners.size, dtype=np.int64)
    place[corners.ravel()] = np.arange(corners.size)
    same = np.flatnonzero(triangles.polygon[1:] == triangles.polygon[:-1])
    # In a fan around a, the edge from i + 1 to a, and that from a to i + 1 of the next triangle.
    one, other = place[3 * same + 2], place[3 * same + 3]
    glued = np.full(corners.size, -1, dtype=np.int64)
    glued[one], glued[other] = other, one
    return glued


def partners(faces: _Ints, opposite: _Ints, turned: _Bools) -> _Ints:
    """Return the half-edge of the mesh that each may be glued to, int64 (3 m,), or -1.

    That is the one across the edge in the manifold, where it is between the same two vertices and
    in the opposite way in the mesh. Of the others, on each edge, the first that runs from its lower
    to its higher vertex is with the first that runs back, the second with the second, and so on.

    Parameters
    ----------
    faces : int64 (m, 3)
        Of the mesh; first those of the manifold.
    opposite : int64 (3 k,), of the manifold
    turned : bool (k,)
    """
    start, end = ends(faces)
    partner = np.full(len(start), -1, dtype=np.int64)
    h = np.flatnonzero(opposite >= 0)
    one, other = _of_mesh(h, turned), _of_mesh(opposite[h], turned)
    fit = (start[one] == end[other]) & (end[one] == start[other])
    partner[one[fit]] = other[fit]

    rest = np.flatnonzero((partner < 0) & (start != end))
    if not len(rest):
        return partner
    low, high = np.minimum(start, end)[rest], np.maximum(start, end)[rest]
    back = start[rest] > end[rest]
    order = np.lexsort((rest, back, high, low))
    low, high, back, rest = low[order], high[order], back[order], rest[order]
    new = np.flatnonzero((low[1:] != low[:-1]) | (high[1:] != high[:-1])) + 1
    first, size = np.concatenate(([0], new)), np.diff(np.concatenate(([0], new, [len(rest)])))
    forward = size - np.add.reduceat(back.astype(np.int64), first)
    pairs = np.minimum(forward, size - forward)
    rank = np.arange(pairs.sum()) - np.repeat(np.cumsum(pairs) - pairs, pairs)
    first, forward = np.repeat(first, pairs), np.repeat(forward, pairs)
    one, other = rest[first + rank], rest[first + forward + rank]
    partner[one], partner[other] = other, one
    return partner


def _of_mesh(halfedges: _Ints, turned: _Bools) -> _Ints:
    """Return half-edges of the manifold as half-edges of the mesh, or the other way round."""
    face, side = np.divmod(halfedges, 3)
    return 3 * face + np.where(turned[face], 2 - side, side)


def hidden_halfedges(glued: _Ints, opposite: _Ints, turned: _Bools) -> _Bools:
    """Tell which half-edges of the manifold (3 k,) are glued to the one across the edge."""
    h = np.arange(len(opposite))
    other = np.where(opposite >= 0, _of_mesh(opposite, turned), -2)
    return np.asarray(glued[_of_mesh(h, turned)] == other)


def encode_polygons(faces: _Ints, partner: _Ints, glued: _Ints, sizes: _Ints) -> bytes:
    """Return the payload of POLY.

    Parameters
    ----------
    faces : int64 (m, 3)
        Of the mesh, in coding order.
    partner, glued : int64 (3 m,)
        As of `partners` and of `glued_halfedges`.
    sizes : int64 (p,)
        Corners of the polygons.
    """
    m, least, most = len(faces), int(sizes.min()), int(sizes.max())
    listed = (glued >= 0) & (glued != partner)
    total = int(np.count_nonzero(listed)) // 2
    coder = entropy.encoder(3 * m, kernels.SLOTS, kernels.MIXERS)
    wanted = np.where(listed, glued, -1)
    _code(coder, faces, partner, np.where(listed, -1, glued), wanted, least, most, total)
    header = b"".join(map(write_varint, (len(sizes), least, most, total)))
    return header + entropy.finish(coder)


def decode_polygons(payload: memoryview, faces: _Ints, partner: _Ints) -> _Ints:
    """Return what is glued, int64 (3 m,): the mirror of `encode_polygons`.

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
    coder = entropy.decoder(payload[at:], kernels.SLOTS, kernels.MIXERS)
    glued = np.full(3 * m, -1, dtype=np.int64)
    none = np.zeros(0, dtype=np.int64)
    sizes = _code(coder, faces, partner, glued, none, least, most, total)
    if sizes is None:
        raise FormatError("a polygon is glued to what it cannot be", at)
    entropy.check_end(coder, at)
    if len(sizes) != count or sizes.min() != least or sizes.max() != most:
        raise FormatError("the polygons have other numbers of corners than announced", at)
    return glued


def _code(
    coder: Coder,
    faces: _Ints,
    partner: _Ints,
    glued: _Ints,
    wanted: _Ints,
    least: int,
    most: int,
    total: int,
) -> _Ints | None:
    """Code what is glued, filled in when decoding; return the sizes of polygons, None: corrupt."""
    m = len(faces)
    parent, size = np.arange(m), np.full(m, 3)
    corners, count = faces.ravel(), int(faces.max()) + 1
    listed = total > 0
    kernels.code_hidden(coder, corners, count, partner, glued, parent, size, least, most, listed)
    if listed and not code_listed(
        coder, partner, wanted, glued, parent, size, most, total, *ways(faces)
    ):
        return None
    sizes: _Ints = size[parent == np.arange(m)]
    return sizes


def ways(faces: _Ints) -> tuple[_Ints, _Ints, _Ints, _Ints]:
    """Return half-edges grouped by where they start and end; see `kernels.listed.code_listed`."""
    start, end = ends(faces)
    n = int(faces.max()) + 1
    keys, group = np.unique(start * n + end, return_inverse=True)
    back = keys % n * n + keys // n
    across = np.searchsorted(keys, back)
    across[across == len(keys)] = 0
    across = np.where(keys[across] == back, across, -1)
    bounds = np.concatenate(([0], np.cumsum(np.bincount(group, minlength=len(keys)))))
    return np.argsort(group, kind="stable"), group.astype(np.int64), across, bounds
