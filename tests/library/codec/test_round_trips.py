"""Encoder and decoder as callers see them: round trips, errors, determinism."""

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
from round_trips import TOLERANCE, assert_decoded, assert_round_trip

from deltamesh._codec.decoding import decode
from deltamesh._codec.encoding import encode
from deltamesh._geometry.quantize import from_grid
from deltamesh._limits import DEFAULT_MAX_VERTICES, DEFAULT_MEMORY
from deltamesh._measures.metrics import diagonal, vertex_errors
from deltamesh._options import Options
from deltamesh._pipeline.decoder import read_content
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.polymesh.mesh import from_triangles

MANIFOLDS = {name: mesh for name, mesh in meshes.every().items() if name != "three_pages"}

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
from deltamesh._codec.decoding import decode
from deltamesh._codec.encoding import encode

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
