"""Round trips of meshes at the ends of what there is: tiny, huge, flat, split, isolated."""

from __future__ import annotations

import meshes
import numpy as np
import pytest
from round_trips import assert_round_trip

from deltamesh._codec.decoding import decode
from deltamesh._codec.encoding import encode
from deltamesh_formats.container.reader import read_container

# ---- Meshes at the ends ------------------------------------------------------------------------

METHODS = ["highpass", "cartesian"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "F",
    [[[0, 1, 2]], [[0, 1, 2], [2, 1, 3]], [[0, 1, 2], [0, 2, 1]], [[0, 1, 2], [3, 4, 5]]],
    ids=["triangle", "two triangles", "both sides of a triangle", "two components"],
)
def test_tiny_meshes(F: list[list[int]], method: str) -> None:
    n = np.max(F) + 1
    V = np.random.default_rng(60).normal(size=(n, 3))
    assert_round_trip(V, np.array(F), method=method)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("scale", [1e-300, 1e-100, 1e-20, 1e-3, 1e20, 1e100, 1e149])
@pytest.mark.parametrize("options", [{"bits": 10}, {"bits": 12}], ids=str)
def test_scale_changes_nothing(scale: float, method: str, options: dict) -> None:
    """By a power of two it scales the output; by any number, nearly."""
    V, F = meshes.torus(8, 7)
    plain = assert_round_trip(V, F, method=method, **options)
    power = 2.0 ** round(np.log2(scale))
    scaled = assert_round_trip(V * power, F, method=method, **options)
    np.testing.assert_allclose(scaled.mesh.vertices / power, plain.mesh.vertices, atol=1e-9)
    assert_round_trip(V * scale, F, method=method, **options)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("offset", [4e6, -1e9])
def test_offsets_do_not_matter(offset: float, method: str) -> None:
    """A mesh in the coordinates of a map, extent 6: digits below 1e-9 and 1e-7 are not there."""
    V, F = meshes.torus(8, 7)
    far = V + np.array([offset, -offset, offset / 3])
    plain, moved = (assert_round_trip(W, F, method=method, bits=12) for W in (V, far))
    np.testing.assert_array_equal(moved.order, plain.order)
    errors, others = (
        np.abs(e.mesh.vertices - W[e.order]).max() for e, W in ((plain, V), (moved, far))
    )
    assert others < 1.5 * errors + 1e-6


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("axes", [(0,), (1,), (2,), (0, 2), (1, 2)])
def test_no_extent_along_an_axis(axes: tuple[int, ...], method: str) -> None:
    rng = np.random.default_rng(3)
    _, F = meshes.icosphere(1)
    V = rng.permutation(42)[:, None] + np.zeros((42, 3))
    V[:, 1] = rng.permutation(V[:, 1])
    V[:, list(axes)] = 7.25
    encoded = assert_round_trip(V, F, method=method)
    np.testing.assert_allclose(encoded.mesh.vertices[:, list(axes)], 7.25, atol=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_neighbouring_numbers_are_two_positions(method: str) -> None:
    V, F = meshes.icosphere(1)
    V = V + 10.0
    a, b = F[0, :2]
    V[b] = V[a]
    V[b, 2] = np.nextafter(V[a, 2], np.inf)
    encoded = assert_round_trip(V, F, method=method)
    assert len(encoded.mesh.vertices) == len(V)


@pytest.mark.parametrize("method", METHODS)
def test_one_vertex_far_away(method: str) -> None:
    V, F = meshes.icosphere(1)
    V[5] = [1e9, -1e9, 1e9]
    assert_round_trip(V, F, method=method, bits=20)


@pytest.mark.parametrize("valence", [99, 200, 2000])
def test_a_vertex_of_high_valence(valence: int) -> None:
    """Its row would fill the normal equations: the solver takes another road."""
    turn = np.linspace(0, 2 * np.pi, valence, endpoint=False)
    V = np.stack((np.cos(turn), np.sin(turn), 0.2 * np.sin(5 * turn)), axis=1)
    i = np.arange(valence)
    F = np.stack((i, (i + 1) % valence, np.full(valence, valence)), axis=1)
    assert_round_trip(np.concatenate((V, [[0.1, 0, 0.3]])), F)


# ---- Vertices: at one position, isolated -------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_a_soup_of_triangles_costs_no_more_than_its_surface(method: str) -> None:
    V, F = meshes.icosphere(1)
    soup = V[F].reshape(-1, 3)
    soup[soup == 0] *= np.random.default_rng(1).choice([-1.0, 1.0], (soup == 0).sum())  # -0.0
    encoded = assert_round_trip(soup, np.arange(len(soup)).reshape(-1, 3), method=method)
    assert len(np.unique(decode(encoded.data).vertices, axis=0)) == len(V)
    assert len(encoded.data) < len(encode(V, F, method=method)) + 40


@pytest.mark.parametrize("method", METHODS)
def test_isolated_vertices_come_last(method: str) -> None:
    V, F = meshes.with_isolated()
    encoded = assert_round_trip(V, F, method=method)
    p = read_container(encoded.data).parameters
    assert p.isolated == 4
    last = encoded.order[-4:]
    assert not np.isin(last, F).any()
    step = p.anchor_step or p.step
    error = np.abs(encoded.mesh.vertices[-4:] - V[last])
    assert error.max() <= step / 2 * (1 + 1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_isolated_vertices_are_left_out_on_demand(method: str) -> None:
    V, F = meshes.with_isolated()
    encoded = assert_round_trip(V, F, method=method, drop_isolated=True)
    assert read_container(encoded.data).parameters.isolated == 0
    used = np.unique(F)
    number = np.searchsorted(used, F)
    assert encoded.data == encode(V[used], number, method=method)


@pytest.mark.parametrize("method", METHODS)
def test_isolated_vertices_that_are_elsewhere_too(method: str) -> None:
    """At a position of the surface, or twice at the same: as many come back, at one position."""
    V, F = meshes.icosphere(0)
    more = np.concatenate((V, V[3:5], [[2.0, 3, 4]] * 3, [[2.0, 3, 5]]))
    encoded = assert_round_trip(more, F, method=method)
    found = decode(encoded.data).vertices[np.argsort(encoded.order)]
    assert (found[12:14] == found[3:5]).all()
    assert (found[14:16] == found[16]).all()
    assert read_container(encoded.data).parameters.isolated == 2


@pytest.mark.parametrize("method", METHODS)
def test_far_more_isolated_vertices_than_others(method: str) -> None:
    V, F = meshes.tetrahedron()
    cloud = np.random.default_rng(8).normal(size=(3000, 3)) * [100, 1, 0.01]
    encoded = assert_round_trip(np.concatenate((cloud, V)), F + 3000, method=method)
    assert read_container(encoded.data).parameters.isolated == 3000
