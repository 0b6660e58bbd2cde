"""Positions in float32: where the source had them, and what rounding loses."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import pytest

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.float32 import (
    bounding_diagonal,
    rounded_positions,
    source_positions,
)
from deltamesh_formats.polymesh.mesh import from_triangles

V, F = meshes.icosphere(1)


def test_positions_are_in_the_precision_of_the_source() -> None:
    mesh = from_triangles(V, F)
    assert source_positions(mesh) is mesh.vertices
    single = replace(mesh, precision="float32")
    assert source_positions(single).dtype == np.float32
    far = replace(single, vertices=np.where(V.max() == V, 1e39, V))
    assert source_positions(far).dtype == np.float64


def test_rounding_is_a_loss_if_it_is_large_for_the_mesh() -> None:
    positions, lost = rounded_positions(V, bounding_diagonal(V), "STL")
    assert positions.dtype == np.float32
    assert lost == []
    far = V + 1e6
    _, lost = rounded_positions(far, bounding_diagonal(far), "STL")
    assert len(lost) == 1
    assert lost[0].startswith("positions beyond float32 (by up to 0.0")


def test_coordinates_beyond_float32_are_refused_by_name() -> None:
    with pytest.raises(MeshError, match=r"STL holds float32, and a coordinate of \[1e\+39"):
        rounded_positions(np.array([[0.0, 0, 0], [1e39, 0, 0]]), 1e39, "STL")


def test_the_diagonal_is_that_of_the_box() -> None:
    assert bounding_diagonal(np.array([[0.0, 0, 0], [3, 0, 1], [1, 4, 0]])) == pytest.approx(
        26**0.5
    )
    assert bounding_diagonal(np.array([[-1e308, 0, 0], [1e308, 0, 0]])) == np.inf
