"""Polygons of more than three corners: from any file, and back as they were."""

from __future__ import annotations

import collections
import contextlib

import forging
import meshes
import numpy as np
import oracle
import polygon_oracle
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from deltamesh import decode, encode, entropy
from deltamesh.codec import encode_mesh
from deltamesh.kernels import coder as coder_kernels
from deltamesh.kernels import diagonals
from deltamesh.kernels import polygons as kernels
from deltamesh.kernels.listed import code_listed
from deltamesh.measures.correspondence import match_polygons
from deltamesh.mesh import Mesh, triangulated
from deltamesh.options import Options
from deltamesh.order import decode_order, encode_order
from deltamesh.reordering import Order, rows_of
from deltamesh.shape.decoding import announced, decode_structure
from deltamesh.shape.diagonals import cut_polygons, middles
from deltamesh.shape.encoding import encode_structure
from deltamesh.shape.gluing import decode_polygons, encode_polygons, glued_halfedges, partners, ways
from deltamesh.shape.polygons import joined
from deltamesh_formats.errors import FormatError
from deltamesh_formats.meshfile import read_mesh
from deltamesh_formats.polymesh import PolyMesh
from deltamesh_formats.reader import read_container
from deltamesh_formats.triangles import fans
from deltamesh_formats.writer import write_varint

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


def mesh_of(V, polygons):
    """A mesh of lists of vertex indices."""
    sizes = [len(p) for p in polygons]
    corners = np.array([v for p in polygons for v in p], dtype=np.int64)
    offsets = np.concatenate(([0], np.cumsum(sizes))).astype(np.int64)
    return PolyMesh(np.asarray(V, dtype=np.float64), corners, offsets)


def lists_of(mesh):
    """The polygons as lists of vertex indices."""
    return [row.tolist() for row in np.split(mesh.corners, mesh.offsets[1:-1])]


def quads(m, n):
    """A curved rectangle of m x n vertices, of quads that begin anywhere."""
    V, _ = meshes.grid(m, n)
    rng = np.random.default_rng(m * n)
    corner = [i * n + j for i in range(m - 1) for j in range(n - 1)]
    polygons = [np.roll([c, c + n, c + n + 1, c + 1], rng.integers(4)).tolist() for c in corner]
    return mesh_of(V, polygons)


def quad_torus(m, n):
    V, F = meshes.torus(m, n)
    lower, upper = np.split(F, 2)
    return mesh_of(V, np.column_stack([lower, upper[:, 2]]).tolist())


def prism(k):
    """Two polygons of k corners, and quads between them."""
    u = 2 * np.pi * np.arange(k) / k
    ring = np.stack([np.cos(u), np.sin(u), 0 * u], axis=1)
    sides = [[i, (i + 1) % k, k + (i + 1) % k, k + i] for i in range(k)]
    ends = [list(range(k))[::-1], list(range(k, 2 * k))]
    return mesh_of(np.concatenate([ring, ring + np.array([0, 0, 1])]), ends + sides)


def moebius(n):
    V, _ = meshes.moebius(n)
    strip = [[2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1] for i in range(n - 1)]
    return mesh_of(V, [*strip, [2 * n - 2, 1, 0, 2 * n - 1]])


def doubled():
    """Each quad twice, turned over, and begun elsewhere: cut along the other diagonal."""
    mesh = quads(5, 4)
    polygons = lists_of(mesh)
    over = [p[::-1] for p in polygons]
    return mesh_of(mesh.vertices, [*polygons, *over, *polygons[:3], *[p[1:] + p[:1] for p in over]])


def tetrahedra():
    """Quads around four points each, through which other quads run, too: edges of many faces."""
    rng = np.random.default_rng(7)
    V = rng.normal(size=(9, 3))
    return mesh_of(V, [rng.permutation(9)[:4].tolist() for _ in range(60)])


def repeated_vertices():
    V = np.random.default_rng(3).normal(size=(7, 3))
    polygons = [[0, 1, 2, 1], [0, 0, 1, 2], [3, 3, 3, 3], [4, 5, 4, 5, 6], [0, 1, 2, 0, 1, 2]]
    return mesh_of(V, [*polygons, *polygons, [1, 2, 1, 0], [6, 5, 3]])


def mixed():
    """Triangles, quads, a pentagon; two pieces; vertices in no face, and at one place."""
    V = np.random.default_rng(5).normal(size=(14, 3))
    V[12] = V[3]
    polygons = [[0, 1, 2, 3], [3, 2, 4], [2, 1, 5, 6, 4], [7, 8, 9, 10], [12, 0, 5]]
    return mesh_of(V, polygons)


MADE = {
    "quads": quads(9, 7),
    "torus": quad_torus(9, 8),
    "prism": prism(7),
    "fan": prism(40),
    "moebius": moebius(9),
    "doubled": doubled(),
    "tetrahedra": tetrahedra(),
    "repeated_vertices": repeated_vertices(),
    "mixed": mixed(),
}


@st.composite
def soups(draw: st.DrawFn) -> PolyMesh:
    """Polygons of any kind: over few vertices, or those of a surface, joined at random."""
    seed = draw(strategies.SMALL)
    rng = np.random.default_rng(seed)
    if draw(st.booleans()):
        n = draw(st.integers(1, 12))
        vertex = st.integers(0, n - 1)
        some = st.lists(st.lists(vertex, min_size=3, max_size=7), min_size=1, max_size=25)
        polygons, V = draw(some), rng.normal(size=(n, 3))
    else:
        V, F = draw(strategies.surfaces())
        polygons = grown(F, draw(st.integers(3, 7)), rng)
    again = [p for p in polygons if rng.random() < draw(st.sampled_from([0.0, 0.2, 1.0]))]
    polygons = [*polygons, *again]
    share = draw(st.sampled_from([0.0, 0.3]))
    polygons = [p[::-1] if rng.random() < share else p for p in polygons]
    polygons = [np.roll(p, rng.integers(len(p))).tolist() for p in polygons]
    if draw(st.booleans()):
        V = rng.integers(0, 3, V.shape).astype(float)
    order = rng.permutation(len(polygons))
    return mesh_of(V, [polygons[i] for i in order])


def grown(F, most, rng):
    """Polygons of up to `most` corners, each of faces that are neighbours."""
    todo = {tuple(f) for f in F.tolist()}
    polygons = []
    while todo:
        polygon = list(todo.pop())
        for face in list(todo):
            if len(polygon) >= most or rng.random() < 0.2:
                break
            shared = [
                (i, face[j - 2])
                for i in range(len(polygon))
                for j in range(3)
                if (polygon[i - 1], polygon[i]) == (face[j], face[j - 1])
            ]
            if shared:
                todo.remove(face)
                polygon.insert(*shared[0])
        polygons.append(polygon)
    return polygons


def canonical(mesh, names=None):
    """The polygons as a multiset, each in the least of its rotations."""
    names = range(len(mesh.vertices)) if names is None else names
    rows = [[names[v] for v in p] for p in lists_of(mesh)]
    return sorted(min(tuple(p[i:] + p[:i]) for i in range(len(p))) for p in rows)


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


@pytest.mark.parametrize("name", REAL)
def test_real_polygons_come_back(name: str) -> None:
    if not (meshes.folder() / name).exists():
        pytest.skip(f"no {name}: DELTAMESH_MESHES names the folder of larger meshes")
    mesh = read_mesh(meshes.folder() / name)
    for keep_order in (False, True):
        encoded = encode_mesh(mesh, Options(method="cartesian", keep_order=keep_order))
        decoded, own = decode(encoded.data), encoded.face_order
        assert sorted(own.tolist()) == list(range(len(mesh.sizes)))
        corners, offsets = rows_of(mesh.offsets, own, encoded.rotation)
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
    container = read_container(data)
    return decode_structure(container, announced(container)).surface


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


def glued_of(mesh):
    """Faces in coding order, their partners, what is glued."""
    cut = cut_polygons(mesh)
    _, structure, origin = encode_structure(
        Mesh(mesh.vertices, cut.faces), False, False, lambda _: None
    )
    return structure, glued_halfedges(cut, origin.corners)


def counts_of(mesh, glued, partner):
    listed = np.count_nonzero((glued >= 0) & (glued != partner)) // 2
    return int(mesh.sizes.min()), int(mesh.sizes.max()), listed


@strategies.FEW
@given(soups() | st.sampled_from([MADE[name] for name in ("tetrahedra", "doubled", "mixed")]))
def test_the_payload_is_that_of_the_oracle(mesh: PolyMesh) -> None:
    if (mesh.sizes == 3).all():
        return
    structure, glued = glued_of(mesh)
    s = structure
    partner = partners(s.faces, s.opposite, s.stitching.turned)
    k = len(s.manifold)
    assert partner.tolist() == polygon_oracle.partners(
        s.faces.tolist(), k, s.opposite.tolist(), s.stitching.turned.tolist()
    )
    least, most, listed = counts_of(mesh, glued, partner)
    payload = encode_polygons(s.faces, partner, glued, mesh.sizes)
    header = b"".join(map(write_varint, (len(mesh.sizes), least, most, listed)))
    twin = polygon_oracle.Gluing(s.faces.tolist(), partner.tolist())
    coder = twin_of(None)
    pairs = {h: int(g) for h, g in enumerate(glued) if g >= 0}
    by_partner = {h: g for h, g in pairs.items() if partner[h] == g}
    twin.code_hidden(coder, by_partner, least, most, listed > 0)
    others = {h: g for h, g in pairs.items() if h not in by_partner}
    assert listed == 0 or twin.code_listed(coder, others, most, listed, below)
    assert twin.glued == pairs
    assert payload == header + coder.finish()
    np.testing.assert_array_equal(decode_polygons(memoryview(payload), s.faces, partner), glued)


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
    structure, _ = glued_of(MADE[name])
    faces, partner, most = structure.faces, structure.partners, least + more
    data = data + bytes([filler]) * 30
    decoder = entropy.decoder(data, kernels.SLOTS, kernels.MIXERS)
    m = len(faces)
    glued, parent, size = np.full(3 * m, -1), np.arange(m), np.full(m, 3)
    corners, count = faces.ravel(), int(faces.max()) + 1
    kernels.code_hidden(
        decoder, corners, count, partner, glued, parent, size, least, most, total > 0
    )
    twin = polygon_oracle.Gluing(faces.tolist(), partner.tolist())
    coder = twin_of(data)
    twin.code_hidden(coder, {}, least, most, total > 0)
    assert twin.glued == {h: g for h, g in enumerate(glued.tolist()) if g >= 0}
    if total:
        none = np.zeros(0, dtype=np.int64)
        found = code_listed(decoder, partner, none, glued, parent, size, most, total, *ways(faces))
        assert found == twin.code_listed(coder, {}, most, total, below)
        assert twin.glued == {h: g for h, g in enumerate(glued.tolist()) if g >= 0}
    assert int(decoder.state[coder_kernels.CODE]) == coder.code
    joined(glued)  # whatever it is, these are polygons


@given(soups())
def test_the_outlines_are_those_of_the_oracle(mesh: PolyMesh) -> None:
    _, glued = glued_of(mesh)
    polygons = joined(glued)
    expected = polygon_oracle.outlines(glued.tolist())
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
    structure, glued = glued_of(mesh)
    faces, polygons, rng = structure.faces, joined(glued), np.random.default_rng(seed)
    n, sizes = int(faces.max()) + 1, np.diff(polygons.offsets)
    vertices, places = rng.permutation(n), rng.permutation(len(sizes))
    if near:  # runs, so that steps are told in all ways
        vertices[n // 2 :].sort()
        places[len(sizes) // 3 :].sort()
    order = Order(vertices, places, rng.integers(0, sizes[places]))
    payload = encode_order(faces, polygons, order)
    decoded = decode_order(memoryview(payload), faces, polygons, n)
    for name in ("vertices", "faces", "turns"):
        np.testing.assert_array_equal(getattr(decoded, name), getattr(order, name))
    # What no encoder has written is an order, too, or refused.
    damaged = bytes([payload[0]]) + rng.bytes(len(payload))
    with contextlib.suppress(FormatError):
        decoded = decode_order(memoryview(damaged), faces, polygons, n)
        assert sorted(decoded.faces.tolist()) == list(range(len(sizes)))
        assert (decoded.turns < sizes[decoded.faces]).all()


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
    assert match_polygons(mesh, mesh_of(mesh.vertices, mesh.faces.tolist())) is not None
    triangles = triangulated(mesh).faces.tolist()
    assert match_polygons(mesh_of(mesh.vertices, triangles), mesh) is not None
