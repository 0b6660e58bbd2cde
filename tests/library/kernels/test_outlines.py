"""Half-edges of a triangle, and outlines of merged triangles, against their twins."""

from __future__ import annotations

import numpy as np
import polygon_oracle
import pytest
from drafts import merged_of
from hypothesis import given
from polygon_meshes import soups

from deltamesh._kernels.mesh.halfedges import next_halfedge, previous_halfedge
from deltamesh._kernels.mesh.outlines import walk
from deltamesh_formats.polymesh.mesh import PolyMesh


def test_halfedges_of_a_triangle_follow_each_other() -> None:
    for h in range(12):
        assert next_halfedge(h) == polygon_oracle.after(h)
        assert previous_halfedge(h) == polygon_oracle.before(h)
        assert previous_halfedge(next_halfedge(h)) == h


@given(soups())
def test_outlines_are_those_of_the_oracle(mesh: PolyMesh) -> None:
    _, merged = merged_of(mesh)
    expected = polygon_oracle.outlines(merged.tolist())
    corners = np.empty(sum(map(len, expected)), dtype=np.int64)
    offsets, of_corners = np.zeros(len(expected) + 1, dtype=np.int64), np.empty_like(merged)
    walk(merged, corners, offsets, of_corners)
    assert corners.tolist() == [outside for polygon in expected for outside, _ in polygon]
    assert np.diff(offsets).tolist() == list(map(len, expected))
    assert (of_corners[corners] == np.arange(len(corners))).all()


def test_triangles_in_a_ring_have_no_outline() -> None:
    # Three around a vertex, each merged with the next: half-edge 3 f + 2 leads back to that vertex.
    merged = np.array([5, -1, 6, 8, -1, 0, 2, -1, 3])
    corners, offsets, of_corners = (np.empty(count, dtype=np.int64) for count in (3, 2, 9))
    with pytest.raises(ValueError, match="dm_walk_outlines"):
        walk(merged, corners, offsets, of_corners)


def test_outlines_have_at_least_a_beginning() -> None:
    none = np.zeros(0, dtype=np.int64)
    with pytest.raises(ValueError, match="dm_walk_outlines"):
        walk(none, none, none, none)
