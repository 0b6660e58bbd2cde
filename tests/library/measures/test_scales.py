"""Errors that a file records, of meshes of any scale and with vertices far away."""

from __future__ import annotations

from decimal import Decimal, localcontext

import meshes
import numpy as np
import pytest

from deltamesh import MeshError, TargetError, decode, encode, from_arrays, info
from deltamesh._measures import metrics
from deltamesh._options import Options
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh_formats.polymesh.mesh import PolyMesh

METHODS = ["auto", "refined", "highpass", "cartesian", "lossless"]
# At a rate, a method keeps what it can.
RATES = {"refined": {"bits": 14}, "highpass": {"bits": 12}, "cartesian": {"bits": 11}}


def true_distances(V: np.ndarray, W: np.ndarray) -> tuple[Decimal, Decimal]:
    """Root mean square and maximum of the distances, to 50 digits."""
    with localcontext(prec=50, Emax=10**6, Emin=-(10**6)):
        squares = [
            sum((Decimal(float(x)) - Decimal(float(y))) ** 2 for x, y in zip(v, w, strict=True))
            for v, w in zip(V, W, strict=True)
        ]
        return (sum(squares, Decimal()) / len(squares)).sqrt(), max(squares).sqrt()


def true_normal_deviation(V: np.ndarray, W: np.ndarray, F: np.ndarray) -> float:
    """As `VertexErrors.normal_deviation`, face by face, each with numbers of its own scale."""
    areas, angles = [], []
    exponent = -int(np.frexp(np.abs(V).max())[1])
    V, W = np.ldexp(V, exponent), np.ldexp(W, exponent)
    for face in F:
        normals, sizes = [], []
        for points in (V, W):
            sides = points[face[1]] - points[face[0]], points[face[2]] - points[face[0]]
            scales = [max(abs(side).max(), 1e-300) for side in sides]
            normal = np.cross(sides[0] / scales[0], sides[1] / scales[1])
            length = float(np.linalg.norm(normal))
            normals.append(normal / (length or 1))
            sizes.append(length * scales[0] * scales[1])
        lost = not normals[1].any()
        sine, cosine = np.linalg.norm(np.cross(*normals)), normals[0] @ normals[1]
        areas.append(sizes[0])
        angles.append(90.0 if lost else np.degrees(np.arctan2(sine, cosine)))
    return float(np.average(angles, weights=areas))


def with_outlier(at: tuple[float, float, float], scale: float = 1.0) -> PolyMesh:
    """A sphere, one vertex of which is somewhere else."""
    V, F = meshes.icosphere(2)
    V = V * scale
    V[17] = at
    return from_arrays(V, F)


OUTLIERS = {
    "1e30": with_outlier((1e30, 0, 0)),
    "-1e16": with_outlier((0, -1e16, 3)),
    "1e8": with_outlier((3, 4e8, 1e8)),
    "1e6": with_outlier((1e6, 0, 0)),
    "1e7": with_outlier((0, 1e7, 0)),
    "1e145": with_outlier((1e145, -1e145, 0)),
    "1 of 1e-30": with_outlier((0, 0, 1), 1e-30),
    "1e-200 of 1e-210": with_outlier((0, 0, 1e-200), 1e-210),
}


def assert_recorded(mesh: PolyMesh, method: str, **options: object) -> None:
    encoded = encode_mesh(mesh, Options(method=method, **options))
    meta = info(encoded.data).meta
    V, W, F = mesh.vertices[encoded.order], encoded.mesh.vertices, encoded.mesh.triangles
    rms, largest = true_distances(V, W)
    assert rms <= Decimal(meta.rms) <= rms * (1 + Decimal("1e-12"))
    assert largest <= Decimal(meta.max) <= largest * (1 + Decimal("1e-12"))
    errors = metrics.vertex_errors(V, W, F)
    assert meta.normal >= errors.normal_deviation * (1 - 1e-15)
    assert meta.dihedral >= errors.dihedral * (1 - 1e-15)
    truth = true_normal_deviation(V, W, F)
    assert truth * (1 - 1e-13) <= meta.normal <= truth * (1 + 1e-6) + 1e-6


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", OUTLIERS)
def test_recorded_errors_are_not_below_the_truth(name: str, method: str) -> None:
    assert_recorded(OUTLIERS[name], method, **RATES.get(method, {}))


@pytest.mark.parametrize("name", OUTLIERS)
def test_what_no_steps_can_keep_is_kept_exactly_unless_a_bound_is_given(name: str) -> None:
    mesh = OUTLIERS[name]
    if name in ("1e6", "1e7"):
        assert info(encode(mesh)).parameters.method != "lossless"
        return
    with pytest.raises(TargetError, match="normal deviation 1 cannot be met"):
        encode(mesh, quality=5)  # 2^30 steps are too few for the sphere beside it
    again = decode(encode(mesh, keep_order=True))
    np.testing.assert_array_equal(again.vertices, mesh.vertices)


@pytest.mark.parametrize("far", [1e14, 1e20, 1e30, 1e140])
def test_a_sphere_beside_one_isolated_vertex(far: float) -> None:
    """Its shape is kept, though it is lost in the rounding of a frame of both."""
    V, F = meshes.icosphere(2)
    V = np.concatenate([V, [[0, far, 0]]])
    for method in ("auto", "cartesian"):
        assert_recorded(from_arrays(V, F), method, **RATES.get(method, {}))
    data = encode(V, F, keep_order=True)
    np.testing.assert_array_equal(decode(data).vertices, V)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("mesh", [meshes.torus(9, 7), meshes.grid(5, 6), meshes.with_isolated()])
def test_ordinary_ones_are_not_either(mesh, method: str) -> None:
    assert_recorded(from_arrays(*mesh), method)


@pytest.mark.parametrize("name", OUTLIERS)
def test_recorded_maximum_is_that_of_the_decoded_mesh(name: str) -> None:
    data = encode(OUTLIERS[name], method="cartesian", bits=11, keep_order=True)
    rms, largest = true_distances(OUTLIERS[name].vertices, decode(data).vertices)
    assert rms <= Decimal(info(data).meta.rms)
    assert largest <= Decimal(info(data).meta.max) <= largest * (1 + Decimal("1e-12"))


@pytest.mark.parametrize("bound", [0.3, 0.1 + 0.2, 1 / 3])
def test_a_bound_is_not_below_what_is_recorded(bound: float) -> None:
    """Rounding up must not lead over a bound that the search has come near to."""
    data = encode(*meshes.torus(12, 9), method="cartesian", normal_error=bound, effort=3)
    assert 0.9 * bound < info(data).meta.normal <= bound


def test_angles_are_rounded_up_to_binary32() -> None:
    for angle in (0.1, 1 / 3, 1.0, 0.7, 179.99999999):
        errors = metrics.rounded_up(metrics.VertexErrors(angle, angle, angle, angle))
        for stored in (errors.normal_deviation, errors.dihedral):
            assert float(np.float32(stored)) == stored > angle
            assert stored < angle * (1 + 2**-22)
        assert angle < errors.rms == errors.max < angle * (1 + 1e-13)
    nothing = metrics.VertexErrors(0.0, 0.0, 0.0, 0.0)
    assert metrics.rounded_up(nothing) == nothing


# ---- Very large and very small meshes ----------------------------------------------------------

SCALES = [9.9e148, 1e120, 1e-120, 1e-200, 1e-300, 1e-310]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("scale", SCALES)
def test_any_scale(scale: float, method: str) -> None:
    V, F = meshes.icosphere(2)
    mesh = from_arrays(V * scale, F)
    data = encode(mesh, method=method, keep_order=True, **RATES.get(method, {}))
    again = decode(data)
    np.testing.assert_array_equal(again.triangles, F)
    away = np.abs(again.vertices - mesh.vertices).max()
    assert away <= {"lossless": 0, "cartesian": 1e-3}.get(method, 2e-2) * scale
    meta = info(data).meta
    assert away <= meta.max <= 0.02 * scale
    assert meta.normal < 2


@pytest.mark.parametrize("options", [{"quality": 7}, {"max_error_rel": 1e-3}, {"normal_error": 3}])
@pytest.mark.parametrize("scale", SCALES)
def test_bounds_at_any_scale(scale: float, options: dict[str, float]) -> None:
    V, F = meshes.torus(12, 9)
    mesh = from_arrays(V * scale / np.abs(V).max(), F)
    data = encode(mesh, keep_order=True, **options)
    away = np.linalg.norm((decode(data).vertices - mesh.vertices) / scale, axis=1).max()
    assert away <= info(data).meta.max / scale * (1 + 1e-7)
    if "max_error_rel" in options:
        assert away <= 1e-3 * metrics.diagonal(mesh.vertices / scale) * (1 + 1e-9)


@pytest.mark.parametrize("method", ["auto", "cartesian"])
@pytest.mark.parametrize("scale", [1e-317, 1e-319, 1e-320])
def test_a_step_may_be_near_the_least_number(scale: float, method: str) -> None:
    V, F = meshes.icosphere(2)
    mesh = from_arrays(V * scale, F)
    again = decode(encode(mesh, method=method, keep_order=True))
    assert np.abs(again.vertices - mesh.vertices).max() <= 0.02 * scale


@pytest.mark.parametrize("scale", [1e-322, 5e-324])
def test_what_the_least_number_leaves_no_room_for_is_not_met(scale: float) -> None:
    V, F = meshes.icosphere(2)
    mesh = from_arrays(V * scale, F)
    with pytest.raises(TargetError, match="cannot be met"):
        encode(mesh, quality=5)
    assert info(encode(mesh)).parameters.method == "lossless"
    encode(mesh, bits=12)


@pytest.mark.parametrize("scale", [1e-120, 1e-200, 1e-310])
def test_corrections_at_any_scale(scale: float) -> None:
    """The distance that is corrected is found where its square is below the least number."""
    V, F = meshes.grid(15, 15)
    mesh, bound = from_arrays(V * scale, F), 2e-4
    for method in ("refined", "highpass"):
        options = {"max_error_rel": bound, "quality": 3, "anchors": 1}
        data = encode(mesh, method=method, keep_order=True, **options)
        error = np.abs(decode(data).vertices - mesh.vertices).max() / scale
        assert error <= bound * metrics.diagonal(V) * (1 + 1e-6)


@pytest.mark.parametrize("method", ["auto", "cartesian", "lossless"])
@pytest.mark.parametrize("scale", [9.9e148, 1e-200, 1e-310])
def test_attributes_and_polygons_at_any_scale(scale: float, method: str) -> None:
    x, y = (a.ravel() for a in np.meshgrid(np.arange(9.0), np.arange(9.0)))
    i = (np.arange(8)[:, None] * 9 + np.arange(8)).ravel()
    V = np.stack((x, y, np.sin(x / 2)), axis=1) / 9
    normals = np.stack((-np.cos(x / 2) / 2, 0 * x, 1 + 0 * x), axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    F = np.stack((i, i + 1, i + 10, i + 9), axis=1)
    mesh = from_arrays(V * scale, F, vertex={"normal": normals, "uv": V[:, :2]})
    again = decode(encode(mesh, method=method, keep_order=True))
    np.testing.assert_array_equal(again.corners, mesh.corners)
    np.testing.assert_allclose(again.vertex_data["normal"], normals, rtol=0, atol=1e-2)
    np.testing.assert_allclose(again.vertices / scale, V, rtol=0, atol=1e-2)


@pytest.mark.parametrize("method", ["refined", "highpass"])
def test_too_large_for_a_method_is_no_fault_of_the_step(method: str) -> None:
    V, F = meshes.icosphere(2)
    with pytest.raises(MeshError, match=rf"coordinates of .* too large for method {method}"):
        encode(V * 9.9e149, F, method=method, quality=5)


@pytest.mark.parametrize("ratio", [1e20, 1e100, 1e140])
def test_errors_of_a_part_beside_a_far_vertex(ratio: float) -> None:
    """A small square, one half of which is folded by 90 degrees, and a face that is far away."""
    V = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 2], [ratio, 0, 2]], float)
    F = np.array([[0, 1, 2], [0, 2, 3], [0, 4, 5]])
    W = V.copy()
    W[3] = [0.5, 0.5, np.sqrt(0.5)]
    errors = metrics.vertex_errors(V, W, F)
    assert errors.dihedral == pytest.approx(90, abs=1e-9)
    assert errors.max == pytest.approx(1.0, rel=1e-12)
    assert errors.rms == pytest.approx(np.sqrt(1 / 6), rel=1e-12)
