"""Positions in float32: where they lose no more than their margin, and what rounding loses."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import pytest

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.float32 import (
    bounding_diagonal,
    rounding_error,
    rounding_losses,
    single_positions,
    stored_positions,
)
from deltamesh_formats.polymesh.mesh import from_triangles

V, F = meshes.icosphere(1)


def test_positions_are_in_the_precision_of_the_source_where_it_holds_them() -> None:
    mesh = from_triangles(V, F)
    assert stored_positions(mesh) is mesh.vertices
    single = replace(mesh, precision="float32")
    assert stored_positions(single) is mesh.vertices
    exact = replace(single, vertices=V.astype(np.float32).astype(np.float64))
    assert stored_positions(exact).dtype == np.float32
    far = replace(exact, vertices=np.where(V.max() == V, 1e39, exact.vertices))
    assert stored_positions(far).dtype == np.float64


def test_positions_may_be_rounded_by_their_margin() -> None:
    single = replace(from_triangles(V, F), precision="float32")
    error = rounding_error(V.astype(np.float32), V)
    assert 0 < error < 1e-7
    assert stored_positions(replace(single, margin=error)).dtype == np.float32
    assert stored_positions(replace(single, margin=np.nextafter(error, 0))).dtype == np.float64
    assert stored_positions(replace(single, precision="float64", margin=1.0)).dtype == np.float64


def test_rounding_is_a_loss_beyond_the_margin() -> None:
    assert rounding_losses("positions", 0.0, 0.0) == []
    assert rounding_losses("positions", 0.25, 0.25) == []
    said = ["positions beyond float32 (by up to 0.25)"]
    assert rounding_losses("positions", 0.25, 0.24) == said
    assert rounding_losses("positions", 0.25, 0.0, largest=1e6) == said
    assert rounding_losses("positions", 1e-10, 0.0, largest=1e6) == []
    assert rounding_losses("uv", float("inf"), 0.1) == ["uv beyond float32 (by up to inf)"]


def test_numbers_that_are_none_are_not_lost() -> None:
    values = np.array([np.nan, np.inf, -np.inf, 0.5])
    assert rounding_error(values.astype(np.float32), values) == 0
    with np.errstate(over="ignore"):
        assert rounding_error(np.array([1e39]).astype(np.float32), np.array([1e39])) == np.inf


def test_coordinates_beyond_float32_are_refused_by_name() -> None:
    assert single_positions(V, "STL").dtype == np.float32
    with pytest.raises(MeshError, match=r"STL holds float32, and a coordinate of \[1e\+39"):
        single_positions(np.array([[0.0, 0, 0], [1e39, 0, 0]]), "STL")


def test_the_diagonal_is_that_of_the_box() -> None:
    assert bounding_diagonal(np.array([[0.0, 0, 0], [3, 0, 1], [1, 4, 0]])) == pytest.approx(
        26**0.5
    )
    assert bounding_diagonal(np.array([[-1e308, 0, 0], [1e308, 0, 0]])) == np.inf
