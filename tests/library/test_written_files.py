"""Written files keep the bounds of the encoder, whatever the source and wherever the mesh is."""

from __future__ import annotations

import io
from dataclasses import replace
from itertools import product
from typing import Any

import meshes
import numpy as np
import pytest

import deltamesh
from deltamesh import OptionError
from deltamesh_formats.meshfiles.files import read_mesh, write_mesh, written
from deltamesh_formats.meshfiles.formats import FORMATS
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh, from_triangles

V, F = meshes.torus(12, 8)
TURN = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
OFFSETS = (0.0, 1e3, 4e6)
BOUNDS: tuple[tuple[dict[str, Any], float], ...] = (
    ({"method": "lossless"}, 0.0),
    ({"method": "cartesian", "max_error": 1e-3}, 1e-3),
    ({"method": "highpass", "max_error": 1e-3}, 1e-3),
    ({"method": "cartesian", "max_error": 1e-6}, 1e-6),
)


def again(mesh: PolyMesh, file_format: str) -> PolyMesh:
    return read_mesh(io.BytesIO(written(mesh, file_format).data), file_format)


def source(kind: str, offset: float) -> PolyMesh:
    """The torus, far from the origin, as a file of some kind has it."""
    away = offset * np.array([1, -0.5, 0.25]) + 0.1
    mesh = from_triangles(V + away, F)
    if kind in ("ply float32", "stl"):
        single = mesh.vertices.astype(np.float32).astype(np.float64)
        return again(replace(mesh, vertices=single, precision="float32"), kind.split()[0])
    if kind == "glb":  # turned, scaled and moved by its node
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = 3 * TURN, away
        objects = Parts("object", ("a",), np.zeros(len(F), dtype=np.int64), matrix[None])
        near = V.astype(np.float32).astype(np.float64)
        return again(replace(mesh, vertices=near @ (3 * TURN).T + away, parts=(objects,)), "glb")
    return again(mesh, kind)


KINDS = ("ply float32", "ply", "obj", "off", "stl", "glb")


def distance(mesh: PolyMesh, other: PolyMesh) -> float:
    """The largest distance of corners; the triangles come in the same order."""
    a, b = (one.vertices[one.triangles].reshape(-1, 3) for one in (mesh, other))
    assert len(a) == len(b)
    return float(np.linalg.norm(a - b, axis=1).max())


@pytest.mark.parametrize(("kind", "offset"), [*product(KINDS, OFFSETS)])
@pytest.mark.parametrize(("options", "bound"), BOUNDS)
def test_every_format_keeps_the_bound_or_says_so(
    kind: str, offset: float, options: dict[str, Any], bound: float
) -> None:
    mesh = source(kind, offset)
    decoded = deltamesh.decode(deltamesh.encode(mesh, keep_order=True, **options))
    assert decoded.margin <= 0.005 * bound
    for file_format in FORMATS:
        made = written(decoded, file_format)
        error = distance(mesh, read_mesh(io.BytesIO(made.data), file_format))
        named = any("positions beyond float32" in words for words in made.lost)
        # Where a node turns positions, a GLB of float32 loses what float64 cannot hold.
        single = file_format in ("glb", "gltf")
        noise = 2.0**-50 * np.abs(mesh.vertices).max() if single else 0.0
        assert error <= max(bound, noise) or (named and (single or file_format == "stl"))


@pytest.mark.parametrize(("kind", "offset"), [*product(KINDS, OFFSETS)])
def test_pyvista_gets_positions_within_the_bound(kind: str, offset: float) -> None:
    pytest.importorskip("pyvista")
    from deltamesh.plugins.pyvista import from_pyvista, to_pyvista

    mesh = source(kind, offset)
    for options, bound in BOUNDS:
        decoded = deltamesh.decode(deltamesh.encode(mesh, keep_order=True, **options))
        assert distance(mesh, from_pyvista(to_pyvista(decoded))) <= bound


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e5])
def test_angles_of_a_text_keep_their_bounds(scale: float) -> None:
    mesh = from_triangles(scale * V, F)
    data = deltamesh.encode(mesh, normal_error=0.5, dihedral_error=0.7, keep_order=True)
    back = again(deltamesh.decode(data), "obj")
    from deltamesh._measures.metrics import vertex_errors

    errors = vertex_errors(mesh.vertices, back.vertices, F)
    assert errors.normal_deviation <= 0.5
    assert errors.dihedral <= 0.7


def test_a_text_has_the_digits_that_its_error_deserves() -> None:
    noise = np.random.default_rng(1).normal(size=V.shape)
    mesh = again(from_triangles(np.round(V + 1e-2 * noise, 6), F), "obj")
    size = len(written(mesh, "obj").data)
    for options in ({}, {"max_error": 1e-3}, {"method": "lossless"}):
        decoded = deltamesh.decode(deltamesh.encode(mesh, **options))
        assert len(written(decoded, "obj").data) <= size
    coarse = deltamesh.decode(deltamesh.encode(mesh, method="cartesian", max_error=0.1))
    places = [
        len(f"{x!r}".partition(".")[2]) for x in again(coarse, "off").vertices.ravel().tolist()
    ]
    assert max(places) <= 5


def test_texture_coordinates_and_normals_have_few_digits_too() -> None:
    n = V / np.linalg.norm(V, axis=1, keepdims=True)
    uv = np.random.default_rng(1).uniform(size=(len(V), 2))
    attributes = (Attribute("uv", "vertex", uv, "uv"), Attribute("normal", "vertex", n, "normal"))
    mesh = replace(from_triangles(V, F), attributes=attributes)
    decoded = deltamesh.decode(deltamesh.encode(mesh, keep_order=True))
    back = again(decoded, "obj")
    for one, other in zip(decoded.attributes, back.attributes, strict=True):
        found = other.values if other.index is None else other.dense()
        assert 0 < one.margin < 1e-4
        assert 0 < np.abs(one.dense() - found).max() <= one.margin
        texts = [len(repr(x)) for x in found.ravel().tolist()]
        assert max(texts) <= 10
    exact = deltamesh.decode(deltamesh.encode(mesh, keep_order=True, lossless_attributes=True))
    for one, other in zip(mesh.attributes, again(exact, "obj").attributes, strict=True):
        np.testing.assert_array_equal(one.dense(), other.dense())


def test_float32_attributes_come_back_from_text_as_they_were() -> None:
    uv = np.random.default_rng(1).uniform(size=(len(V), 2)).astype(np.float32)
    mesh = replace(from_triangles(V, F), attributes=(Attribute("uv", "vertex", uv, "uv"),))
    for file_format in ("obj", "off"):
        (back,) = again(mesh, file_format).attributes
        np.testing.assert_array_equal(back.dense(), uv.astype(np.float64))


def test_attributes_beyond_float32_are_named() -> None:
    uv = np.random.default_rng(1).uniform(size=(len(V), 2))
    single = V.astype(np.float32).astype(np.float64)
    mesh = replace(from_triangles(single, F), attributes=(Attribute("uv", "vertex", uv, "uv"),))
    (lost,) = written(mesh, "glb").lost
    assert lost.startswith("texture coordinates beyond float32 (by up to ")
    rounded = Attribute("uv", "vertex", uv, "uv", margin=1e-6)
    assert written(replace(mesh, attributes=(rounded,)), "glb").lost == ()


def test_digits_are_decimal_places(tmp_path: Any) -> None:
    mesh = from_triangles(V + 4e6, F)
    lost = write_mesh(tmp_path / "a.obj", mesh, digits=2)
    assert [words.partition(" (")[0] for words in lost] == ["positions beyond 2 decimal places"]
    np.testing.assert_array_equal(read_mesh(tmp_path / "a.obj").vertices, np.round(V + 4e6, 2))
    assert write_mesh(tmp_path / "a.off", mesh, digits=20) == ()
    np.testing.assert_array_equal(read_mesh(tmp_path / "a.off").vertices, V + 4e6)
    assert write_mesh(tmp_path / "a.ply", mesh, digits=2) == ()  # it has no digits
    for wrong in (-1, 21, 2.5):
        with pytest.raises(OptionError, match=r"digits must lie in 0\.\.20"):
            write_mesh(tmp_path / "a.obj", mesh, digits=wrong)  # type: ignore[arg-type]


def test_a_glb_far_away_keeps_its_shape_beside_others() -> None:
    """Each object is moved by a node of its own, and only where float32 does not hold it."""
    two = np.concatenate([V, V + np.array([5e5, 0, 0])])
    objects = Parts("object", ("near", "far"), np.repeat([0, 1], len(F)))
    mesh = replace(from_triangles(two, np.concatenate([F, F + len(V)])), parts=(objects,))
    data = deltamesh.encode(mesh, method="cartesian", max_error=2e-3, keep_order=True)
    made = written(deltamesh.decode(data), "glb")
    assert made.lost == ()
    back = read_mesh(io.BytesIO(made.data), "glb")
    assert distance(mesh, back) <= 2e-3
    (parts,) = back.parts
    assert parts.transforms is not None
    assert [bool((one == np.eye(4)).all()) for one in parts.transforms] == [True, False]
    assert back.precision == "float64"
