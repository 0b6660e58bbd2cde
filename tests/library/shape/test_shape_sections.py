"""Sections of a structure one by one: STCH and COPY come back, and are refused if forged."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import pytest
import strategies
from drafts import Stage, assert_same_structure, container_of, stages_of
from hypothesis import given
from polygon_meshes import soups

from deltamesh._limits import Counts
from deltamesh._shape.announced import announced
from deltamesh._shape.manifold import trivial
from deltamesh._shape.split_vertices import read_point_count, split_vertices
from deltamesh._shape.stitches import read_manifold_counts
from deltamesh._shape.structure import EMPTY
from deltamesh._shape.wedges import corners_of
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles

STITCHED = meshes.union(meshes.hourglass(), meshes.doubled(), meshes.with_degenerate())
SPLIT = meshes.seams()


def assert_sections_come_back(stages: dict[str, Stage]) -> None:
    container, structure = container_of(stages), EMPTY
    for stage in stages.values():
        structure = stage.section.decode(memoryview(stage.payload), container, structure)
        assert_same_structure(structure, stage.after.structure)


@given(strategies.complexes())
def test_sections_of_any_complex_come_back(mesh: meshes.Arrays) -> None:
    assert_sections_come_back(stages_of(from_triangles(*mesh)))


@given(soups())
def test_sections_of_any_polygons_come_back(mesh: PolyMesh) -> None:
    assert_sections_come_back(stages_of(mesh))


@pytest.mark.parametrize("drop_isolated", [False, True])
def test_what_a_file_announces_is_what_it_has(drop_isolated: bool) -> None:
    mesh = meshes.union(STITCHED, SPLIT, meshes.with_isolated())
    stages = stages_of(from_triangles(*mesh), drop_isolated=drop_isolated)
    assert list(stages) == ["CONN", "STCH", "COPY"]
    built = stages["COPY"].after.structure.complex
    manifold = built.manifold
    expected = Counts(built.point_count, built.isolated, manifold.vertex_count, len(manifold.faces))
    assert announced(container_of(stages)) == expected


def varints(*numbers: int) -> memoryview:
    return memoryview(b"".join(map(write_varint, numbers)))


def test_counts_of_a_manifold_that_cannot_be_are_refused() -> None:
    assert read_manifold_counts(varints(9, 4), 9, 4) == (9, 4)
    for n, m in ((8, 4), (9, 5), (13, 4)):
        with pytest.raises(FormatError, match="manifold contradict"):
            read_manifold_counts(varints(n, m), 9, 4)


def test_counts_of_points_that_cannot_be_are_refused() -> None:
    assert read_point_count(varints(7, 3), 10, 2) == 7
    for count, further in ((10, 0), (1, 0), (7, 4)):
        with pytest.raises(FormatError, match="points contradict"):
            read_point_count(varints(count, further), 10, 2)


@pytest.mark.parametrize(("name", "mesh"), [("STCH", STITCHED), ("COPY", SPLIT)])
def test_other_counts_and_bytes_are_refused_with_an_offset_in_the_payload(
    name: str, mesh: meshes.Arrays
) -> None:
    stages = stages_of(from_triangles(*mesh))
    stage, container = stages[name], container_of(stages)
    payload = stage.payload
    changed = [payload + b"\1", payload[: len(payload) // 2], bytes([payload[0] ^ 1]) + payload[1:]]
    refusals = 0
    for data in changed:
        offset = None
        try:
            stage.section.decode(memoryview(data), container, stage.before.structure)
        except FormatError as error:
            offset = error.offset
        refusals += offset is not None
        assert offset is None or 0 <= offset <= len(data)
    assert refusals >= 2


def test_sections_apply_where_they_say_something() -> None:
    assert list(stages_of(from_triangles(*meshes.torus(5, 4)))) == ["CONN"]
    assert list(stages_of(from_triangles(*STITCHED))) == ["CONN", "STCH"]
    assert list(stages_of(from_triangles(*SPLIT))) == ["CONN", "COPY"]


def test_vertices_at_points_by_hand() -> None:
    """Point 0 is two vertices of faces, point 2 has one more beside, point 3 is isolated, twice."""
    F = np.array([[0, 1, 2], [2, 1, 3]])
    stitches = replace(trivial(4, 2), points=np.array([0, 1, 2, 0]))
    corners = corners_of(F, np.array([-1, 3, -1, 1, -1, -1]), stitches, 4)
    by_point = np.argsort(corners.points[corners.rank], kind="stable")
    wedges = np.empty(6, dtype=np.int64)
    wedges[by_point] = [0, 1, 2, 2, 3, 3]
    found = split_vertices(corners, wedges, np.array([0, 0, 1, 1]))
    assert found.points.tolist() == [0, 0, 1, 2, 2, 3, 3]
    assert found.faces.tolist() == [[0, 2, 3], [3, 2, 1]]
