"""Correspondence of the vertices of two meshes that are equal up to the order of their elements.

Decoding gives vertices and faces in another order and, with losses, in other places; metrics need
pairs. Colours that depend on connectivity alone (B. Weisfeiler, A. Leman, "The reduction of a graph
to canonical form", 1968) tell most vertices apart. One pair of faces then settles a whole patch,
walking over both meshes at once; positions only choose between pairs that connectivity allows.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy.sparse as sparse
from scipy.spatial import cKDTree

from deltamesh._graph.adjacency import adjacency
from deltamesh._graph.halfedges import by_edge, edges_of_two, ends
from deltamesh._kernels.mesh import correspondence as kernels
from deltamesh._mesh import TriangleMesh, triangulated
from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.polymesh.mesh import PolyMesh

# Rounds of colouring: a colour sees this many edges far.
ROUNDS = 4
# Vertices of the other mesh that are tried for a seed, the nearest of the right colour.
NEAREST = 32
# Above this size a colour class is searched by a tree over all vertices instead of one by one.
_SCAN = 256
# Rounds of matching isolated vertices to their nearest; what is left then is paired in order.
_ISOLATED_ROUNDS = 16


def match(reference: TriangleMesh, other: TriangleMesh) -> Ints | None:
    """Return the vertex of the other mesh that each vertex of the reference is, where there is one.

    Parameters
    ----------
    reference, other : TriangleMesh
        In the same frame. Positions may differ; they serve to choose among the symmetries of the
        connectivity, and to pair isolated vertices.

    Returns
    -------
    int64 (n,) or None
        Vertex i of the reference is vertex `map[i]` of the other. Faces correspond exactly, with
        their orientation and up to rotation. None when the connectivity differs (or is so
        symmetric, over patches that touch in single vertices or in edges of three and more faces,
        that nearest positions mislead).
    """
    n = len(reference.vertices)
    if n != len(other.vertices) or len(reference.faces) != len(other.faces):
        return None
    if np.array_equal(reference.faces, other.faces):
        return np.arange(n)
    colours = _colours(reference.faces, n), _colours(other.faces, n)
    if not np.array_equal(np.sort(colours[0]), np.sort(colours[1])):
        return None
    mapping = _match_faces(reference, other, *colours)
    if mapping is None:
        return None
    _match_isolated(reference.vertices, other.vertices, mapping)
    return mapping if same_faces(mapping[reference.faces], other.faces) else None


def match_polygons(reference: PolyMesh, other: PolyMesh) -> Ints | None:
    """Return `match` of meshes of polygons, which may begin at any of their corners.

    Where one has polygons and the other triangles for them, the triangles are matched.
    """
    if not np.array_equal(np.sort(reference.sizes), np.sort(other.sizes)):
        return match(triangulated(reference), triangulated(other))
    mapping, n = match(_starred(reference), _starred(other)), len(reference.vertices)
    if mapping is None or (mapping[:n] >= n).any():
        return None
    return mapping[:n]


def _starred(mesh: PolyMesh) -> TriangleMesh:
    """Return triangles from each edge of a polygon to a vertex in the middle of it."""
    corners, offsets, sizes = mesh.corners, mesh.offsets, mesh.sizes
    polygon = np.repeat(np.arange(len(sizes)), sizes)
    many = sizes > 3
    after = np.arange(1, len(corners) + 1)
    after[offsets[1:] - 1] = offsets[:-1]
    middles = np.add.reduceat(mesh.vertices[corners], offsets[:-1], axis=0) / sizes[:, None]
    number = len(mesh.vertices) + np.cumsum(many) - 1
    chosen = many[polygon]
    fans = np.stack([number[polygon], corners, corners[after]], axis=1)[chosen]
    faces = np.concatenate([corners[~chosen].reshape(-1, 3), fans])
    return TriangleMesh(np.concatenate([mesh.vertices, middles[many]]), faces)


def same_faces(faces: Ints, others: Ints) -> bool:
    """Return whether two face arrays (m, 3) are equal up to the order and the rotation of faces."""
    if faces.shape != others.shape:
        return False
    faces, others = canonical(faces), canonical(others)
    return np.array_equal(faces[np.lexsort(faces.T)], others[np.lexsort(others.T)])


def canonical(F: Ints) -> Ints:
    """Return each face in the lexicographically least of its rotations."""
    best = F
    for turned in (np.roll(F, -1, axis=1), np.roll(F, -2, axis=1)):
        a, b = turned.T, best.T
        less = (a[2] < b[2]) & (a[1] == b[1])
        less = (a[0] < b[0]) | (a[0] == b[0]) & ((a[1] < b[1]) | less)
        best = np.where(less[:, None], turned, best)
    return best


def _colours(F: Ints, n: int) -> Ints:
    """Return a hash of the neighbourhood of each vertex, whatever the order."""
    indptr, indices = adjacency(F, n)
    A = sparse.csr_array((np.ones(len(indices), dtype=np.uint64), indices, indptr), shape=(n, n))
    colour = np.bincount(F.ravel(), minlength=n).astype(np.uint64)
    for _ in range(ROUNDS):
        mixed = (colour ^ (colour >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
        mixed = (mixed ^ (mixed >> np.uint64(32))) * np.uint64(0x94D049BB133111EB)
        colour = np.uint64(3) * mixed + A @ (mixed ^ (mixed >> np.uint64(31)))
    return colour.view(np.int64)


def _opposite(F: Ints) -> Ints:
    """Return the opposite of each half-edge, (3 m,), -1 unless just these two are on the edge."""
    a, b = ends(F)
    h, g = edges_of_two(*by_edge(a, b))
    agree = a[h] == b[g]
    h, g = h[agree], g[agree]
    opposite = np.full(len(a), -1, dtype=np.int64)
    opposite[h], opposite[g] = g, h
    return opposite


def _match_faces(
    reference: TriangleMesh, other: TriangleMesh, colours: Ints, other_colours: Ints
) -> Ints | None:
    """Map every vertex that has a face, patch by patch; None when one does not fit anywhere."""
    n, m = len(reference.vertices), len(reference.faces)
    F = reference.faces.ravel()
    left = (F, _opposite(reference.faces), colours)
    right = (other.faces.ravel(), _opposite(other.faces), other_colours)
    mapping, inverse = np.full(n, -1), np.full(n, -1)
    half_edges, inverse_half_edges = np.full(m, -1), np.full(m, -1)
    state = (mapping, inverse, half_edges, inverse_half_edges, np.empty(n, int), np.empty(m, int))
    candidates = _Candidates(other, other_colours)
    for h in _seeds(F, colours):
        if half_edges[h // 3] >= 0:
            continue
        at = 3 * (h // 3) + (h + np.arange(3)) % 3
        if (start := int(mapping[F[h]])) >= 0:
            starts = np.array([start])
        else:
            starts = candidates.nearest(reference.vertices[F[h]], colours[F[h]], inverse < 0)
        found = candidates.half_edges(starts, reference.vertices[F[at]])
        if not any(kernels.propagate(*left, *right, h, g, *state) for g in found):
            return None
    return mapping


def _seeds(F: Ints, colours: Ints) -> Iterator[int]:
    """Yield a half-edge of every face, from the corner of rarest colour, the rarest faces first."""
    _, inverse, counts = np.unique(colours, return_inverse=True, return_counts=True)
    rarity = counts[inverse][F].reshape(-1, 3)
    order = np.argsort(rarity.min(axis=1), kind="stable")
    yield from (3 * order + np.argmin(rarity, axis=1)[order]).tolist()


class _Candidates:
    """The half-edges of a mesh, by position and colour of the vertices they start from."""

    def __init__(self, mesh: TriangleMesh, colours: Ints) -> None:
        self._vertices, self._corners, self._colours = mesh.vertices, mesh.faces.ravel(), colours
        self._by_vertex = np.argsort(self._corners, kind="stable")
        self._first = np.searchsorted(self._corners[self._by_vertex], np.arange(len(colours) + 1))
        self._by_colour = np.argsort(colours, kind="stable")
        self._sorted = colours[self._by_colour]
        self._tree: cKDTree | None = None

    def half_edges(self, starts: Ints, triangle: Floats) -> list[int]:
        """Return the half-edges from given vertices, those whose faces are nearest first.

        triangle : float64 (3, 3), where the corners of the face are, from the start on.
        """
        spans = [self._by_vertex[self._first[v] : self._first[v + 1]] for v in starts]
        h = np.concatenate(spans) if spans else np.empty(0, dtype=np.int64)
        at = 3 * (h // 3)[:, None] + (h[:, None] + np.arange(3)) % 3
        misfit = ((self._vertices[self._corners[at]] - triangle) ** 2).sum(axis=(1, 2))
        return h[np.argsort(misfit, kind="stable")].tolist()  # type: ignore[no-any-return]

    def nearest(self, point: Floats, colour: int, free: Bools) -> Ints:
        """Return up to `NEAREST` free vertices (k,) of a colour, the nearest first."""
        low = np.searchsorted(self._sorted, colour)
        same = self._by_colour[low : np.searchsorted(self._sorted, colour, side="right")]
        if len(same) > _SCAN:
            self._tree = self._tree or cKDTree(self._vertices)
            _, near = self._tree.query(point, min(8 * NEAREST, len(self._vertices)))
            near = near[(self._colours[near] == colour) & free[near]]
            same = near if len(near) else same
        same = same[free[same]]
        away = ((self._vertices[same] - point) ** 2).sum(axis=1)
        return same[np.argsort(away, kind="stable")[:NEAREST]]


def _match_isolated(V: Floats, W: Floats, mapping: Ints) -> None:
    """Complete the map (n,) in place by nearest positions; the closest of rivals wins."""
    taken = np.zeros(len(W), dtype=bool)
    taken[mapping[mapping >= 0]] = True
    left, right = np.flatnonzero(mapping < 0), np.flatnonzero(~taken)
    for _ in range(_ISOLATED_ROUNDS):
        if not len(left):
            return
        away, nearest = cKDTree(W[right]).query(V[left])
        order = np.argsort(away, kind="stable")
        _, winner = np.unique(nearest[order], return_index=True)
        winner = order[winner]
        mapping[left[winner]] = right[nearest[winner]]
        left, right = np.delete(left, winner), np.delete(right, nearest[winner])
    mapping[left] = right
