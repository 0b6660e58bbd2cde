"""Structure of an input in coding order, once its manifold has been coded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from deltamesh._shape.complexes import Cut
from deltamesh._shape.draft import ShapeDraft
from deltamesh._shape.manifold import REVERSED, CodedManifold, Stitches, trivial
from deltamesh._shape.provenance import TriangleProvenance
from deltamesh._shape.structure import Complex, structure_of
from deltamesh_formats.array_types import Ints, Shorts
from deltamesh_formats.polymesh.permutations import distinct, inverse


def in_coding_order(draft: ShapeDraft, cut: Cut, coded: CodedManifold) -> ShapeDraft:
    """Return the draft with a coded manifold in place of its cut, stitches and provenance.

    Points are numbered as the vertices of the manifold meet them; the points that it does not have
    come last, in the lexicographic order of their positions.
    """
    source = draft.input
    stitched, met = _first_appearances(cut.points[coded.order], len(source.first_vertices))
    rank = np.full(len(source.first_vertices), -1, dtype=np.int64)
    rank[met] = np.arange(len(met))
    isolated = distinct(source.points[source.kept])
    isolated = isolated[rank[isolated] < 0]
    isolated = isolated[np.lexsort(source.vertices[source.first_vertices[isolated]].T[::-1])]
    rank[isolated] = np.arange(len(met), len(met) + len(isolated))

    faces = source.points[source.triangles.faces]
    stitches, corners = _stitches(faces, cut, coded, stitched, rank)
    manifold = coded.manifold
    unstitched = trivial(manifold.vertex_count, len(manifold.faces))
    built = Complex(manifold, unstitched, len(met), len(isolated))
    backwards = np.flatnonzero(source.kept)[::-1]
    vertices = np.empty(built.point_count, dtype=np.int64)
    vertices[rank[source.points[backwards]]] = backwards  # the first at a point is assigned last
    provenance = TriangleProvenance(vertices, vertices, corners)
    return replace(
        draft,
        cut=None,
        structure=structure_of(built),
        stitches=stitches,
        triangle_provenance=provenance,
    )


def _first_appearances(points: Ints, n: int) -> tuple[Ints, Ints]:
    """Return points renumbered in the order of their first appearance, and the points so."""
    at = np.arange(len(points))
    first = np.empty(n, dtype=np.int64)
    first[points[::-1]] = at[::-1]  # the last one assigned stays: the first there is
    is_first = first[points] == at
    return (np.cumsum(is_first) - 1)[first[points]], points[is_first]


def _stitches(
    faces: Ints, cut: Cut, coded: CodedManifold, points: Ints, rank: Ints
) -> tuple[Stitches, Shorts]:
    """Return the stitches, and the input corner of each corner of the complex.

    faces : int64 (m, 3), of the input, over points; points : int64 (n,), in coding order, of the
    vertices of the manifold; rank : the coding order of the points of the input.
    """
    face, rotation = np.divmod(coded.starts, 3)
    reversed_ = cut.reversed[face]
    # A face begins with that corner of the face of the cut; either may have its winding reversed.
    at = (rotation[:, None] + np.where(reversed_[:, None], REVERSED, np.arange(3))) % 3
    at = np.where(reversed_[:, None], REVERSED[at], at)
    corners = 3 * cut.triangles[face][:, None] + at

    repeated = inverse(face)[cut.repeated]
    order = np.lexsort((cut.against, repeated))
    repeats, repeated = cut.repeats[order], repeated[order]
    first = faces.ravel()[corners[repeated, 0]]
    rotation = np.argmax(faces[repeats] == first[:, None], axis=1)
    again = 3 * repeats[:, None] + (rotation[:, None] + np.arange(3)) % 3

    degenerate = faces[cut.degenerate]
    # Begin with the first of two equal corners.
    rotation = np.argmax(np.roll(degenerate, -1, axis=1) == degenerate, axis=1)
    flat = 3 * cut.degenerate[:, None] + (rotation[:, None] + np.arange(3)) % 3
    pairs = rank[faces.ravel()[flat[:, [0, 2]]]]
    order_of_pairs = np.lexsort((pairs[:, 1], pairs[:, 0]))
    stitches = Stitches(points, reversed_, repeated, cut.against[order], pairs[order_of_pairs])
    rows = [corners, again, flat[order_of_pairs]]
    return stitches, np.concatenate(rows, dtype=np.int32, casting="same_kind")
