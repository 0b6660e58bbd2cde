"""Polygons of more than three corners: from any file, and back as they were."""

from __future__ import annotations

import collections
import contextlib

import drafts
import forging
import meshes
import numpy as np
import oracle
import polygon_oracle
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st
from polygon_meshes import MADE, canonical, lists_of, mesh_of, quad_torus, quads, soups

from deltamesh import decode, encode
from deltamesh._codec import encode_mesh
from deltamesh._compare.correspondence import match_polygons
from deltamesh._kernels.coding import coder as coder_kernels
from deltamesh._kernels.coding import hidden_edges as kernels
from deltamesh._kernels.coding.merged_pairs import code_explicit_pairs
from deltamesh._kernels.mesh import diagonals
from deltamesh._mesh import triangulated
from deltamesh._options import Options
from deltamesh._order.coding import decode_order, encode_order
from deltamesh._order.reordering import Order, permuted_corners
from deltamesh._pipeline import read_content
from deltamesh._shape.diagonals import cut_polygons, middles
from deltamesh._shape.merge_candidates import merged_halfedges
from deltamesh._shape.merging import decode_merged, encode_merged, halfedge_groups
from deltamesh._shape.polygons import merged_polygons
from deltamesh._streams import entropy
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.container.writer import write_varint
from deltamesh_formats.errors import FormatError
from deltamesh_formats.meshfiles.files import read_mesh
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.polymesh.triangles import fans

METHODS = ("highpass", "refined", "cartesian", "lossless")
REAL = (
    "clean/sword_quad_dominant.obj",
    "clean/cow_ngon.obj",
    "unstated/cube_40k.obj",
    "edge/moebius.obj",
    "edge/dodecahedron_poly.obj",
    "edge/inspired_quads_smooth.off",
    "edge/negative_indices.obj",
    "edge/comments.off",
    "edge/multi.ply",
)


# ---- Meshes ------------------------------------------------------------------------------------


def assert_kept(mesh, encoded, *, keep_order=False):
    decoded = decode(encoded.data)
    np.testing.assert_array_equal(decoded.corners, encoded.mesh.corners)
    np.testing.assert_array_equal(decoded.offsets, encoded.mesh.offsets)
    assert canonical(decoded, encoded.order.tolist()) == canonical(mesh)
    rows, own = lists_of(mesh), encoded.order
    for got, face, turn in zip(
        lists_of(decoded), encoded.face_order, encoded.rotation, strict=True
    ):
        assert own[got].tolist() == rows[face][turn:] + rows[face][:turn]
    if keep_order:
        np.testing.assert_array_equal(decoded.corners, mesh.corners)
        np.testing.assert_array_equal(decoded.offsets, mesh.offsets)
    return decoded


# ---- Whole files -------------------------------------------------------------------------------


@pytest.mark.parametrize("name", MADE)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("keep_order", [False, True])
def test_made_polygons_come_back(name: str, method: str, keep_order: bool) -> None:
    mesh = MADE[name]
    encoded = encode_mesh(mesh, Options(method=method, keep_order=keep_order))
    decoded = assert_kept(mesh, encoded, keep_order=keep_order)
    if method == "lossless":
        np.testing.assert_array_equal(decoded.vertices, mesh.vertices[encoded.order])
    else:
        off = np.abs(decoded.vertices - mesh.vertices[encoded.order]).max()
        assert off < 0.2 * np.ptp(mesh.vertices)


@given(soups(), st.sampled_from(METHODS), st.booleans())
def test_any_polygons_come_back(mesh: PolyMesh, method: str, keep_order: bool) -> None:
    encoded = encode_mesh(mesh, Options(method=method, keep_order=keep_order))
    assert_kept(mesh, encoded, keep_order=keep_order)


@pytest.mark.parametrize("name", meshes.large_are_slow(REAL))
def test_real_polygons_come_back(name: str) -> None:
    if not (meshes.folder() / name).exists():
        pytest.skip(f"no {name}: DELTAMESH_MESHES names the folder of larger meshes")
    mesh = read_mesh(meshes.folder() / name)
    for keep_order in (False, True):
        encoded = encode_mesh(mesh, Options(method="cartesian", keep_order=keep_order))
        decoded, own = decode(encoded.data), encoded.face_order
        assert sorted(own.tolist()) == list(range(len(mesh.sizes)))
        corners, offsets = permuted_corners(mesh.offsets, own, encoded.rotation)
        np.testing.assert_array_equal(decoded.offsets, offsets)
        np.testing.assert_array_equal(encoded.order[decoded.corners], mesh.corners[corners])
        if keep_order:
            np.testing.assert_array_equal(decoded.corners, mesh.corners)
        size = len(read_container(encoded.data).sections["POLY"].payload)
        assert 8 * size <= 0.5 * len(mesh.sizes) + 64


def test_triangles_have_no_polygons() -> None:
    V, F = meshes.torus(9, 7)
    whole = mesh_of(V, F.tolist())
    assert encode(whole, method="cartesian") == encode(V, F, method="cartesian")
    assert "POLY" not in read_container(encode(whole)).sections


def test_a_grid_of_quads_costs_next_to_nothing() -> None:
    """Whichever corners they begin at: parallel diagonals are found."""
    mesh = quads(60, 50)
    sections = read_container(encode(mesh, method="cartesian")).sections
    assert len(sections["CONN"].payload) + len(sections["POLY"].payload) < 60
    first = np.zeros(len(mesh.sizes), dtype=np.int64)
    V, F = mesh.vertices, fans(mesh.corners, mesh.offsets, first).faces
    assert len(read_container(encode(V, F, method="cartesian")).sections["CONN"].payload) > 300


def test_equal_polygons_keep_their_places() -> None:
    """Of triangles that are equal, each stays with its own polygon."""
    V = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 1]])
    polygons = [[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2], [2, 0, 1], [1, 2, 3, 0], [0, 1, 2, 3]]
    mesh = mesh_of(V, polygons)
    encoded = encode_mesh(mesh, Options(method="cartesian", keep_order=True))
    assert_kept(mesh, encoded, keep_order=True)


# ---- The graph ---------------------------------------------------------------------------------


def surface_of_file(data):
    return read_content(read_container(data), 10**9, 2**40).structure.surface


@pytest.mark.parametrize("name", ["quads", "torus", "prism"])
def test_the_laplacian_is_that_of_the_polygons(name: str) -> None:
    mesh = MADE[name]
    encoded = encode_mesh(mesh, Options(method="cartesian"))
    decoded = decode(encoded.data)
    edges = {frozenset((p[i - 1], p[i])) for p in lists_of(decoded) for i in range(len(p))}
    L = np.zeros((len(mesh.vertices),) * 2)
    for a, b in map(tuple, edges):
        L[a, b] = L[b, a] = -1
    np.fill_diagonal(L, -L.sum(axis=1))
    np.testing.assert_array_equal(surface_of_file(encoded.data).laplacian.toarray(), L)


@given(soups())
def test_components_stay_whole(mesh: PolyMesh) -> None:
    """Without hidden edges, the vertices of a face still hang together."""
    surface = surface_of_file(encode(mesh, method="cartesian"))
    labels = surface.labels[surface.faces]
    assert (labels == labels[:, :1]).all()


# ---- Kernels -----------------------------------------------------------------------------------


def twin_of(data):
    tables = coder_kernels.STRETCH, coder_kernels.SQUASH, coder_kernels.RATE
    sums = entropy.INITIAL_WEIGHT_SUM
    return oracle.RangeCoder(tables, kernels.SLOTS, kernels.MIXERS, sums, data)


def below(coder, value, bound):
    """The twin of `code_below`: the fewest bits, or one more."""
    bits = bound.bit_length() - 1
    short = (2 << bits) - bound
    if not coder.decoding:
        coder.raw(value if value < short else value + short, bits + (value >= short))
        return value
    first = coder.raw(0, bits)
    return first if first < short else 2 * first + coder.raw(0, 1) - short


def merged_of(mesh):
    """The structure without its polygons, and the merged half-edges."""
    draft = drafts.before_polygons(mesh)
    corners = draft.triangle_provenance.corners
    return draft.structure, merged_halfedges(draft.input.triangles, corners)


def counts_of(mesh, merged, candidate):
    explicit = np.count_nonzero((merged >= 0) & (merged != candidate)) // 2
    return int(mesh.sizes.min()), int(mesh.sizes.max()), explicit


@strategies.FEW
@given(soups() | st.sampled_from([MADE[name] for name in ("tetrahedra", "doubled", "mixed")]))
def test_the_payload_is_that_of_the_oracle(mesh: PolyMesh) -> None:
    if (mesh.sizes == 3).all():
        return
    s, merged = merged_of(mesh)
    manifold, reversed_ = s.complex.manifold, s.complex.stitches.reversed
    candidate = s.merge_candidates
    assert candidate.tolist() == polygon_oracle.candidates(
        s.faces.tolist(), len(manifold.faces), manifold.opposite.tolist(), reversed_.tolist()
    )
    least, most, explicit = counts_of(mesh, merged, candidate)
    payload = encode_merged(s.faces, candidate, merged, mesh.sizes)
    header = b"".join(map(write_varint, (len(mesh.sizes), least, most, explicit)))
    twin = polygon_oracle.Merging(s.faces.tolist(), candidate.tolist())
    coder = twin_of(None)
    pairs = {h: int(g) for h, g in enumerate(merged) if g >= 0}
    by_candidate = {h: g for h, g in pairs.items() if candidate[h] == g}
    twin.code_hidden(coder, by_candidate, least, most, explicit > 0)
    others = {h: g for h, g in pairs.items() if h not in by_candidate}
    assert explicit == 0 or twin.code_explicit_pairs(coder, others, most, explicit, below)
    assert twin.merged == pairs
    assert payload == header + coder.finish()
    np.testing.assert_array_equal(decode_merged(memoryview(payload), s.faces, candidate), merged)


@strategies.FEW
@given(
    st.sampled_from(sorted(MADE)),
    st.binary(max_size=60),
    st.sampled_from([0x00, 0x55, 0xFF]),
    st.integers(3, 5),
    st.integers(0, 4),
    st.integers(0, 9),
)
def test_any_bytes_are_the_polygons_of_the_oracle(
    name: str, data: bytes, filler: int, least: int, more: int, total: int
) -> None:
    if name in ("quads", "torus"):
        name = "prism"  # the oracle is slow
    structure, _ = merged_of(MADE[name])
    faces, candidate, most = structure.faces, structure.merge_candidates, least + more
    data = data + bytes([filler]) * 30
    decoder = entropy.decoder(data, kernels.SLOTS, kernels.MIXERS)
    m = len(faces)
    merged, parent, size = np.full(3 * m, -1), np.arange(m), np.full(m, 3)
    corners, count = faces.ravel(), int(faces.max()) + 1
    kernels.code_hidden(
        decoder, corners, count, candidate, merged, parent, size, least, most, total > 0
    )
    twin = polygon_oracle.Merging(faces.tolist(), candidate.tolist())
    coder = twin_of(data)
    twin.code_hidden(coder, {}, least, most, total > 0)
    assert twin.merged == {h: g for h, g in enumerate(merged.tolist()) if g >= 0}
    if total:
        none = np.zeros(0, dtype=np.int64)
        groups = halfedge_groups(faces)
        found = code_explicit_pairs(
            decoder, candidate, none, merged, parent, size, most, total, *groups
        )
        assert found == twin.code_explicit_pairs(coder, {}, most, total, below)
        assert twin.merged == {h: g for h, g in enumerate(merged.tolist()) if g >= 0}
    assert int(decoder.state[coder_kernels.CODE]) == coder.code
    merged_polygons(merged)  # whatever it is, these are polygons


@given(soups())
def test_the_outlines_are_those_of_the_oracle(mesh: PolyMesh) -> None:
    _, merged = merged_of(mesh)
    polygons = merged_polygons(merged)
    expected = polygon_oracle.outlines(merged.tolist())
    assert polygons.corners.tolist() == [outside for p in expected for outside, _ in p]
    assert np.diff(polygons.offsets).tolist() == [len(p) for p in expected]
    for at, (_, corner) in enumerate(c for p in expected for c in p):
        assert set(np.flatnonzero(polygons.of_corners == at).tolist()) == corner
    lowest = [min(h // 3 for _, corner in p for h in corner) for p in expected]
    assert polygons.lowest.tolist() == lowest == sorted(lowest)


@given(st.lists(st.tuples(st.integers(0, 11), st.integers(0, 11), st.integers(0, 1)), max_size=40))
def test_diagonals_are_those_of_the_oracle(pairs: list[tuple[int, int, int]]) -> None:
    near = collections.defaultdict(list)
    for a, b, unlike in pairs:
        near[a].append((b, unlike))
    given_ = [-1, 1, 0, -1, -1, -1, 1, -1, -1, -1, -1, 0]
    rows = [near[q] for q in range(12)]
    start = np.cumsum([0] + [len(row) for row in rows])
    flat = np.array([edge for row in rows for edge in row], dtype=np.int64).reshape(-1, 2)
    cut = np.array(given_)
    diagonals.choose(start, flat[:, 0].copy(), flat[:, 1].copy(), cut)
    assert cut.tolist() == polygon_oracle.choose(rows, given_)


def fan(corners: list[int], middle: int) -> list[tuple[int, int, int]]:
    turned = corners[middle:] + corners[:middle]
    return [(turned[0], turned[i], turned[i + 1]) for i in range(1, len(corners) - 1)]


def slow_fans(mesh: PolyMesh) -> list[tuple[int, int, int]]:
    """Polygon by polygon, the fans of all its corners one after the other."""
    found = []
    for begin, end in zip(mesh.offsets[:-1], mesh.offsets[1:], strict=True):
        corners = mesh.corners[begin:end].tolist()

        def score(middle: int, corners: list[int] = corners) -> float:
            V = mesh.vertices
            faces = fan(corners, middle)
            normals = [np.cross(V[b] - V[a], V[c] - V[a]) for a, b, c in faces]
            return min(float(n @ np.sum(normals, axis=0)) for n in normals)

        scores = [score(i) for i in range(len(corners))]
        middle = 0 if scores[0] > 0 or len(corners) > 16 else int(np.argmax(scores))
        found += fan(corners, middle)
    return found


@given(st.data(), st.integers(0, 10**6))
def test_fans_are_the_slow_ones(data: st.DataObject, seed: int) -> None:
    """On a grid of whole numbers, where sums are exact and ties are ties."""
    rng = np.random.default_rng(seed)
    sizes = data.draw(st.lists(st.integers(3, 20), min_size=1, max_size=6))
    vertices = rng.integers(-4, 5, size=(12, 3)).astype(float)
    offsets = np.concatenate(([0], np.cumsum(sizes)))
    mesh = PolyMesh(vertices, rng.integers(0, 12, size=sum(sizes)), offsets)
    around = middles(mesh.vertices, mesh.corners, mesh.offsets)
    cut = fans(mesh.corners, mesh.offsets, around)
    assert list(map(tuple, cut.faces.tolist())) == slow_fans(mesh)


def test_diagonals_of_a_grid_run_in_parallel() -> None:
    mesh = quad_torus(8, 6)
    faces = cut_polygons(mesh).faces
    assert (np.bincount(faces.ravel()) == 6).all()


@given(soups(), strategies.SMALL, st.booleans())
def test_any_order_of_any_polygons(mesh: PolyMesh, seed: int, near: bool) -> None:
    structure, merged = merged_of(mesh)
    faces, polygons, rng = structure.faces, merged_polygons(merged), np.random.default_rng(seed)
    n, sizes = int(faces.max()) + 1, np.diff(polygons.offsets)
    vertices, places = rng.permutation(n), rng.permutation(len(sizes))
    if near:  # runs, so that steps of all kinds come up
        vertices[n // 2 :].sort()
        places[len(sizes) // 3 :].sort()
    order = Order(vertices, places, rng.integers(0, sizes[places]))
    payload = encode_order(faces, polygons, order)
    decoded = decode_order(memoryview(payload), faces, polygons, n)
    for name in ("vertices", "polygons", "rotations"):
        np.testing.assert_array_equal(getattr(decoded, name), getattr(order, name))
    # What no encoder has written is an order, too, or refused.
    damaged = bytes([payload[0]]) + rng.bytes(len(payload))
    with contextlib.suppress(FormatError):
        decoded = decode_order(memoryview(damaged), faces, polygons, n)
        assert sorted(decoded.polygons.tolist()) == list(range(len(sizes)))
        assert (decoded.rotations < sizes[decoded.polygons]).all()


# ---- Files that no encoder has written -----------------------------------------------------------


@pytest.mark.parametrize("name", ["torus", "prism", "tetrahedra", "mixed"])
def test_a_flipped_bit_is_refused_or_another_mesh(name: str) -> None:
    """With all checksums right: whatever is decoded are polygons of the triangles."""
    data = encode(MADE[name], method="cartesian")
    payload = bytes(read_container(data).sections["POLY"].payload)
    refused = 0
    for at in range(8 * len(payload)):
        damaged = bytearray(payload)
        damaged[at // 8] ^= 1 << at % 8
        forged = forging.forged(data, POLY=bytes(damaged))
        with pytest.raises(FormatError):  # the digest, if nothing else
            decode(forged)
        try:
            consistent = forging.consistent(forged)
        except FormatError:
            refused += 1
        else:
            assert (decode(consistent).sizes - 2).sum() == (MADE[name].sizes - 2).sum()
    assert refused


@pytest.mark.parametrize(
    "counts",
    [
        (0, 4, 4, 0),
        (144, 3, 3, 0),  # as many as triangles
        (71, 4, 4, 0),
        (72, 2, 4, 0),
        (72, 5, 4, 0),
        (72, 4, 1 << 40, 0),
        (72, 4, 4, 73),
        (72, 4, 4, 1),
        (72, 3, 4, 0),
        (72, 4, 5, 0),
    ],
)
def test_counts_that_are_wrong_are_refused(counts: tuple[int, ...]) -> None:
    data = encode(MADE["torus"], method="cartesian")
    payload = bytes(read_container(data).sections["POLY"].payload)
    header = b"".join(map(write_varint, counts))
    assert payload[:4] == bytes([72, 4, 4, 0])
    with pytest.raises(FormatError, match="POLY"):
        decode(forging.forged(data, POLY=header + payload[4:]))


def test_polygons_of_nothing_are_refused() -> None:
    V, F = meshes.torus(9, 8)
    data = encode(V, F, method="cartesian")
    with pytest.raises(FormatError, match="POLY"):
        decode(forging.forged(data, POLY=b"".join(map(write_varint, (len(F), 3, 3, 0)))))


# ---- Correspondence -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["quads", "torus", "prism", "moebius"])
def test_polygons_correspond_wherever_they_begin(name: str) -> None:
    mesh = MADE[name]
    rng = np.random.default_rng(1)
    to = rng.permutation(len(mesh.vertices))
    polygons = [np.roll(to[p], rng.integers(len(p))).tolist() for p in lists_of(mesh)]
    polygons = [polygons[i] for i in rng.permutation(len(polygons))]
    other = mesh_of(mesh.vertices[np.argsort(to)] + 1e-4, polygons)
    found = match_polygons(mesh, other)
    assert found is not None
    assert canonical(mesh, found.tolist()) == canonical(other)
    assert match_polygons(mesh, mesh_of(mesh.vertices, mesh.triangles.tolist())) is not None
    triangles = triangulated(mesh).faces.tolist()
    assert match_polygons(mesh_of(mesh.vertices, triangles), mesh) is not None
