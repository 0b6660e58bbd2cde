"""Structures in coding order, and the elements of the input that theirs come from."""

from __future__ import annotations

import meshes
import numpy as np
import strategies
from drafts import stages_of
from hypothesis import given
from hypothesis import strategies as st
from polygon_meshes import canonical, mesh_of, soups

from deltamesh._shape.coding_order import in_coding_order
from deltamesh._shape.connectivity import encode_connectivity
from deltamesh._shape.draft import first_draft
from deltamesh._shape.provenance import TriangleProvenance, provenance_of
from deltamesh._shape.topology import build_topology
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles


@given(strategies.complexes(), st.booleans())
def test_points_are_numbered_as_they_are_met(mesh: meshes.Arrays, drop_isolated: bool) -> None:
    V, F = mesh
    triangles = from_triangles(V, F).triangulation()
    draft = first_draft(V, triangles, drop_isolated=drop_isolated, exact=False)
    cut = draft.cut
    assert cut is not None
    _, coded = encode_connectivity(build_topology(cut.faces, cut.opposite, len(cut.points)))
    found = in_coding_order(draft, cut, coded)
    assert found.cut is None
    points = found.stitches.points
    first_seen = list(dict.fromkeys(points.tolist()))
    assert first_seen == list(range(len(first_seen)))
    built, at = found.structure.complex, found.triangle_provenance.points
    assert built.used == len(first_seen)
    assert len(at) == built.point_count
    # Isolated points in the order of their positions, each with its first vertex.
    isolated = V[at[built.used :]] + 0.0
    assert isolated.tolist() == sorted(isolated.tolist())
    if drop_isolated:  # left are those of degenerate faces alone
        degenerate = np.unique(found.stitches.degenerate)
        assert degenerate[degenerate >= built.used].tolist() == list(
            range(built.used, built.point_count)
        )
    kept = found.points[found.points >= 0]
    assert set(kept.tolist()) == set(range(built.point_count))


@given(soups())
def test_polygons_are_those_of_their_provenance(mesh: PolyMesh) -> None:
    draft = list(stages_of(mesh).values())[-1].after
    s, p = draft.structure, draft.provenance
    vertices = s.faces.ravel()[s.polygons.corners]
    np.testing.assert_array_equal(p.vertices[vertices], mesh.corners[p.corners])
    owner = np.repeat(np.arange(len(mesh.sizes)), mesh.sizes)
    np.testing.assert_array_equal(
        owner[p.corners], np.repeat(p.polygons, np.diff(s.polygons.offsets))
    )
    assert sorted(p.polygons.tolist()) == list(range(len(mesh.sizes)))
    coded = PolyMesh(mesh.vertices[p.vertices], vertices, s.polygons.offsets)
    assert canonical(coded, p.vertices.tolist()) == canonical(mesh)


def test_provenance_by_hand() -> None:
    """Two triangles of the input, taken in turn, each from another corner on."""
    mesh = mesh_of(np.eye(4, 3), [[0, 1, 2], [2, 1, 3]])
    draft = list(stages_of(mesh).values())[-1].after
    polygons, none = draft.structure.polygons, np.arange(4)
    rows = TriangleProvenance(none, none, np.array([[4, 5, 3], [2, 0, 1]]))
    found = provenance_of(polygons, rows, mesh.triangulation())
    assert found.corners.tolist() == [4, 5, 3, 2, 0, 1]
    assert found.polygons.tolist() == [1, 0]


def test_vertices_without_a_face_are_left_out_on_demand() -> None:
    V, F = meshes.with_isolated()
    triangles = from_triangles(V, F).triangulation()
    for drop, count in ((False, len(V)), (True, len(V) - 4)):
        source = first_draft(V, triangles, drop_isolated=drop, exact=False).input
        assert source.kept.sum() == count
        assert source.in_face.sum() == len(V) - 4


def test_positions_are_exact_on_demand() -> None:
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [-0.0, 0, 0]])
    triangles = from_triangles(V, np.array([[0, 1, 2], [3, 2, 1]])).triangulation()
    welded = first_draft(V, triangles, drop_isolated=False, exact=False).input
    exact = first_draft(V, triangles, drop_isolated=False, exact=True).input
    assert welded.points.tolist() == [0, 1, 2, 0]
    assert exact.points.tolist() == [0, 1, 2, 3]
