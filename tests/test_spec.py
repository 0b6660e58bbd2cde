"""SPEC.md against the package: `spec_decoder` makes of a file what `decode` makes of it."""

from __future__ import annotations

from pathlib import Path

import meshes
import numpy as np
import pytest
import spec_decoder
import strategies

from deltamesh import decode, encode, info
from deltamesh.metrics import diagonal

HERE = Path(__file__).parent
GOLDEN = sorted((HERE / "golden").glob("*.dmesh"))
REFUSED = sorted((HERE / "refused").glob("*.dmesh"))

FRESH = {
    "triangle": ((np.eye(3), np.array([[0, 1, 2]])), {}),
    "closed": (meshes.icosphere(1), {"bits": 9}),
    "boundary": (meshes.grid(6, 11), {"step": 1e-3}),
    "handles": (meshes.double_torus(), {"bits": 10, "anchors": 3}),
    "many joins": (meshes.torus(3, 20), {"bits": 4, "anchor_method": "greedy", "anchors": 12}),
    "components": (meshes.two_components(), {"anchor_method": "random", "seed": 7, "anchors": 9}),
    "components, greedy": (meshes.two_components(), {"anchor_method": "greedy", "anchors": 5}),
    "isolated, greedy": (meshes.with_isolated(), {"anchor_method": "greedy", "anchors": 4}),
    "0 bits": (meshes.torus(8, 6), {"bits": 0, "anchors": 8}),
    "26 bits": (meshes.icosphere(1), {"bits": 26}),
    "refined": (meshes.two_components(), {"method": "refined", "anchors": 3}),
    "refined, boundary": (meshes.grid(9, 6), {"method": "refined", "step": 1e-3}),
    "cartesian": (meshes.torus(9, 5), {"method": "cartesian", "bits": 10}),
    "cartesian, isolated": (meshes.with_isolated(), {"method": "cartesian", "bits": 16}),
    "cartesian, boundaries": (
        meshes.union(meshes.grid(4, 4), meshes.grid(5, 3)),
        {"method": "cartesian", "step": 0.02},
    ),
    "lossless": (meshes.torus(9, 5), {"method": "lossless"}),
    "lossless, isolated": (meshes.with_isolated(), {"method": "lossless"}),
}


def assert_same(data: bytes) -> None:
    vertices, faces, _ = spec_decoder.decode(data)
    mesh = decode(data)
    np.testing.assert_array_equal(faces, mesh.faces)
    if info(data).parameters.method == "lossless":
        assert vertices.tobytes() == mesh.vertices.tobytes()
        return
    atol = 1e-9 * diagonal(mesh.vertices)
    np.testing.assert_allclose(vertices, mesh.vertices, rtol=0, atol=atol)


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_golden_file(path: Path) -> None:
    assert_same(path.read_bytes())


@pytest.mark.parametrize("name", FRESH)
def test_fresh_file(name: str) -> None:
    (vertices, faces), options = FRESH[name]
    noise = np.random.default_rng(2003).normal(size=vertices.shape)
    assert_same(encode(vertices + 0.03 * noise, faces, **options))


def test_large_valences() -> None:
    """Two bipyramids joined by tubes: valences and splits that are spelled as numbers."""
    corner, rim = np.arange(40), np.roll(np.arange(40), -1)
    upper = np.stack((corner, rim, np.full(40, 40)), axis=1)
    lower = np.stack((rim, corner, np.full(40, 41)), axis=1)
    faces = [
        tuple(face) for half in (upper, lower, upper + 42, lower + 42) for face in half.tolist()
    ]
    for at in range(6):
        faces = strategies.join_by_tube(faces, 13 * at, 90 + 11 * at)
    vertices = np.random.default_rng(2).normal(size=(84, 3))
    assert_same(encode(vertices, np.array(faces), method="cartesian"))


@pytest.mark.parametrize("path", REFUSED, ids=lambda path: path.stem)
def test_refused_file(path: Path) -> None:
    with pytest.raises(ValueError):  # noqa: PT011  # a RefusedError, or text that is none
        spec_decoder.decode(path.read_bytes())
