"""Inputs of the encoder: arrays of every kind, and refusals of meshes and options."""

from __future__ import annotations

import meshes
import numpy as np
import pytest

from deltamesh._codec.decoding import decode
from deltamesh._codec.encoding import encode
from deltamesh._codec.inputs import encode_checked, frames_of, mesh_of
from deltamesh._options import Options
from deltamesh._progress import silent
from deltamesh_formats.errors import DeltameshError, MeshError, OptionError
from deltamesh_formats.polymesh.arrays import from_arrays

METHODS = ["highpass", "cartesian"]


def same_as(V, F, reference):
    """Whether the arguments encode to the bytes of a mesh of float64 and int64 arrays."""
    return encode(V, F) == encode(*reference)


def test_kinds_of_arguments() -> None:
    V, F = meshes.torus(7, 6)
    V = np.rint(V * 64) / 64  # exact in float32 and float16
    for kind in (np.float32, np.float16, ">f8", np.longdouble):
        assert same_as(V.astype(kind), F, (V, F)), kind
    for kind in (np.int32, np.uint8, np.uint64, ">i2"):
        assert same_as(V, F.astype(kind), (V, F)), kind
    assert same_as(np.asfortranarray(V), np.asfortranarray(F), (V, F))
    assert same_as(np.repeat(V, 2, axis=0)[::2], np.repeat(F, 3, axis=1)[:, ::3], (V, F))
    assert same_as(V.tolist(), F.tolist(), (V, F))
    assert same_as(tuple(map(tuple, V)), tuple(map(tuple, F)), (V, F))
    assert same_as((64 * V).astype(np.int64), F, (64 * V, F))


def test_frames_are_several_meshes_or_positions_of_several() -> None:
    V, F = meshes.icosphere(0)
    mesh = from_arrays(V, F)
    for frames in ([mesh, mesh], (mesh,), iter([mesh, mesh])):
        assert frames_of(frames, None) is frames
    for one in (mesh, V, V.tolist(), "mesh.ply", b"ply"):
        assert frames_of(one, None) is None
    for one in (V, V.tolist(), [[0, 0, 0], [1, 2]]):
        assert frames_of(one, F) is None
    found = frames_of(np.stack((V, 2 * V)), F)
    assert found is not None
    for frame, expected in zip(found, (V, 2 * V), strict=True):
        np.testing.assert_array_equal(frame.vertices, expected)
        np.testing.assert_array_equal(frame.faces, F)


def test_arrays_make_a_mesh_of_doubles() -> None:
    V, F = meshes.icosphere(0)
    mesh = from_arrays(V.astype(np.float32), F)
    assert mesh_of(mesh, None) is mesh
    assert (mesh.precision, mesh_of(mesh.vertices, F).precision) == ("float32", "float64")
    with pytest.raises(MeshError, match="ndarray without faces"):
        mesh_of(V, None)


def test_one_mesh_has_no_rate_of_frames() -> None:
    with pytest.raises(OptionError, match="fps"):
        encode_checked(from_arrays(*meshes.icosphere(0)), Options(fps=24.0), silent)


# ---- Refusals: the mesh ------------------------------------------------------------------------

SPHERE, FACES = meshes.icosphere(1)


def with_vertex(index, value):
    V = SPHERE.copy()
    V[index, 1] = value
    return V, FACES


REFUSED = [
    pytest.param((SPHERE, FACES[:0]), r"no faces", id="no faces"),
    pytest.param(([], []), r"shape", id="nothing"),
    pytest.param((SPHERE, []), r"no faces", id="a list of no faces"),
    pytest.param(with_vertex(7, np.nan), r"vertex 7 is not finite", id="NaN"),
    pytest.param(with_vertex(41, -np.inf), r"vertex 41 is not finite", id="infinite"),
    pytest.param((SPHERE, FACES + 1), r"face \d+ .*42.*0\.\.41", id="index too large"),
    pytest.param((SPHERE, FACES - 1), r"face \d+ .*-1.*0\.\.41", id="index negative"),
    pytest.param((SPHERE, FACES[:, :2]), r"face 0 has 2 corners", id="edges"),
    pytest.param((SPHERE, FACES[0]), r"\(3,\)|not a row", id="a row of faces"),
    pytest.param((from_arrays(SPHERE, FACES), FACES), r"has its own", id="faces twice"),
    pytest.param((SPHERE[:, :2], FACES), r"\(42, 2\)", id="plane coordinates"),
    pytest.param((SPHERE, FACES.astype(float)), r"integers", id="faces of floats"),
    pytest.param((SPHERE, FACES > 2), r"integers", id="faces of booleans"),
    pytest.param((SPHERE + 0j, FACES), r"real", id="complex"),
    pytest.param((SPHERE.astype(object), FACES), r"real", id="objects"),
    pytest.param((None, FACES), r"vertices must be real", id="no vertices"),
    pytest.param(([[0, 0, 0], [1, 2]], [[0, 1, 0]]), r"vertices", id="ragged vertices"),
    pytest.param((SPHERE, [[0, 1, 2], [3, 4]]), r"face 1 has 2 corners", id="ragged faces"),
]


def test_faces_are_those_of_from_arrays() -> None:
    """Triangles, quads and polygons of any sizes, as arrays and as lists."""
    quads = np.array([[0, 1, 2, 3], [3, 2, 4, 5]])
    for faces in (FACES[:2], FACES[:2].tolist(), quads, quads.tolist(), [[0, 1, 2], quads[1]]):
        whole = from_arrays(SPHERE, faces)
        data = encode(SPHERE, faces, method="lossless")
        assert data == encode(whole, method="lossless")
        assert sorted(decode(data).sizes) == sorted(whole.sizes)


@pytest.mark.parametrize(("mesh", "message"), REFUSED)
def test_mesh_is_refused(mesh: meshes.Arrays, message: str) -> None:
    for method in METHODS:
        with pytest.raises(MeshError, match=message) as caught:
            encode(*mesh, method=method)
        assert isinstance(caught.value, DeltameshError)
        assert isinstance(caught.value, ValueError)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("scale", [1.3e150, 1.7e308])
def test_a_mesh_out_of_all_bounds_is_refused(scale: float, method: str) -> None:
    with pytest.raises(MeshError, match="vertex 0 is beyond"):
        encode(SPHERE * scale, FACES, method=method)


@pytest.mark.parametrize("method", METHODS)
def test_a_step_that_is_too_small_is_refused(method: str) -> None:
    with pytest.raises(MeshError, match="too small"):
        encode(SPHERE, FACES, method=method, step=1e-10)


# ---- Refusals: the options ---------------------------------------------------------------------

BAD_OPTIONS = [
    {"method": "spectral"},
    {"method": None},
    {"bits": -1},
    {"bits": 31},
    {"bits": 8.5},
    {"bits": True},
    {"method": "cartesian", "bits": 0},
    {"method": "cartesian", "bits": 31},
    {"step": 0},
    {"step": -1.0},
    {"step": float("nan")},
    {"step": float("inf")},
    {"bits": 8, "step": 0.1},
    {"bits": 0, "step": 0.1},
    {"anchors": 0},
    {"anchors": -3},
    {"anchors": 0.0},
    {"anchors": 1.0},
    {"anchors": 2.5},
    {"anchors": float("nan")},
    {"anchors": True},
    {"anchors": "3"},
    {"anchor_method": "nearest"},
    {"seed": -1},
    {"seed": 2**64},
    {"seed": 1.5},
    {"threads": 0},
    {"threads": -1},
    {"threads": 1.5},
    {"solver": "gauss"},
    {"method": "cartesian", "solver": "gauss"},
    {"source_format": "x" * 300},
    {"source_format": "\x1b[2J"},
]


@pytest.mark.parametrize("options", BAD_OPTIONS, ids=lambda o: str(o)[:40])
def test_option_is_refused(options: dict) -> None:
    with pytest.raises(OptionError) as caught:
        encode(SPHERE, FACES, **options)
    assert isinstance(caught.value, DeltameshError)


def test_options_may_be_numpy_numbers() -> None:
    expected = encode(SPHERE, FACES, bits=8, anchors=4, seed=3, threads=1)
    given_options = {
        "bits": np.int64(8),
        "anchors": np.int32(4),
        "seed": np.uint64(3),
        "threads": np.int8(1),
    }
    assert encode(SPHERE, FACES, **given_options) == expected
    assert encode(SPHERE, FACES, step=np.float32(0.25)) == encode(SPHERE, FACES, step=0.25)
