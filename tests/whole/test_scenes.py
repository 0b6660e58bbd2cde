"""Scenes of parts of unlike size: each part keeps its shape, and the worst one is told by name.

Parts are measured after decoding, each as if it were a mesh of its own.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import meshes
import numpy as np
import pytest
from commandline import cli

from deltamesh import decode
from deltamesh._graph.adjacency import components_of_faces
from deltamesh._measures.metrics import diagonal, vertex_errors
from deltamesh._options import Options
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh_formats.errors import TargetError
from deltamesh_formats.meshfiles.files import write_mesh
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh, from_triangles

METHODS = ("auto", "refined", "highpass", "cartesian")
SEED = 2006
SIDE = 16  # of the ground, in vertices


def scene(*solids: meshes.Arrays) -> PolyMesh:
    return from_triangles(*meshes.union(*solids))


def moved(solid: meshes.Arrays, size: float, at: object) -> meshes.Arrays:
    return size * solid[0] + np.asarray(at), solid[1]


def ground(height: float = 0.0) -> meshes.Arrays:
    V, F = meshes.grid(SIDE, SIDE)
    return (V - [0.5, 0.5, 0]) * [500, 500, height], F


def ball_on_a_ground() -> PolyMesh:
    mesh = scene(ground(), moved(meshes.icosphere(2), 0.5, [10, 20, 1]))
    of_face = np.repeat([0, 1], [2 * (SIDE - 1) ** 2, 320])
    return replace(mesh, parts=(Parts("object", ("ground", "ball"), of_face),))


def balls_over_hills() -> PolyMesh:
    at = np.random.default_rng(SEED).uniform(-200, 200, (9, 3))
    balls = (moved(meshes.icosphere(1), 0.3 + 0.2 * i, place) for i, place in enumerate(at))
    return scene(ground(60), *balls)


def bolts_in_a_hall() -> PolyMesh:
    at = np.random.default_rng(SEED).uniform(-90, 90, (60, 3))
    bolts = (moved(meshes.tetrahedron(), 0.1, place) for place in at)
    return scene(moved(meshes.tetrahedron(), 100, 0), *bolts)


def a_millionfold_apart() -> PolyMesh:
    return scene(
        moved(meshes.icosphere(2), 1000, 0), moved(meshes.icosphere(2), 0.001, [900, 800, 700])
    )


def triangles_of_all_sizes() -> PolyMesh:
    rng = np.random.default_rng(SEED)
    size = 10 ** rng.uniform(-4, 0, (80, 1, 1))
    corners = rng.uniform(-10, 10, (80, 1, 3)) + size * rng.normal(size=(80, 3, 3))
    return from_triangles(corners.reshape(-1, 3), np.arange(240).reshape(-1, 3))


def tiles_of_a_terrain() -> PolyMesh:
    """One component; a small object in it, and a large one."""
    mesh = scene(ground(60))
    inside = (np.abs(mesh.vertices[mesh.triangles].mean(axis=1)[:, :2]) < 40).all(axis=1)
    names = ("rest", "tile")
    return replace(mesh, parts=(Parts("object", names, inside.astype(np.int64)),))


SCENES: dict[str, Callable[[], PolyMesh]] = {
    one.__name__: one
    for one in (
        ball_on_a_ground,
        balls_over_hills,
        bolts_in_a_hall,
        a_millionfold_apart,
        triangles_of_all_sizes,
        tiles_of_a_terrain,
    )
}
ASKED = [
    pytest.param({}, 1.0, 1.5e-3, id="default"),
    pytest.param({"quality": 7}, 0.5, 0.75e-3, id="quality 7"),
    pytest.param({"normal_error": 1.0}, 1.0, 1.5e-3, id="normal error 1"),
    *(
        pytest.param({"method": method, "quality": 5}, 1.0, 1.5e-3, id=method)
        for method in METHODS[1:]
    ),
]


def worst_errors(mesh: PolyMesh, **options: object) -> tuple[float, float, int]:
    """Normal deviation and relative RMS of the worst components and objects; triangles lost."""
    encoded = encode_mesh(mesh, Options(**options))
    W = np.empty_like(mesh.vertices)
    W[encoded.order] = decode(encoded.data).vertices
    V, F = mesh.vertices, mesh.triangles
    component = components_of_faces(F, len(V))[F[:, 0]]
    normals, distances = [], []
    for part in (component, *(one.of_face for one in mesh.parts)):
        for number in np.unique(part):
            used, faces = np.unique(F[part == number], return_inverse=True)
            errors = vertex_errors(V[used], W[used], faces.reshape(-1, 3))
            normals.append(errors.normal_deviation)
            distances.append(errors.rms / diagonal(V[used]))
    report = encoded.draft.report
    assert report is not None
    return max(normals), max(distances), len(report.lost)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize(("options", "normal", "rms"), ASKED)
def test_every_part_of_a_scene_is_kept(
    name: str, options: dict[str, object], normal: float, rms: float
) -> None:
    found = worst_errors(SCENES[name](), **options)
    assert found[0] <= normal
    assert found[1] <= rms * (1 + 1e-6)
    assert found[2] == 0


@pytest.mark.parametrize("method", METHODS)
def test_a_far_vertex_in_no_face_does_not_excuse_the_only_part(method: str) -> None:
    V, F = meshes.icosphere(2)
    mesh = from_triangles(np.concatenate([V, [[1e6, 0, 0]]]), F)
    encoded = encode_mesh(mesh, Options(method=method, quality=5))
    W = np.empty_like(mesh.vertices)
    W[encoded.order] = decode(encoded.data).vertices
    errors = vertex_errors(V, W[:-1], F)
    assert errors.normal_deviation <= 1
    assert errors.rms <= 1.5e-3 * diagonal(V) * (1 + 1e-6)


def test_where_the_grid_is_too_coarse_for_the_only_part_it_is_kept_exactly() -> None:
    V, F = meshes.icosphere(2)
    mesh = from_triangles(np.concatenate([V, [[1e9, 0, 0]]]), F)
    with pytest.raises(TargetError, match="cannot be met in component 0"):
        encode_mesh(mesh, Options(quality=5))
    assert encode_mesh(mesh, Options()).container.parameters.method == "lossless"


def test_at_a_rate_a_small_part_is_lost_and_that_is_reported() -> None:
    normal, rms, lost = worst_errors(ball_on_a_ground(), method="refined", bits=6)
    assert normal > 45
    assert rms > 0.1
    assert lost > 100


def test_a_small_part_does_not_make_the_others_finer() -> None:
    V, F = meshes.grid(40, 40)
    hills = (V - [0.5, 0.5, 0]) * [500, 500, 60], F
    mesh = scene(hills, moved(meshes.icosphere(2), 0.5, [10, 20, 40]))
    encoded = encode_mesh(mesh, Options(method="cartesian", quality=5))
    chosen = encoded.draft.chosen.settings
    finest = chosen.step * 2 ** (-max(chosen.exponents) / 4)
    assert chosen.step > 16 * finest
    alike = encode_mesh(mesh, Options(method="cartesian", step=finest))
    assert len(encoded.data) < 0.7 * len(alike.data)


# ---- The command line --------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a scene of two objects, which is the current one."""
    monkeypatch.chdir(tmp_path)
    write_mesh("scene.glb", ball_on_a_ground())
    return tmp_path


def test_encode_notes_the_faces_that_are_lost(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli("encode scene.glb") == 0
    assert "lost their area" not in capsys.readouterr().err
    assert cli("encode -f scene.glb --method refined --bits 6") == 0
    note = capsys.readouterr().err
    assert "scene.glb: triangles that lost their area: " in note
    first = int(note.split("the first in face ")[1].split()[0])
    assert first >= 2 * (SIDE - 1) ** 2  # one of the ball's


def test_info_and_compare_name_the_worst_part(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli("encode -q scene.glb") == 0
    assert cli("info scene.glb.dmesh") == 0
    assert "worst of 2 parts: ball, normals " in capsys.readouterr().out
    assert cli("compare scene.glb scene.glb.dmesh") == 0
    line = next(x for x in capsys.readouterr().out.splitlines() if "worst of 2 parts" in x)
    assert line.split()[-1] == "ball"
    worst = []
    for command in ("info scene.glb.dmesh", "compare scene.glb scene.glb.dmesh"):
        assert cli(f"{command} --json") == 0
        worst.append(json.loads(capsys.readouterr().out)["errors"]["worst_part"])
    assert worst[0]["name"] == worst[1]["name"] == "ball"
    for key in ("normal_deviation_degrees", "rms_relative"):
        assert worst[0][key] == pytest.approx(worst[1][key], rel=1e-3)
