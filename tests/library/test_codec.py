"""Encoder and decoder as callers see them: round trips, determinism, refusals."""

from __future__ import annotations

import hashlib
import os
import sys

import children
import meshes
import numpy as np
import oracle
import pytest
import strategies
from graphs import FREE_SOLVERS as SOLVERS
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._codec import decode, encode
from deltamesh._geometry.quantize import from_grid
from deltamesh._limits import DEFAULT_MAX_VERTICES, DEFAULT_MEMORY
from deltamesh._measures.metrics import diagonal, vertex_errors
from deltamesh._options import Options
from deltamesh._pipeline import encode_mesh, read_content
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import DeltameshError, MeshError, OptionError
from deltamesh_formats.polymesh.arrays import from_arrays
from deltamesh_formats.polymesh.mesh import from_triangles

MANIFOLDS = {name: mesh for name, mesh in meshes.every().items() if name != "three_pages"}

# The tolerance that is promised for positions, in diagonals.
TOLERANCE = 1e-9


def frozen(mesh):
    """Copies that cannot be written to: who modifies an input raises."""
    V, F = (array.copy() for array in mesh)
    V.flags.writeable = F.flags.writeable = False
    return V, F


def assert_round_trip(V, F, **options):
    """Encode, decode, check all that holds for any mesh; return what the encoder gave."""
    V, F = frozen((V, F))
    encoded = encode_mesh(from_arrays(V, F), Options(**options))
    decoded = decode(encoded.data)
    assert_decoded(decoded, encoded)
    # `order` takes the faces back to the input, winding and all.
    assert strategies.canonical(encoded.order[decoded.faces]) == strategies.canonical(F)
    assert len(set(encoded.order)) == len(encoded.order)
    used = np.unique(F)
    kept = used if options.get("drop_isolated") else np.arange(len(V))
    assert sorted(encoded.order) == kept.tolist()
    return encoded


def assert_decoded(decoded, encoded):
    assert decoded.vertices.dtype == np.float64
    assert decoded.faces.dtype == np.int64
    for array in (decoded.vertices, decoded.faces):
        assert array.flags.writeable
        assert array.flags.c_contiguous
    np.testing.assert_array_equal(decoded.faces, encoded.mesh.faces)
    atol = TOLERANCE * diagonal(encoded.mesh.vertices)
    np.testing.assert_allclose(decoded.vertices, encoded.mesh.vertices, rtol=0, atol=atol)


# ---- Round trips -------------------------------------------------------------------------------

highpass_options = st.fixed_dictionaries(
    {
        "diffusion": st.booleans(),
        "anchors": st.none() | st.integers(1, 50) | st.floats(0.001, 0.999),
        "anchor_method": st.sampled_from(["farthest", "random", "greedy"]),
        "seed": st.integers(0, 2**64 - 1),
        "drop_isolated": st.booleans(),
    },
    optional={"bits": st.integers(0, 20)},
)
cartesian_options = st.fixed_dictionaries(
    {"method": st.just("cartesian"), "drop_isolated": st.booleans()},
    optional={"bits": st.integers(1, 30)},
)
options_of_either = highpass_options | cartesian_options


@given(strategies.surfaces(), options_of_either)
def test_any_surface_with_any_options(mesh: meshes.Arrays, options: dict) -> None:
    assert_round_trip(*mesh, **options)


@strategies.SOME
@given(
    st.sampled_from(sorted(MANIFOLDS)),
    st.sampled_from(["highpass", "cartesian"]),
    st.floats(1e-6, 10),
    st.booleans(),
)
def test_any_step(name: str, method: str, step: float, diffusion: bool) -> None:
    encoded = assert_round_trip(*MANIFOLDS[name], method=method, step=step, diffusion=diffusion)
    parameters = read_container(encoded.data).parameters
    assert parameters.step == step
    assert parameters.bits is None


@pytest.mark.parametrize("name", MANIFOLDS)
@pytest.mark.parametrize("bits", range(1, 31))
def test_cartesian_error_is_at_most_half_a_step(name: str, bits: int) -> None:
    V, F = MANIFOLDS[name]
    encoded = encode_mesh(from_triangles(V, F), Options(method="cartesian", bits=bits))
    step = np.ptp(V, axis=0).max() / (2**bits - 1)
    assert read_container(encoded.data).parameters.step == step
    assert np.abs(encoded.mesh.vertices - V[encoded.order]).max() <= step / 2 + 1e-15 * len(V)


@pytest.mark.parametrize("name", MANIFOLDS)
@pytest.mark.parametrize("bits", [4, 8, 12, 16, 20, 24, 28])
def test_highpass_error_falls_with_bits(name: str, bits: int) -> None:
    V, F = MANIFOLDS[name]
    encoded = encode_mesh(from_triangles(V, F), Options(method="highpass", bits=bits, anchors=4))
    errors = vertex_errors(V[encoded.order], encoded.mesh.vertices, encoded.mesh.faces)
    # From 0.02 on the sphere to 0.5 on the double torus.
    assert errors.rms < 2.0**-bits * diagonal(V)


@pytest.mark.parametrize("anchors", [1, 5, 0.5, 10**9])
@pytest.mark.parametrize("anchor_method", ["farthest", "random", "greedy"])
def test_least_squares_mesh(anchors: float, anchor_method: str) -> None:
    V, F = meshes.torus(12, 9)
    encoded = assert_round_trip(V, F, bits=0, anchors=anchors, anchor_method=anchor_method)
    container = read_container(encoded.data)
    assert container.parameters.step == 0
    assert len(container.sections["DELT"].payload) == 0
    assert container.parameters.anchor_count == {0.5: 54, 10**9: 108}.get(anchors, anchors)


@pytest.mark.parametrize("name", MANIFOLDS)
@pytest.mark.parametrize("bits", [0, 5, 12])
@pytest.mark.parametrize("anchor_method", ["farthest", "random", "greedy"])
def test_positions_are_the_dense_least_squares_solution(
    name: str, bits: int, anchor_method: str
) -> None:
    data = encode(
        *MANIFOLDS[name], method="highpass", bits=bits, anchors=6, anchor_method=anchor_method
    )
    container = read_container(data)
    content = read_content(container, DEFAULT_MAX_VERTICES, DEFAULT_MEMORY)
    surface, integers = content.structure.surface, content.integers
    p, n = container.parameters, surface.vertex_count
    origin = np.array(p.origin)
    expected = oracle.least_squares(
        oracle.laplacian(surface.faces, n),
        integers.anchors,
        integers.values * p.step,
        from_grid(integers.positions, origin, p.anchor_step),
    )
    isolated = from_grid(integers.isolated, origin, p.anchor_step)
    decoded = decode(data).vertices
    atol = TOLERANCE * diagonal(decoded)
    np.testing.assert_allclose(decoded[:n], expected, rtol=0, atol=atol)
    np.testing.assert_allclose(decoded[n:], isolated, rtol=0, atol=0)


@pytest.mark.parametrize("name", MANIFOLDS)
@pytest.mark.parametrize("bits", [0, 8])
def test_solvers_agree(name: str, bits: int) -> None:
    """Whoever encoded and whoever decodes: one mesh, and the same bytes from each encoder."""
    V, F = MANIFOLDS[name]
    # Symmetric shapes err equally at several vertices; a greedy choice hangs on the last digit.
    common = {"method": "highpass", "bits": bits, "anchors": 3, "anchor_method": "farthest"}
    given = [Options(solver=solver, **common) for solver in SOLVERS]
    encoded = [encode_mesh(from_triangles(V, F), options) for options in given]
    for other in encoded:
        assert payloads_of(other.data) == payloads_of(encoded[0].data)
        for solver in SOLVERS:
            assert_decoded(decode(other.data, solver=solver), encoded[0])


def payloads_of(data):
    """The sections without `meta`, whose errors may differ in their last place between solvers."""
    sections = read_container(data).sections.values()
    return {s.id: bytes(s.payload) for s in sections if s.id != "meta"}


@pytest.mark.parametrize("name", MANIFOLDS)
@pytest.mark.parametrize("method", ["highpass", "cartesian"])
def test_errors_in_the_file_are_those_achieved(name: str, method: str) -> None:
    V, F = MANIFOLDS[name]
    encoded = encode_mesh(from_triangles(V, F), Options(method=method, source_format="ply"))
    decoded = decode(encoded.data)
    errors = vertex_errors(V[encoded.order], decoded.vertices, decoded.faces)
    meta = read_container(encoded.data).meta
    assert meta.rms == pytest.approx(errors.rms, rel=1e-5)
    assert meta.max == pytest.approx(errors.max, rel=1e-5)
    assert meta.normal == pytest.approx(errors.normal_deviation, rel=1e-5, abs=1e-5)
    assert meta.dihedral == pytest.approx(errors.dihedral, rel=1e-5, abs=1e-5)
    assert meta.diagonal == pytest.approx(diagonal(V), rel=1e-6)
    assert meta.source == "ply"


# ---- Determinism and threads -------------------------------------------------------------------


@strategies.FEW
@given(strategies.surfaces(), options_of_either)
def test_same_bytes_on_two_runs_and_for_any_threads(mesh: meshes.Arrays, options: dict) -> None:
    first = encode(*mesh, **options)
    assert encode(*mesh, **options) == first
    assert encode(*mesh, threads=1, **options) == first
    assert encode(*mesh, threads=2, **options) == first
    one, two = (decode(first, threads=threads) for threads in (1, 2))
    np.testing.assert_array_equal(one.vertices, two.vertices)


IN_THREADS = """
import hashlib, sys, threading
import meshes
from deltamesh._codec import decode, encode

digests = []

def work(threads):
    data = encode(*meshes.torus(30, 20), anchors=20, anchor_method="greedy", threads=threads)
    mesh = decode(data, threads=threads)
    digests.append(hashlib.sha256(data + mesh.vertices.tobytes()).hexdigest())

for threads in (1, 2, 1, 2):
    thread = threading.Thread(target=work, args=(threads,))
    thread.start()
    thread.join()
work(2)
print(*digests)
"""


def test_several_threads_in_turn_and_another_process() -> None:
    """The first thread loads the solver and ends before the second one solves."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path), "PYTHONHASHSEED": "11"}
    command = [sys.executable, "-W", "error", "-c", IN_THREADS]
    done = children.run(command, env=environment, text=True)
    assert done.returncode == 0, done.stderr
    data = encode(*meshes.torus(30, 20), anchors=20, anchor_method="greedy")
    digest = hashlib.sha256(data + decode(data).vertices.tobytes()).hexdigest()
    assert done.stdout.split() == [digest] * 5


def test_progress_tells_of_stages_and_changes_nothing() -> None:
    V, F = meshes.icosphere(1)
    stages: list[str] = []
    data = encode(V, F, progress=stages.append)
    assert stages
    assert data == encode(V, F)
    count = len(stages)
    decode(data, progress=stages.append)
    assert len(stages) > count
    assert all(isinstance(stage, str) and stage for stage in stages)


# ---- Arrays of every kind ----------------------------------------------------------------------


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


def test_bytes_of_every_kind_decode() -> None:
    data = encode(*meshes.icosphere(1))
    expected = decode(data)
    long = memoryview(b"--" + data + b"--")
    for kind in (bytearray(data), memoryview(data), long[2:-2]):
        decoded = decode(kind)
        np.testing.assert_array_equal(decoded.vertices, expected.vertices)
        np.testing.assert_array_equal(decoded.faces, expected.faces)


def test_decoded_arrays_are_the_callers_own() -> None:
    data = encode(*meshes.icosphere(1), method="cartesian")
    first = decode(data)
    kept = first.vertices.copy()
    first.vertices[:] = 0
    first.faces[:] = 0
    np.testing.assert_array_equal(decode(data).vertices, kept)


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
