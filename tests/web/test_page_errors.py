"""The errors that the page shows in colours against those of the library, and of `compare`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import meshes
import numpy as np
import polygon_meshes
import pytest
from browser import Browser
from numpy.typing import NDArray
from oracle import squared_to_triangle

import deltamesh
from deltamesh import PolyMesh
from deltamesh._measures.metrics import compare, reference_of
from deltamesh._mesh import TriangleMesh
from deltamesh._page.filling import PageFile, page_of
from deltamesh_cli.program import run
from deltamesh_formats.polymesh.mesh import from_triangles

FIELD = """
const [original, own] = deltameshViewer.panels;
const found = own.field(arguments[0], original);
return found && [Array.from(own.mesh.triangles), Array.from(found)];
"""
POSITIONS = "return deltameshViewer.panels.map(({ mesh }) => Array.from(mesh.positions))"


def lossless(*pair: PolyMesh) -> list[PageFile]:
    """An original and a mesh as they are, to the last bit and in their order."""
    data = [deltamesh.encode(one, method="lossless", keep_order=True) for one in pair]
    roles = ("original", "")
    return [PageFile(f"{role}.dmesh", d, role, len(d)) for role, d in zip(roles, data, strict=True)]


def shown(browser: Browser, folder: Path, *pair: PolyMesh) -> None:
    path = folder / "page.html"
    path.write_text(page_of(lossless(*pair), "t"), encoding="utf-8")
    browser.open(path)


def field(browser: Browser, kind: str) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The triangles (m, 3) that the page has, and an error at their corners (m, 3)."""
    found = browser.run(FIELD, kind)
    return tuple(np.array(one).reshape(-1, 3) for one in found)  # type: ignore[return-value]


def moved(mesh: PolyMesh, size: float) -> PolyMesh:
    """Return a mesh whose vertices have moved, those at one position alike."""
    V = mesh.vertices
    W = V + size * np.sin(37 * V[:, [1, 2, 0]] + 1)
    return replace(mesh, vertices=W)


PAIRS = {
    "ball": from_triangles(*meshes.icosphere(2)),
    "boundary": from_triangles(*meshes.grid(9, 7)),
    "three pages": from_triangles(*meshes.three_pages()),
    "mixed winding": from_triangles(*meshes.mixed_winding()),
    "seams": from_triangles(*meshes.seams()),
    "one side": from_triangles(*meshes.moebius(20)),
    "quads": polygon_meshes.quad_torus(9, 7),
}


@pytest.mark.parametrize("name", PAIRS)
def test_fields_are_the_differences_of_the_library(
    browser: Browser, tmp_path: Path, name: str
) -> None:
    original, other = PAIRS[name], moved(PAIRS[name], 0.05)
    shown(browser, tmp_path, original, other)
    triangles, normals = field(browser, "normals")
    # Welded: a vertex that is there twice is one vertex of the surface.
    _, first, site = np.unique(original.vertices, axis=0, return_index=True, return_inverse=True)
    surface = site.ravel()[triangles]
    reference = reference_of(original.vertices[first], surface)
    differences = reference.differences(other.vertices[first])
    np.testing.assert_allclose(
        normals, np.repeat(differences.angle[:, None], 3, 1), rtol=1e-5, atol=1e-6
    )
    _, dihedral = field(browser, "dihedral")
    left, right = reference.edges.T // 3
    sums, counts = np.zeros(len(triangles)), np.zeros(len(triangles))
    for side in (left, right):
        np.add.at(sums, side, differences.change)
        np.add.at(counts, side, 1)
    expected = sums / np.maximum(counts, 1)
    np.testing.assert_allclose(dihedral, np.repeat(expected[:, None], 3, 1), rtol=1e-5, atol=1e-6)
    diagonal = np.linalg.norm(np.ptp(original.vertices, axis=0))
    at, distance = field(browser, "distance")
    off = other.vertices - original.vertices
    np.testing.assert_allclose(distance, np.linalg.norm(off, axis=1)[at] / diagonal, rtol=1e-5)
    _, signed = field(browser, "signed")
    V = original.vertices[triangles]
    N = np.zeros_like(original.vertices)
    for k in range(3):
        np.add.at(N, triangles[:, k], np.cross(V[:, 1] - V[:, 0], V[:, 2] - V[:, 0]))
    N /= np.maximum(np.linalg.norm(N, axis=1, keepdims=True), 1e-300)
    along = (off * N).sum(axis=1)[at] / diagonal
    np.testing.assert_allclose(signed, along, rtol=1e-5, atol=1e-8)
    assert (signed > 0).any()
    assert (signed < 0).any()


def test_their_means_are_the_numbers_of_compare(browser: Browser, tmp_path: Path) -> None:
    mesh = from_triangles(*meshes.torus(40, 30))
    file, original, page = (tmp_path / name for name in ("t.dmesh", "t.ply", "t.html"))
    file.write_bytes(deltamesh.encode(mesh, bits=6, method="refined"))
    deltamesh.write_mesh(original, mesh)
    assert run(["view", "-q", "--no-open", str(file), str(original), "-o", str(page)]) == 0
    browser.open(page)
    reference, own = (np.array(one).reshape(-1, 3) for one in browser.run(POSITIONS))
    triangles, normals = field(browser, "normals")
    errors = compare(TriangleMesh(reference, triangles), TriangleMesh(own, triangles))
    V = reference[triangles]
    areas = np.linalg.norm(np.cross(V[:, 1] - V[:, 0], V[:, 2] - V[:, 0]), axis=1)
    assert np.average(normals[:, 0], weights=areas) == pytest.approx(errors.normal_deviation)
    # Each edge belongs to two triangles of three edges.
    _, dihedral = field(browser, "dihedral")
    assert dihedral[:, 0].mean() == pytest.approx(errors.dihedral)
    _, distance = field(browser, "distance")
    at_vertices = np.empty(len(own))
    at_vertices[triangles] = distance
    rms = np.sqrt((at_vertices**2).mean()) * errors.diagonal
    assert rms == pytest.approx(errors.rms)
    # And both are what the table beside the picture says, with four digits.
    text = browser.run("return document.querySelector('#numbers').textContent")
    for number in (errors.normal_deviation, errors.dihedral):
        assert f"{number:.3g}"[:4] in text


def test_a_face_that_becomes_a_point_counts_a_right_angle(browser: Browser, tmp_path: Path) -> None:
    V, F = meshes.icosphere(1)
    W = V.copy()
    W[F[0]] = V[F[0, 0]]
    shown(browser, tmp_path, from_triangles(V, F), from_triangles(W, F))
    triangles, normals = field(browser, "normals")
    ((row,),) = np.nonzero((np.sort(triangles, axis=1) == np.sort(F[0])).all(axis=1))
    assert normals[row].tolist() == [90.0] * 3


def test_distances_to_another_structure_are_those_to_the_surface(
    browser: Browser, tmp_path: Path
) -> None:
    """Large triangles: the nearest vertex belongs to none of the nearest ones."""
    corners = np.array([[0.0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0], [4, 4, 5]])
    plane = from_triangles(corners, np.array([[0, 1, 2], [0, 2, 3], [3, 2, 4]]))
    points = np.random.default_rng(3).uniform([1, 1, -2], [8, 3, 0.2], (60, 3))
    scan = from_triangles(points, np.arange(60).reshape(-1, 3))
    shown(browser, tmp_path, plane, scan)
    triangles, distance = field(browser, "distance")
    diagonal = np.linalg.norm(np.ptp(corners, axis=0))
    at_vertices = np.empty(60)
    at_vertices[triangles] = distance * diagonal
    for v in range(60):
        exact = min(squared_to_triangle(points[v], corners[face]) for face in plane.triangles)
        assert at_vertices[v] == pytest.approx(np.sqrt(exact), rel=1e-5)
    assert browser.run(FIELD, "normals") is None
