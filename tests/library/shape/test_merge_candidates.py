"""Half-edges that may be merged, those that are, and those that a surface hides."""

from __future__ import annotations

import numpy as np
import polygon_oracle
from drafts import stages_of
from hypothesis import given
from polygon_meshes import mesh_of, soups

from deltamesh._shape.merge_candidates import hidden_halfedges, merge_candidates, merged_halfedges
from deltamesh_formats.polymesh.mesh import PolyMesh


@given(soups())
def test_candidates_are_those_of_the_oracle(mesh: PolyMesh) -> None:
    s = list(stages_of(mesh).values())[-1].after.structure
    manifold, reversed_ = s.complex.manifold, s.complex.stitches.reversed
    found = merge_candidates(s.faces, manifold.opposite, reversed_)
    assert found.tolist() == polygon_oracle.candidates(
        s.faces.tolist(), len(manifold.faces), manifold.opposite.tolist(), reversed_.tolist()
    )
    paired = np.flatnonzero(found >= 0)
    assert (found[found[paired]] == paired).all()


@given(soups())
def test_hidden_edges_lie_within_polygons(mesh: PolyMesh) -> None:
    s = list(stages_of(mesh).values())[-1].after.structure
    if not len(s.merged):
        return
    manifold, reversed_ = s.complex.manifold, s.complex.stitches.reversed
    hidden = hidden_halfedges(s.merged, manifold.opposite, reversed_)
    inner = np.flatnonzero(hidden)
    assert hidden[manifold.opposite[inner]].all()
    polygon = np.searchsorted(s.polygons.offsets, s.polygons.of_corners[::3], side="right")
    assert (polygon[inner // 3] == polygon[manifold.opposite[inner] // 3]).all()


def test_triangles_of_a_fan_are_merged_one_with_the_next() -> None:
    """A pentagon in three triangles, in the order of the input."""
    pentagon = mesh_of(np.random.default_rng(1).normal(size=(5, 3)) * [1, 1, 0], [[0, 1, 2, 3, 4]])
    triangles = pentagon.triangulation()
    merged = merged_halfedges(triangles, np.arange(9).reshape(3, 3))
    assert (merged >= 0).sum() == 4
    for h in np.flatnonzero(merged >= 0):
        g = merged[h]
        corners = triangles.faces.ravel()
        after = polygon_oracle.after
        assert corners[h] == corners[after(g)]
        assert corners[after(h)] == corners[g]
