"""Attributes: any numbers of vertices, corners and faces come back where they were."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import forging
import meshes
import numpy as np
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps

from deltamesh import decode, encode
from deltamesh._attributes import owners
from deltamesh._attributes.candidates import AttributeSettings, candidate_codings
from deltamesh._attributes.wedges import encode_wedges
from deltamesh._options import Options
from deltamesh._pipeline.encoder import Encoded, encode_mesh
from deltamesh_formats.container import payload_layout
from deltamesh_formats.container.attribute_entry import Entry
from deltamesh_formats.container.attribute_table import read_table
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import FormatError, MeshError, OptionError
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh, from_triangles

WIDTHS = (0, 1, 2, 3, 4, 16)
TYPES = tuple(map(np.dtype, payload_layout.TYPES))
DOMAINS = ("vertex", "corner", "face")
SETTINGS = AttributeSettings(12, 10, lossless=False, positions=np.zeros((0, 3)), tolerance=0.0)


def counts_of(mesh: PolyMesh) -> dict[str, int]:
    return {"vertex": len(mesh.vertices), "corner": len(mesh.corners), "face": len(mesh.sizes)}


def entries_of(data: bytes) -> tuple[Entry, ...]:
    return read_table(read_container(data).sections["ATTR"].payload)[0]


def sources_of(one: Encoded, domain: str) -> np.ndarray:
    """The input's vertex, corner or face at each of those of the file; of triangles."""
    if domain == "corner":
        turned = (one.rotation[:, None] + np.arange(3)) % 3
        return (3 * one.face_order[:, None] + turned).ravel()
    return one.order if domain == "vertex" else one.face_order


def assert_same(given: Attribute, found: Attribute, sources: np.ndarray) -> None:
    """Everything is as it was, bit for bit."""
    assert_described(given, found)
    rows, others = given.rows()[sources], found.rows()
    assert ((rows < 0) == (others < 0)).all()
    has = rows >= 0
    wanted = given.values.astype(given.values.dtype.newbyteorder("="))[rows[has]]
    assert wanted.tobytes() == found.values[others[has]].tobytes()


def assert_described(given: Attribute, found: Attribute) -> None:
    for name in ("name", "domain", "role", "normalized", "width"):
        assert getattr(given, name) == getattr(found, name)
    assert found.values.dtype == given.values.dtype.newbyteorder("=")


@st.composite
def attributes(draw: st.DrawFn, counts: dict[str, int]) -> Attribute:
    """Any numbers: few different ones or many, with or without an index, gaps in it."""
    domain = draw(st.sampled_from(DOMAINS))
    dtype = draw(st.sampled_from(TYPES))
    if draw(st.booleans()):
        dtype = dtype.newbyteorder(">")
    width, count = draw(st.sampled_from(WIDTHS)), counts[domain]
    rows = draw(st.integers(1, 5))
    bits = draw(nps.arrays(np.uint8, (rows, width * dtype.itemsize)))
    if draw(st.booleans()):
        bits = np.random.default_rng(draw(strategies.SMALL)).integers(
            0, 256, bits.shape, dtype=np.uint8
        )
    values = np.ascontiguousarray(bits).view(dtype) if width else np.zeros((rows, 0), dtype)
    if dtype.kind == "b":
        values = (bits > 127).view(dtype)
    low = draw(st.sampled_from([-1, 0]))
    index = np.random.default_rng(draw(strategies.SMALL)).integers(low, rows, count)
    if draw(st.booleans()):
        values, index = values[np.maximum(index, 0)], None
    name = draw(st.sampled_from(["", "uv", "normal", "a\x00\n b", "\N{SNOWMAN}"]))
    role = draw(st.sampled_from(["normal", "uv", "colour", "other"]))
    return Attribute(name, domain, values, role, index, draw(st.booleans()))


@st.composite
def wholes(draw: st.DrawFn) -> PolyMesh:
    """Triangles of any kind, with attributes of any kind."""
    mesh = from_triangles(*draw(strategies.complexes()))
    counts = counts_of(mesh)
    return replace(mesh, attributes=tuple(draw(st.lists(attributes(counts), max_size=4))))


METHODS = st.sampled_from(["lossless", "cartesian", "highpass"])


@strategies.SOME
@given(wholes(), st.booleans())
def test_any_attributes_of_any_complex_come_back(mesh: PolyMesh, keep_order: bool) -> None:
    one = encode_mesh(mesh, Options(method="lossless", keep_order=keep_order, threads=1))
    decoded = decode(one.data)
    assert len(decoded.attributes) == len(mesh.attributes)
    for given_, found, told in zip(
        mesh.attributes, decoded.attributes, one.mesh.attributes, strict=True
    ):
        assert_same(given_, found, sources_of(one, given_.domain))
        assert_same(told, found, np.arange(counts_of(decoded)[told.domain]))


@st.composite
def polygons(draw: st.DrawFn) -> PolyMesh:
    """Grids of quads, or polygons of any vertices, with attributes of any kind."""
    rng = np.random.default_rng(draw(strategies.SMALL))
    if draw(st.booleans()):
        n = draw(st.integers(3, 14))
        sizes = draw(st.lists(st.integers(3, 6), min_size=1, max_size=12))
        V, corners = rng.normal(size=(n, 3)), rng.integers(0, n, sum(sizes))
    else:
        k = draw(st.integers(2, 5))
        V = np.stack([*np.divmod(np.arange(k * k), k), rng.normal(size=k * k) / 9], axis=1)
        first = (np.arange(k - 1)[:, None] * k + np.arange(k - 1)).ravel()
        corners = (first[:, None] + [0, 1, k + 1, k]).ravel()
        sizes = [4] * len(first)
    mesh = PolyMesh(V, corners, np.concatenate(([0], np.cumsum(sizes))))
    some = st.lists(attributes(counts_of(mesh)), min_size=1, max_size=4)
    return replace(mesh, attributes=tuple(draw(some)))


@strategies.SOME
@given(polygons(), st.booleans())
def test_any_attributes_of_polygons_come_back(mesh: PolyMesh, keep_order: bool) -> None:
    one = encode_mesh(mesh, Options(method="lossless", keep_order=keep_order, threads=1))
    decoded = decode(one.data)
    rows = zip(one.face_order, one.rotation, strict=True)
    corners = [mesh.offsets[f] + (r + np.arange(k)) % k for f, r in rows for k in [mesh.sizes[f]]]
    sources = {"vertex": one.order, "corner": np.concatenate(corners), "face": one.face_order}
    assert (mesh.corners[sources["corner"]] == one.order[decoded.corners]).all()
    for given_, found in zip(mesh.attributes, decoded.attributes, strict=True):
        assert_same(given_, found, sources[given_.domain])


# ---- What may lose something -------------------------------------------------------------------


def with_attributes(mesh: PolyMesh, *attributes: Attribute) -> PolyMesh:
    return replace(mesh, attributes=attributes)


def sphere(*attributes: Attribute) -> PolyMesh:
    return with_attributes(from_triangles(*meshes.icosphere(2)), *attributes)


def charts(bits: int) -> Attribute:
    """Texture coordinates of a sphere, of each half its own, so that a seam runs around it."""
    V, F = meshes.icosphere(2)
    upper = np.repeat(V[F].mean(axis=1)[:, 2] > 0, 3)
    values = V[F.ravel(), :2] * [1.0, -3.0] + np.where(upper[:, None], [5.0, 7.0], 0.0)
    return Attribute(f"uv{bits}", "corner", values.astype(np.float32), "uv")


@pytest.mark.parametrize("bits", [1, 8, 12, 20, 29])
@pytest.mark.parametrize("dtype", ["f2", "f4", "f8"])
def test_texture_coordinates_keep_their_bound(bits: int, dtype: str) -> None:
    uv = charts(bits)
    uv = replace(uv, values=uv.values.astype(dtype))
    one = encode_mesh(sphere(uv), Options(method="cartesian", bits_uv=bits))
    found, entry = decode(one.data).attributes[0], entries_of(one.data)[0]
    wanted = uv.values[sources_of(one, "corner")].astype(float)
    errors = np.abs(found.dense().astype(float) - wanted)
    step = np.ptp(uv.values.astype(float), axis=0).max() / (2**bits - 1)
    assert errors.max() <= 0.51 * step
    assert errors.max() == entry.error
    assert_described(uv, found)


@pytest.mark.parametrize("method", ["highpass", "refined", "cartesian", "lossless"])
def test_both_sides_of_a_seam_are_at_one_place(method: str) -> None:
    mesh = sphere(charts(12))
    one = encode_mesh(mesh, Options(method=method))
    decoded = decode(one.data)
    assert len(decoded.vertices) == len(mesh.vertices)
    assert (decoded.corners == one.mesh.corners).all()
    rows = decoded.attributes[0].rows()
    seam = len(np.unique(rows)) - len(decoded.vertices)
    assert 0 < seam < len(decoded.vertices)  # some vertices have two rows


def test_a_seam_costs_little_more_than_its_bits() -> None:
    """As many rows as vertices and seams need, not one a corner."""
    data = encode_mesh(sphere(charts(12)), Options(method="cartesian")).data
    assert len(decode(data).attributes[0].values) < 1.5 * len(meshes.icosphere(2)[0])


def test_attributes_with_the_same_seams_share_them() -> None:
    uv = charts(12)
    normals = np.where(uv.values[:, :1] > 3, [[0.0, 0, 1]], [[0.0, 0, -1]])
    other = Attribute("normal", "corner", normals + 0.0, "normal")
    mixed = Attribute("both", "corner", np.hstack([uv.values, uv.values]), "other")
    data = encode_mesh(sphere(uv, other, mixed), Options(method="cartesian")).data
    assert [entry.wedges for entry in entries_of(data)] == [0, 1, 2]


def test_wedges_are_coded_once_for_all_codings_of_an_attribute(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    coded: list[np.ndarray] = []

    def counted(structure: Any, polygons: Any, rows: np.ndarray) -> tuple[bytes, np.ndarray]:
        coded.append(rows)
        return encode_wedges(structure, polygons, rows)

    monkeypatch.setattr(owners, "encode_wedges", counted)
    mesh = from_triangles(*meshes.torus(8, 6))
    jump = np.repeat(np.arange(len(mesh.sizes)) % 3 == 0, 3)[:, None]
    levels = (mesh.corners[:, None] * [1, 2, 3] + 7 * jump) % 256
    colours = Attribute("colour", "corner", (levels / 255).astype(np.float32), "colour")
    assert len(list(candidate_codings(colours, colours.values, SETTINGS))) == 3
    data = encode(replace(mesh, attributes=(colours,)), method="cartesian")
    assert len(coded) == 1
    assert entries_of(data)[0].wedges == payload_layout.OWN_WEDGES
    # A grid that makes rows equal has other wedges.
    near = np.array([[0, 0], [1, 1], [1 + 1e-6, 1]], dtype=np.float64)
    uv = Attribute("uv", "corner", near[(mesh.corners + jump[:, 0]) % 3], "uv")
    encode(replace(mesh, attributes=(uv,)), method="cartesian", bits_uv=8)
    assert len(coded) == 3
    assert len(np.unique(coded[1])) == 3
    assert len(np.unique(coded[2])) == 2


def test_corners_that_are_alike_in_each_face_are_coded_by_faces() -> None:
    V, F = meshes.icosphere(2)
    normals = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    index = np.repeat(np.arange(len(F)), 3)
    flat = Attribute("normal", "corner", normals, "normal", index)
    one = encode_mesh(sphere(flat), Options(method="cartesian", bits=16))
    (entry,) = entries_of(one.data)
    assert entry.coding == "octahedral"
    assert entry.wedges == 1
    assert entry.size < len(F) / 8  # they are those of the surface
    found = decode(one.data).attributes[0].dense()
    assert np.abs(found - flat.dense()[sources_of(one, "corner")]).max() < 0.005


@pytest.mark.parametrize("method", ["highpass", "refined", "cartesian"])
@pytest.mark.parametrize("bits", [4, 10, 16])
@pytest.mark.parametrize("domain", DOMAINS)
def test_unit_normals_keep_their_bound(method: str, bits: int, domain: str) -> None:
    rng = np.random.default_rng(bits)
    mesh = from_triangles(*meshes.torus(12, 9))
    normals = rng.normal(size=(counts_of(mesh)[domain], 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals[::7] = 0.0
    given_ = Attribute("normal", domain, normals.astype(np.float32), "normal")
    one = encode_mesh(with_attributes(mesh, given_), Options(method=method, bits_normal=bits))
    (entry,) = entries_of(one.data)
    assert (entry.coding, entry.bits) == ("octahedral", bits)
    found = decode(one.data).attributes[0].dense().astype(float)
    wanted = normals[sources_of(one, domain)]
    zero = ~wanted.any(axis=1)
    assert not found[zero].any()
    angle = np.arccos(np.clip((found * wanted).sum(axis=1)[~zero], -1, 1))
    assert angle.max() <= np.sqrt(2) / (2 ** (bits - 1) - 1) + 1e-3
    assert abs(np.degrees(angle.max()) - entry.error) < 0.05


def test_normals_that_some_corners_lack() -> None:
    V, F = meshes.icosphere(2)
    index = np.where(np.repeat(V[F].mean(axis=1)[:, 2] > 0, 3), F.ravel(), -1)
    given_ = Attribute("normal", "corner", V, "normal", index)
    one = encode_mesh(sphere(given_), Options(method="refined"))
    (entry,) = entries_of(one.data)
    assert entry.coding == "octahedral"
    assert entry.partly
    found, sources = decode(one.data).attributes[0], sources_of(one, "corner")
    assert ((found.rows() < 0) == (index[sources] < 0)).all()
    has = found.rows() >= 0
    assert np.abs(found.dense()[has] - given_.dense()[sources][has]).max() < 0.005


def test_colours_of_floats_get_256_levels() -> None:
    rng = np.random.default_rng(0)
    n = len(meshes.icosphere(2)[0])
    levels = rng.integers(0, 256, (n, 3)) / 255
    for dtype in ("f4", "f8"):
        of_bytes = Attribute("colour", "vertex", levels.astype(dtype), "colour")
        one = encode_mesh(sphere(of_bytes), Options(method="lossless"))
        assert_same(of_bytes, decode(one.data).attributes[0], one.order)
        assert entries_of(one.data)[0].coding == "grid"  # nothing is lost, and they are small
    others = Attribute("colour", "vertex", rng.random((n, 3)), "colour")
    one = encode_mesh(sphere(others), Options(method="cartesian"))
    errors = np.abs(decode(one.data).attributes[0].values - others.values[one.order])
    assert 0 < errors.max() <= 0.5001 / 255


def test_colours_are_smaller_than_their_entropy_when_they_are_smooth() -> None:
    V, _ = meshes.icosphere(2)
    grey = np.rint(127 * (V + 1)).astype(np.uint8)
    data = encode_mesh(sphere(Attribute("colour", "vertex", grey, "colour")), Options()).data
    assert entries_of(data)[0].size < 0.7 * grey.size


@pytest.mark.parametrize("what", ["method", "option"])
def test_nothing_is_lost_if_it_must_not_be(what: str) -> None:
    V, _ = meshes.icosphere(2)
    given_ = (
        replace(charts(12), name="uv"),
        Attribute("normal", "vertex", V, "normal"),
        Attribute("colour", "vertex", (V + 1) / 2, "colour"),
    )
    lossless = Options(method="lossless")
    options = lossless if what == "method" else Options(lossless_attributes=True)
    one = encode_mesh(sphere(*given_), options)
    for given__, found in zip(given_, decode(one.data).attributes, strict=True):
        assert_same(given__, found, sources_of(one, given__.domain))
    assert all(entry.error == 0 for entry in entries_of(one.data))


def test_others_lose_nothing_whatever_the_method() -> None:
    V, _ = meshes.icosphere(2)
    curvature = Attribute("curvature", "vertex", V[:, :1] ** 3)
    one = encode_mesh(sphere(curvature), Options())
    assert_same(curvature, decode(one.data).attributes[0], one.order)


# ---- Whole numbers -----------------------------------------------------------------------------

EXTREMES = [
    np.array([[0], [2**64 - 1]], dtype=np.uint64),
    np.array([[-(2**63)], [2**63 - 1]], dtype=np.int64),
    np.array([[-(2**31)], [2**31 - 1]], dtype=np.int32),
    np.array([[2**63], [2**63 + 5]], dtype=np.uint64),
    np.array([[-5], [-3]], dtype=np.int64),
    np.array([[False], [True]]),
    np.array([[np.nan, -np.inf], [-0.0, np.inf]]),
    np.array([[np.nan], [-0.0]], dtype=np.float16),
    np.array([[1e308], [-5e-324]]),
    np.array([[complex(-0.0, np.nan)], [1e-310j]]),
]


@pytest.mark.parametrize("values", EXTREMES, ids=lambda v: f"{v.dtype} {v.ravel()[0]}")
@pytest.mark.parametrize("domain", DOMAINS)
def test_the_largest_and_the_oddest_numbers(values: np.ndarray, domain: str) -> None:
    mesh = sphere()
    index = np.arange(counts_of(mesh)[domain]) % 2
    given_ = Attribute("", domain, values, "other", index)
    one = encode_mesh(with_attributes(mesh, given_), Options(method="cartesian"))
    assert_same(given_, decode(one.data).attributes[0], sources_of(one, domain))


def test_ids_that_count_up_cost_little() -> None:
    ids = 10**12 + np.arange(len(meshes.icosphere(2)[0]), dtype=np.int64)[:, None]
    one = encode_mesh(sphere(Attribute("id", "vertex", ids)), Options(method="cartesian"))
    assert_same(
        replace(one.mesh.attributes[0]), decode(one.data).attributes[0], np.arange(len(ids))
    )
    assert entries_of(one.data)[0].size < 2 * len(ids)


def test_seventy_attributes_of_one_name() -> None:
    n = len(meshes.icosphere(2)[0])
    rng = np.random.default_rng(1)
    given_ = [Attribute("x", "vertex", rng.integers(0, 9, (n, 1))) for _ in range(70)]
    one = encode_mesh(sphere(*given_), Options(method="cartesian"))
    for a, b in zip(given_, decode(one.data).attributes, strict=True):
        assert_same(a, b, one.order)


def test_what_all_elements_have_alike_costs_a_few_bytes() -> None:
    mesh = sphere()
    given_ = [
        Attribute("a", domain, np.full((counts_of(mesh)[domain], 4), 77, np.uint8), "colour")
        for domain in DOMAINS
    ]
    data = encode_mesh(with_attributes(mesh, *given_), Options(method="cartesian")).data
    assert all(entry.size <= 12 for entry in entries_of(data))


def test_elements_without_any_value() -> None:
    n = len(meshes.icosphere(2)[0])
    for dtype in TYPES:
        nothing = Attribute("x", "vertex", np.zeros((0, 2), dtype), index=np.full(n, -1))
        one = encode_mesh(sphere(nothing), Options(method="cartesian"))
        assert_same(nothing, decode(one.data).attributes[0], one.order)


@pytest.mark.parametrize(
    ("attribute", "words"),
    [
        (Attribute("a", "vertex", np.zeros(162)), "shape"),
        (Attribute("a", "vertex", np.zeros((161, 1))), "161 rows for 162"),
        (
            Attribute("a", "face", np.zeros((1, 1)), index=np.zeros(319, int)),
            "index of face",
        ),
        (
            Attribute("a", "vertex", np.zeros((1, 1)), index=np.ones(162, int)),
            "leads out of",
        ),
        (
            Attribute("a", "vertex", np.zeros((1, 1)), index=np.full(162, -2)),
            "leads out of",
        ),
        (Attribute("a", "vertex", np.full((162, 1), "x")), "numbers of up to 64 bits"),
    ],
)
def test_attributes_of_another_mesh_are_refused(attribute: Attribute, words: str) -> None:
    with pytest.raises(MeshError, match=words):
        encode(sphere(attribute))


def test_what_is_dropped() -> None:
    mesh = sphere(charts(12), Attribute("a", "vertex", np.zeros((162, 1))))
    for names, left in ((["uv"], ["a"]), (["a", "b"], ["uv12"]), (["all"], [])):
        data = encode_mesh(mesh, Options(drop=tuple(names))).data
        assert [a.name for a in decode(data).attributes] == left
    plain = encode_mesh(sphere(), Options()).data
    assert encode_mesh(mesh, Options(drop=("all",))).data == plain


# ---- Real meshes -------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["cartesian", "refined"])
@pytest.mark.parametrize(
    "name",
    meshes.large_are_slow(["spot", "tank", "chair_model", "pizza"], place="clean/{}.obj"),
)
def test_seams_of_real_meshes_never_crack(name: str, method: str) -> None:
    """One vertex stays one vertex, whatever the texture coordinates on both sides of it are."""
    mesh = meshes.real_whole(f"clean/{name}.obj")
    one = encode_mesh(mesh, Options(method=method, threads=1))
    decoded = decode(one.data)
    assert len(decoded.vertices) == len(mesh.vertices)
    corners = sources_of(one, "corner")
    assert (mesh.corners[corners] == one.order[decoded.corners]).all()
    for given_, found, entry in zip(
        mesh.attributes, decoded.attributes, entries_of(one.data), strict=True
    ):
        assert_described(given_, found)
        sources = sources_of(one, given_.domain)
        has = given_.rows()[sources] >= 0
        assert (has == (found.rows() >= 0)).all()
        off = np.abs(found.dense() - given_.dense()[sources])[has]
        if given_.role == "uv":
            extent = np.ptp(given_.values, axis=0).max()
            assert off.max() <= 0.51 * extent / (2**12 - 1)
            assert off.max() == entry.error
        else:
            assert off.max() <= 0.004


# ---- Files that no encoder has written ---------------------------------------------------------


def kinds() -> PolyMesh:
    V, F = meshes.grid(4, 5)
    rng = np.random.default_rng(3)
    n, m = len(V), len(F)
    bits = rng.integers(0, 2**32, (n, 1), dtype=np.uint32)
    return with_attributes(
        from_triangles(V, F),
        Attribute("uv", "corner", V[F.ravel(), :2], "uv"),
        Attribute("id", "face", rng.integers(0, 2**60, (m, 2))),
        Attribute("normal", "vertex", np.tile([0.0, 0, 1], (n, 1)), "normal"),
        Attribute("bits", "vertex", bits.view(np.float32), index=rng.integers(-1, n, n)),
        Attribute("few", "face", rng.integers(0, 2, (2, 3))[rng.integers(0, 2, m)], "colour"),
    )


KINDS = encode_mesh(kinds(), Options(method="cartesian")).data


@strategies.SOME
@given(st.data())
def test_flipped_bytes_are_refused_or_mean_something_else(data: Any) -> None:
    payload = bytearray(read_container(KINDS).sections["ATTR"].payload)
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(payload) - 1))
        payload[at] ^= data.draw(st.integers(1, 255))
    file = forging.forged(KINDS, ATTR=bytes(payload))
    for make in (lambda: file, lambda: forging.consistent(file)):
        try:
            mesh = decode(make(), memory=1 << 34)
        except FormatError:
            continue
        for attribute in mesh.attributes:
            assert len(attribute.rows()) == counts_of(mesh)[attribute.domain]


@given(st.data())
def test_every_truncation_and_extension_is_refused(data: Any) -> None:
    payload = bytes(read_container(KINDS).sections["ATTR"].payload)
    end = data.draw(st.integers(0, len(payload) - 1))
    for wrong in (payload[:end], payload + bytes(end)[:3] + b"\x01"):
        with pytest.raises(FormatError):
            decode(forging.forged(KINDS, ATTR=wrong))


@given(st.binary(max_size=60))
def test_tables_of_any_bytes(data: bytes) -> None:
    with pytest.raises(FormatError):
        read_table(data + b"\xff" * 9)


@pytest.mark.parametrize("error", [0.5, 1e-2, 1e-4])
@pytest.mark.parametrize("dtype", ["f2", "f4", "f8"])
def test_errors_of_attributes_are_bounded(error: float, dtype: str) -> None:
    V, _ = meshes.icosphere(2)
    heat = Attribute("heat", "vertex", (20 * V[:, :2] ** 3).astype(dtype))
    uv = replace(charts(12), values=charts(12).values.astype(dtype))
    options = Options(method="cartesian", max_uv_error=error, max_attribute_error={"heat": error})
    one = encode_mesh(sphere(heat, uv), options)
    for given_, found, entry in zip(
        (heat, uv), decode(one.data).attributes, entries_of(one.data), strict=True
    ):
        assert_described(given_, found)
        wanted = given_.dense()[sources_of(one, given_.domain)].astype(float)
        errors = np.abs(found.dense().astype(float) - wanted)
        assert errors.max() == entry.error
        # A writer may round the numbers by as much again as the margin says.
        assert errors.max() + found.margin <= error
        assert (entry.coding == "grid") == (errors.max() > 0)
        if dtype != "f2":
            assert errors.max() > 0.9 * error
    exact = encode_mesh(sphere(heat, uv), Options(method="cartesian"))
    if error > 0.001 and dtype != "f2":
        assert entries_of(one.data)[0].size < entries_of(exact.data)[0].size / 2


def test_a_bound_on_a_role_is_one_on_all_its_attributes_and_the_least_counts() -> None:
    uv, other = replace(charts(12), name="a"), replace(charts(12), name="b")
    for bounds, expected in (
        ({"max_uv_error": 0.1}, (0.1, 0.1)),
        ({"max_attribute_error": {"uv": 0.1, "b": 0.01}}, (0.1, 0.01)),
        ({"max_uv_error": 0.02, "max_attribute_error": {"uv": 0.1, "a": 0.05}}, (0.02, 0.02)),
    ):
        data = encode_mesh(sphere(uv, other), Options(method="cartesian", **bounds)).data
        for entry, error in zip(entries_of(data), expected, strict=True):
            assert 0.9 * error < entry.error <= error


@pytest.mark.parametrize("error", [10.0, 1.0, 0.01])
def test_angles_of_normals_are_bounded(error: float) -> None:
    V, _ = meshes.icosphere(2)
    given_ = Attribute("normal", "vertex", V, "normal")
    options = Options(method="refined", max_attribute_error={"normal": error})
    one = encode_mesh(sphere(given_), options)
    (entry,) = entries_of(one.data)
    assert entry.coding == "octahedral"
    assert entry.error <= error
    found = decode(one.data).attributes[0].dense()
    cosines = np.clip((found * V[one.order]).sum(axis=1), -1, 1)
    assert np.degrees(np.arccos(cosines)).max() <= error


def test_what_no_grid_holds_stays_exact_within_a_bound() -> None:
    V, _ = meshes.icosphere(2)
    gaps = V[:, :1].copy()
    gaps[3] = np.nan
    given_ = (
        Attribute("gaps", "vertex", gaps),
        Attribute("wide", "vertex", 1e12 * V[:, :1]),
        Attribute("whole", "vertex", (100 * V[:, :1]).astype(np.int32)),
    )
    names = dict.fromkeys(("gaps", "wide", "whole"), 0.1)
    one = encode_mesh(sphere(*given_), Options(method="cartesian", max_attribute_error=names))
    for attribute, found in zip(given_, decode(one.data).attributes, strict=True):
        assert_same(attribute, found, one.order)


def test_other_floats_have_the_bits_that_are_asked_for() -> None:
    V, _ = meshes.icosphere(2)
    heat = Attribute("heat", "vertex", V[:, :2] ** 3)
    long = Attribute("normal", "vertex", 7 * V, "normal")  # not of length 1
    bright = Attribute("colour", "vertex", 9 * V**2, "colour")  # not within 0 .. 1
    whole = Attribute("whole", "vertex", (100 * V[:, :1]).astype(np.int32))
    one = encode_mesh(sphere(heat, long, bright, whole), Options(method="cartesian", bits_float=9))
    *floats, integer = entries_of(one.data)
    for given_, entry in zip((heat, long, bright), floats, strict=True):
        assert (entry.coding, entry.bits) == ("grid", 9)
        assert 0 < entry.error <= 0.51 * np.ptp(given_.values, axis=0).max() / 511
    assert integer.error == 0
    exact = entries_of(encode_mesh(sphere(heat), Options(method="cartesian")).data)[0]
    assert floats[0].size < exact.size / 2


def test_an_outlier_does_not_make_all_texture_coordinates_coarse() -> None:
    plain = charts(12)
    values = plain.values.astype(float)
    for far in (1e2, 1e6, 1e12):
        values[5] = far
        uv = replace(plain, values=values)
        one = encode_mesh(sphere(uv), Options(method="cartesian"))
        (entry,) = entries_of(one.data)
        step = np.ptp(plain.values, axis=0).max() / (2**12 - 1)
        finest = far / (2.0**29 - 1)
        assert entry.error <= max(2 * 0.51 * step, 0.51 * finest)
    # One of few is no outlier, and those of a mesh without outliers are as they were.
    few = from_triangles(*meshes.tetrahedron())
    values = np.array([[0.0, 0.0], [1, 0], [0, 1], [1e6, 1]])
    mesh = with_attributes(few, Attribute("uv", "vertex", values, "uv"))
    (entry,) = entries_of(encode_mesh(mesh, Options(method="cartesian")).data)
    assert entry.density == 4095 / 1e6
    (usual,) = entries_of(encode_mesh(sphere(plain), Options(method="cartesian")).data)
    assert usual.density == pytest.approx(1 / step)


@pytest.mark.parametrize(
    "bound", [{"bits_float": 8}, {"max_uv_error": 0.1}, {"max_attribute_error": {"heat": 0.1}}]
)
def test_bounds_contradict_lossless_attributes(bound: dict[str, Any]) -> None:
    (name,) = bound
    with pytest.raises(OptionError, match=f"{name} and lossless_attributes exclude each other"):
        Options(lossless_attributes=True, **bound)
    with pytest.raises(OptionError, match=f"{name} and method lossless exclude each other"):
        Options(method="lossless", **bound)


@pytest.mark.parametrize(
    "bound",
    [
        {"bits_float": 0},
        {"bits_float": 30},
        {"max_uv_error": 0.0},
        {"max_uv_error": np.nan},
        {"max_attribute_error": {"heat": -1.0}},
        {"max_attribute_error": {"": 1.0}},
    ],
)
def test_bounds_of_attributes_are_checked(bound: dict[str, Any]) -> None:
    with pytest.raises(OptionError, match=next(iter(bound))):
        Options(**bound)
