"""Functions of the research module: Laplacians, anchors, quantization, spectra."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest
import scipy.sparse as sparse

import deltamesh
from deltamesh.differential import (
    LeastSquares,
    VertexErrors,
    basis_functions,
    coded_size,
    components,
    deltas,
    diagonal,
    eigenvectors,
    energies,
    farthest_anchors,
    greedy_anchors,
    laplacian,
    quantized_deltas,
    quantized_positions,
    random_anchors,
    spectral_slope,
    step_of,
    vertex_errors,
)


def test_the_laplacian_is_that_of_the_edges() -> None:
    quads = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
    L = laplacian(quads, 7)
    assert sorted(zip(*sparse.triu(L, 1).nonzero(), strict=True)) == [
        *[(0, 1), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (4, 5)]
    ]
    assert L.diagonal().tolist() == [2, 3, 2, 2, 3, 2, 0]
    assert components(L).tolist() == [0] * 6 + [1]
    mixed = laplacian([[0, 1, 4, 3], [1, 2, 5], [1, 5, 4]], 7)
    assert abs(mixed - laplacian([[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]], 7)).sum() == 4
    assert laplacian([], 2).nnz == 0
    V, F = meshes.icosphere(1)
    np.testing.assert_array_equal(
        laplacian(F.tolist(), len(V)).toarray(), oracle.laplacian(F, len(V))
    )


def test_deltas_are_products() -> None:
    V, F = meshes.torus(9, 7)
    L = laplacian(F, len(V))
    np.testing.assert_allclose(deltas(L, V), L @ V, atol=1e-14)
    np.testing.assert_allclose(
        deltas(L, V)[5] / L.diagonal()[5], V[5] - V[L[[5]].indices[L[[5]].data < 0]].mean(axis=0)
    )


@pytest.mark.parametrize("fault", ["dense", "shape", "weight", "sum", "one-sided"])
def test_other_matrices_are_refused(fault: str) -> None:
    V, F = meshes.tetrahedron()
    L = laplacian(F, 4)
    other = {
        "dense": L.toarray(),
        "shape": L[:3],
        "weight": 2 * L,
        "sum": L + sparse.eye_array(4),
        "one-sided": sparse.csr_array([[1.0, -1.0], [0.0, 0.0]]),
    }[fault]
    with pytest.raises(ValueError, match=r"^L is "):
        deltas(other, V)


def test_faces_are_checked() -> None:
    for faces in ([[0, 1, 3]], np.array([[0, -1, 2]])):
        with pytest.raises(ValueError, match="outside of 0 to 2"):
            laplacian(faces, 3)
    with pytest.raises(ValueError, match="face 1 has no three corners"):
        laplacian([[0, 1, 2], [0, 1]], 3)
    with pytest.raises(ValueError, match="face 0 has no three corners"):
        laplacian([0, 1], 3)


def test_anchors_are_those_of_the_codec() -> None:
    V, F = meshes.torus(40, 30)
    V += np.random.default_rng(3).normal(size=V.shape) / 50  # no two errors are equal
    mesh = deltamesh.decode(deltamesh.encode(V, F, method="lossless"))
    V, L = mesh.vertices, laplacian(mesh.triangles, len(V))
    for method, found in (
        ("random", random_anchors(L, 9, 5)),
        ("farthest", farthest_anchors(L, 9)),
        ("greedy", greedy_anchors(L, V, 9)),
    ):
        assert len(np.unique(found)) == 9
        options = {
            "method": "highpass",
            "bits": 0,
            "anchors": 9,
            "anchor_method": method,
            "seed": 5,
        }
        coded = deltamesh.decode(deltamesh.encode(mesh, **options))
        B = basis_functions(LeastSquares(L, found))  # wherever the file has its anchors
        c = np.linalg.lstsq(B, coded.vertices, rcond=None)[0]
        np.testing.assert_allclose(B @ c, coded.vertices, atol=1e-9)


def test_greedy_anchors_know_the_deltas() -> None:
    V, F = meshes.torus(40, 30)
    L = laplacian(F, len(V))
    delta = deltas(L, V)
    delta[700] += 1.0
    assert greedy_anchors(L, V, 2, delta)[1] == 700
    with pytest.raises(ValueError, match="vertices have shape"):
        greedy_anchors(L, V[:5], 2)


def test_deltas_are_quantized_as_in_a_file() -> None:
    V, F = meshes.torus(40, 30)
    options = {"method": "highpass", "bits": 6, "anchors": 5}
    for diffusion in (0.0, 1.0):
        data = deltamesh.encode(V, F, **options, diffusion=bool(diffusion))
        mesh = deltamesh.decode(deltamesh.encode(V, F, method="lossless"))
        L = laplacian(mesh.triangles, len(V))
        delta = deltas(L, mesh.vertices)
        step = step_of(delta, 6)
        values = quantized_deltas(L, delta, step, diffusion)
        info = deltamesh.info(data)
        assert info.parameters.step == step
        assert coded_size(L, values) in range(
            info.sections["DELT"].size - 16, info.sections["DELT"].size
        )
        if not diffusion:
            np.testing.assert_array_equal(values, np.rint(delta / step))
        else:
            assert np.abs((values * step - delta).sum(axis=0)).max() < step


def test_each_vertex_may_have_a_step() -> None:
    V, F = meshes.icosphere(2)
    L = laplacian(F, len(V))
    delta, steps = deltas(L, V), np.linspace(0.01, 0.1, len(V))
    values = quantized_deltas(L, delta, steps, 0.0)
    np.testing.assert_array_equal(values, np.rint(delta / steps[:, None]))
    for wrong in (0.0, [1.0, 2.0]):
        with pytest.raises(ValueError, match="steps are no positive number"):
            quantized_deltas(L, delta, wrong)
    with pytest.raises(deltamesh.MeshError, match="too small"):
        quantized_deltas(L, delta, 1e-300)
    with pytest.raises(ValueError, match="values have shape"):
        coded_size(L, values[:3])


def test_positions_are_quantized_as_in_a_file() -> None:
    mesh = deltamesh.decode(deltamesh.encode(*meshes.icosphere(2), method="lossless"))
    coded = deltamesh.decode(deltamesh.encode(mesh, method="cartesian", bits=9))
    np.testing.assert_array_equal(coded.vertices, quantized_positions(mesh.vertices, 9))
    assert quantized_positions(np.zeros((0, 3)), 9).shape == (0, 3)


def test_eigenvectors_are_those_of_the_matrix() -> None:
    V, F = meshes.torus(19, 11)
    L = laplacian(F, len(V))
    values, U = eigenvectors(L)
    np.testing.assert_allclose(U.T @ U, np.eye(len(V)), atol=1e-10)
    np.testing.assert_allclose(L @ U, U * values, atol=1e-10)
    some, few = eigenvectors(L, 12)
    np.testing.assert_allclose(some, values[:12], atol=1e-7)
    np.testing.assert_allclose(L @ few, few * some, atol=1e-7)
    again = eigenvectors(L, 12)
    np.testing.assert_array_equal(few, again[1])
    with pytest.raises(ValueError, match=r"k must lie in 1\.\.209, not 0"):
        eigenvectors(L, 0)


def test_energies_sum_to_that_of_the_rows() -> None:
    V, F = meshes.icosphere(1)
    values, U = eigenvectors(laplacian(F, len(V)))
    x = np.random.default_rng(0).normal(size=V.shape)
    energy = energies(U, x)
    assert energy.sum() == pytest.approx((x * x).sum())
    filtered = U @ (U.T @ x / np.maximum(values, 1e-9)[:, None])
    ratio = energies(U, filtered)[1:] / energy[1:]
    np.testing.assert_allclose(ratio, values[1:] ** -2.0, rtol=1e-4)


def test_the_slope_of_a_power_is_its_exponent() -> None:
    values = np.concatenate(([0.0], np.geomspace(0.01, 10, 400)))
    energy = np.concatenate(([9.0], values[1:] ** -1.5))
    assert spectral_slope(values, energy) == pytest.approx(-1.5)
    noise = np.random.default_rng(7).normal(size=(401, 3))
    filtered = ((noise * np.sqrt(energy)[:, None]) ** 2).sum(axis=1)
    assert spectral_slope(values, filtered) == pytest.approx(-1.5, abs=0.1)


def test_the_metrics_are_those_of_the_codec() -> None:
    V, F = meshes.icosphere(1)
    errors = vertex_errors(V, 2 * V, F)
    assert isinstance(errors, VertexErrors)
    assert errors.rms == pytest.approx(1)
    assert errors.normal_deviation == pytest.approx(0, abs=1e-6)
    assert diagonal(V) == pytest.approx(np.linalg.norm(np.ptp(V, axis=0)))


def test_errors_are_those_of_arrays_of_any_layout() -> None:
    V, F = meshes.torus(9, 7)
    errors = vertex_errors(V, 2 * V, F)
    assert vertex_errors(V.tolist(), np.asfortranarray(2 * V), F.astype(np.int32)) == errors
    with pytest.raises(ValueError, match="outside of 0 to 62"):
        vertex_errors(V, V, F + 1)
    with pytest.raises(ValueError, match="faces are not integers, but float64"):
        vertex_errors(V, V, F + 0.5)


def test_numbers_that_are_no_vertices_are_refused() -> None:
    V, F = meshes.torus(9, 7)
    L = laplacian(F, len(V))
    for faces in (F + 0.5, (F + 0.5).tolist(), F * np.nan):
        with pytest.raises(ValueError, match="faces are not integers, but float64"):
            laplacian(faces, len(V))
    with pytest.raises(ValueError, match="anchors are not integers, but float64"):
        LeastSquares(L, [2.5])
    with pytest.raises(ValueError, match="vertices are not real numbers"):
        deltas(L, V + 1j)
