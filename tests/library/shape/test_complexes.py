"""Triangles of any kind: cut into a manifold, and back from a file as they were."""

from __future__ import annotations

import forging
import meshes
import numpy as np
import pytest
import spec_decoder
import strategies
from graphs import points_of, tolerances_of
from hypothesis import given
from hypothesis import strategies as st

from deltamesh import decode, encode
from deltamesh._graph.halfedges import pair_halfedges, weld
from deltamesh._options import Options
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh._shape.complexes import cut, distinct_faces
from deltamesh._shape.manifold import REVERSED
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import from_triangles

CLEAN = {name: mesh for name, mesh in meshes.every().items() if name != "three_pages"}
COMPLEXES = meshes.complexes()
METHODS = ("highpass", "refined", "cartesian")


# ---- Cutting -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CLEAN)
def test_a_manifold_stays_as_it_is(name):
    V, F = CLEAN[name]
    manifold = cut(F, len(V))
    assert (manifold.points[manifold.faces] == F).all()
    assert len(manifold.points) == len(np.unique(F))
    assert not manifold.reversed.any()
    assert (manifold.triangles == np.arange(len(F))).all()
    assert (manifold.opposite == pair_halfedges(F)).all()


def assert_cut(F, n):
    """Cut, and compare with what defines a manifold, slowly."""
    manifold = cut(F, n)
    faces = [tuple(face) for face in manifold.faces.tolist()]
    assert len({v for face in faces for v in face}) == len(manifold.points)
    assert not faces or strategies.is_manifold(faces)
    # No two edges between the same two vertices.
    assert (pair_halfedges(manifold.faces) == manifold.opposite).all()
    back = manifold.points[manifold.faces]
    back = np.where(manifold.reversed[:, None], back[:, REVERSED], back)
    assert (back == F[manifold.triangles]).all()
    parts = manifold.triangles, manifold.repeats, manifold.degenerate
    assert sorted(np.concatenate(parts).tolist()) == list(range(len(F)))
    assert all(len(set(F[f])) < 3 for f in manifold.degenerate)
    for f, base, against in zip(manifold.repeats, manifold.repeated, manifold.against, strict=True):
        other = F[manifold.triangles[base]]
        other = other[REVERSED] if against else other
        assert strategies.canonical(F[[f]]) == strategies.canonical(other[None])
    return manifold


@pytest.mark.parametrize("name", COMPLEXES)
def test_made_complexes_are_cut(name):
    assert_cut(*points_of(*COMPLEXES[name]))


@given(strategies.complexes())
def test_any_complex_is_cut(mesh):
    assert_cut(*points_of(*mesh))


def test_no_more_is_cut_than_has_to_be():
    counts = {}
    for name in ("moebius", "hourglass", "bow_tie", "crossing", "mixed_winding", "doubled"):
        F, n = points_of(*COMPLEXES[name])
        manifold = cut(F, n)
        counts[name] = len(manifold.points) - n, int(manifold.reversed.sum())
    assert counts == {
        "moebius": (2, counts["moebius"][1]),  # one edge, somewhere
        "hourglass": (1, 0),
        "bow_tie": (1, 0),
        "crossing": (5, 0),  # two sheets, of which each keeps the line
        "mixed_winding": (0, counts["mixed_winding"][1]),
        "doubled": (0, 0),
    }
    F = COMPLEXES["mixed_winding"][1]
    wrong = (strategies.canonical(F) != np.array(strategies.canonical(meshes.torus(8, 6)[1]))).any()
    assert wrong
    assert 2 * counts["mixed_winding"][1] <= len(F)


def test_distinct_faces():
    V, F = meshes.doubled()
    faces = np.concatenate((F, [[1, 2, 1]]))
    assert (faces[distinct_faces(faces)] == meshes.grid(5, 4)[1]).all()
    assert len(V) == 20


# ---- Round trips -------------------------------------------------------------------------------


def assert_exact(V, F, **options):
    """Encode and decode; vertices, faces and windings come back, those of equal ones included."""
    encoded = encode_mesh(from_triangles(V.copy(), F.copy()), Options(**options))
    decoded = decode(encoded.data)
    assert (decoded.faces == encoded.mesh.faces).all()
    corner = (encoded.rotation[:, None] + np.arange(3)) % 3
    assert sorted(encoded.face_order.tolist()) == list(range(len(F)))
    assert (encoded.order[decoded.faces] == F[encoded.face_order[:, None], corner]).all()
    kept = np.unique(F) if options.get("drop_isolated") else np.arange(len(V))
    assert sorted(encoded.order.tolist()) == kept.tolist()
    container = read_container(encoded.data)
    assert (container.vertices, container.triangles) == (len(kept), len(F))
    # Vertices at one position stay at one position.
    _, place = weld(V[encoded.order])
    first = np.unique(place, return_index=True)[1]
    assert (decoded.vertices == decoded.vertices[first[place]]).all()
    if options["method"] == "cartesian":
        error = np.abs(decoded.vertices - V[encoded.order]).max()
        assert error <= container.parameters.step / 2 * (1 + 1e-9)
    return encoded


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", COMPLEXES)
def test_made_complexes_come_back(name, method):
    encoded = assert_exact(*COMPLEXES[name], method=method)
    assert_exact(*COMPLEXES[name], method=method, drop_isolated=True)
    for solver in ("rslab", "scipy"):
        other = decode(encoded.data, solver=solver)
        assert np.abs(other.vertices - encoded.mesh.vertices).max() <= 1e-9 * 20


@given(strategies.complexes(), st.booleans())
def test_any_complex_comes_back(mesh, drop_isolated):
    assert_exact(*mesh, method="cartesian", drop_isolated=drop_isolated)


@strategies.FEW
@given(strategies.complexes(), st.sampled_from(["highpass", "refined"]))
def test_any_complex_comes_back_by_differential_coordinates(mesh, method):
    assert_exact(*mesh, method=method, anchor_method="greedy", bits=5)


@strategies.FEW
@given(strategies.complexes(), st.sampled_from(METHODS))
def test_any_complex_is_decoded_from_the_specification(mesh, method):
    data = encode(*mesh, method=method)
    vertices, faces, _ = spec_decoder.decode(data)
    mesh = decode(data)
    assert (faces == mesh.faces).all()
    assert (np.abs(vertices - mesh.vertices) <= tolerances_of(data, mesh)).all()


@pytest.mark.parametrize("name", CLEAN)
def test_what_needs_no_stitches_has_none(name):
    for method in METHODS:
        sections = read_container(encode(*CLEAN[name], method=method)).sections
        assert "STCH" not in sections
        assert "COPY" not in sections


@pytest.mark.parametrize(
    ("mesh", "section", "most"),
    [
        (meshes.union(*[meshes.grid(40, 40)] * 1), "STCH", 0),
        (meshes.soup(), "COPY", 18),
        ((meshes.grid(40, 40)[0], np.repeat(meshes.grid(40, 40)[1], 2, axis=0)), "STCH", 24),
    ],
    ids=["manifold", "soup", "doubled"],
)
def test_what_is_regular_costs_next_to_nothing(mesh, section, most):
    found = read_container(encode(*mesh)).sections.get(section)
    assert (len(found.payload) if found else 0) <= most


def test_a_seam_goes_on():
    """A closed seam costs less than 3 bits a vertex, one of random places more."""
    V, F = meshes.torus(40, 30)
    side = (V[F].mean(axis=1)[:, 1] > 0).astype(np.int64)
    sizes = []
    for part in (side, np.random.default_rng(1).permutation(side)):
        keys, number = np.unique(2 * F + part[:, None], return_inverse=True)
        data = encode(V[keys // 2], number.reshape(-1, 3))
        seam = len(keys) - len(V)
        sizes.append(8 * len(read_container(data).sections["COPY"].payload) / seam)
    assert sizes[0] < 5 < 2 * sizes[1]


def test_time_does_not_grow_with_the_square():
    """A point of very many fans, an edge of very many faces, a face of very many repeats."""
    n = 3000
    i = np.arange(n)
    fans = np.stack((0 * i, 1 + 2 * i, 2 + 2 * i), axis=1)
    pages = np.stack((0 * i, 0 * i + 1, 2 + i), axis=1)
    V = np.random.default_rng(4).normal(size=(2 * n + 1, 3))
    for F in (fans, pages, np.tile(fans[:1], (n, 1)), np.tile([[0, 0, 1]], (n, 1))):
        assert_exact(V, F, method="cartesian")
    assert_exact(
        np.repeat(V[:1], 3 * n, axis=0), np.arange(3 * n).reshape(-1, 3), method="cartesian"
    )
    copies = np.concatenate((V[:1].repeat(n, axis=0), V[1 : 2 * n + 1]))
    fans = np.stack((i, n + 2 * i, n + 2 * i + 1), axis=1)
    assert_exact(copies, fans, method="cartesian")


# ---- What no encoder has written ---------------------------------------------------------------


def stitched():
    V, F = meshes.union(meshes.crossing(), meshes.with_degenerate(), meshes.doubled())
    return encode(V, F, method="cartesian")


@pytest.mark.parametrize(
    "counts",
    [(0, 0, 0, 0), (2**40, 2**40, 0, 0), (10**6, 40, 0, 0), (30, 40, 2, 0), (30, 40, 0, 2**60)],
)
def test_counts_of_the_stitching(counts):
    payload = b"".join(map(write_varint, counts))
    with pytest.raises(FormatError):
        decode(forging.forged(stitched(), STCH=payload))


@pytest.mark.parametrize("counts", [(0, 0), (10**6, 0), (2**60, 2**60), (60, 2**40), (75, 60)])
def test_counts_of_the_copies(counts):
    data = encode(*meshes.seams(), method="cartesian")
    payload = b"".join(map(write_varint, counts))
    with pytest.raises(FormatError):
        decode(forging.forged(data, COPY=payload))


def test_sections_that_say_nothing_are_refused():
    data = encode(*meshes.torus(5, 4), method="cartesian")
    n, m = 20, 40
    stitching = b"".join(map(write_varint, (n, m, 0, 0)))
    copies = b"".join(map(write_varint, (n, 0)))
    for payloads in ({"STCH": stitching}, {"COPY": copies}):
        with pytest.raises(FormatError):
            decode(forging.forged(data, **payloads))


def test_counts_that_no_stream_can_hold():
    data = stitched()
    with pytest.raises(FormatError, match="do not fit"):
        decode(forging.forged(data, triangles=2**39))
    data = encode(*meshes.seams(), method="cartesian")
    with pytest.raises(FormatError, match="do not fit"):
        decode(forging.forged(data, vertices=2**31))
