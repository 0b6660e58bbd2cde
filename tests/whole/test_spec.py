"""SPEC.md against the package: `spec_decoder` makes of a file what `decode` makes of it."""

from __future__ import annotations

from pathlib import Path

import meshes
import numpy as np
import places
import pytest
import spec_attributes
import spec_coder
import spec_decoder
import spec_labels
import spec_polygons
import strategies
from second_opinion import assert_same, assert_same_prefix

from deltamesh import encode, info
from deltamesh._graph.elements import of_vertices
from deltamesh._mesh import TriangleMesh
from deltamesh._order import coding as order
from deltamesh._order.reordering import Order
from deltamesh._shape.polygons import plain
from deltamesh._streams.labels import encode_labels
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.stages import stages_of

GOLDEN = sorted(places.GOLDEN.glob("*.dmesh"))
# Files that the second decoder takes longest over.
LONG = {
    "highpass-complex",
    "highpass-components",
    "highpass-order",
    "highpass-valence-300",
    "refined-complex",
    "refined-quads-corrected",
}
REFUSED = sorted(places.REFUSED.glob("*.dmesh"))

HIGHPASS, REFINED = {"method": "highpass"}, {"method": "refined"}
THROUGH = {"solution": "interpolated"}
FRESH = {
    "triangle": ((np.eye(3), np.array([[0, 1, 2]])), HIGHPASS),
    "closed": (meshes.icosphere(1), HIGHPASS | {"bits": 9}),
    "boundary": (meshes.grid(6, 11), HIGHPASS | {"step": 1e-3}),
    "handles": (meshes.double_torus(), HIGHPASS | {"bits": 10, "anchors": 3}),
    "many joins": (
        meshes.torus(3, 20),
        HIGHPASS | {"bits": 4, "anchor_method": "greedy", "anchors": 12},
    ),
    "components": (
        meshes.two_components(),
        HIGHPASS | {"anchor_method": "random", "seed": 7, "anchors": 9},
    ),
    "components, greedy": (
        meshes.two_components(),
        HIGHPASS | {"anchor_method": "greedy", "anchors": 5},
    ),
    "isolated, greedy": (
        meshes.with_isolated(),
        HIGHPASS | {"anchor_method": "greedy", "anchors": 4},
    ),
    "0 bits": (meshes.torus(8, 6), HIGHPASS | {"bits": 0, "anchors": 8}),
    "26 bits": (meshes.icosphere(1), HIGHPASS | {"bits": 26}),
    "30 bits": (meshes.icosphere(1), HIGHPASS | {"bits": 30}),
    "interpolated": (meshes.torus(8, 6), HIGHPASS | THROUGH | {"bits": 9, "anchors": 6}),
    "interpolated, 26 bits": (meshes.torus(8, 6), HIGHPASS | THROUGH | {"bits": 26, "anchors": 2}),
    "interpolated, greedy": (
        meshes.two_components(),
        HIGHPASS | THROUGH | {"anchor_method": "greedy", "anchors": 7},
    ),
    "interpolated, isolated": (meshes.with_isolated(), HIGHPASS | THROUGH | {"anchors": 5}),
    "refined": (meshes.two_components(), REFINED | {"anchors": 3}),
    "refined, many anchors": (meshes.two_components(), REFINED | {"anchors": 30, "bits": 8}),
    "refined, random": (
        meshes.two_components(),
        REFINED | {"anchor_method": "random", "seed": 7, "anchors": 12},
    ),
    "refined, least squares": (
        meshes.two_components(),
        REFINED | {"anchors": 6, "solution": "least-squares"},
    ),
    "refined, boundary": (meshes.grid(9, 6), REFINED | {"step": 1e-3}),
    "cartesian": (meshes.torus(9, 5), {"method": "cartesian", "bits": 10}),
    "cartesian, 30 bits": (meshes.torus(9, 5), {"method": "cartesian", "bits": 30}),
    "cartesian, isolated": (meshes.with_isolated(), {"method": "cartesian", "bits": 16}),
    "cartesian, boundaries": (
        meshes.union(meshes.grid(4, 4), meshes.grid(5, 3)),
        {"method": "cartesian", "step": 0.02},
    ),
    "lossless": (meshes.torus(9, 5), {"method": "lossless"}),
    "lossless, isolated": (meshes.with_isolated(), {"method": "lossless"}),
}


KEPT = {
    "closed": meshes.icosphere(1),
    "boundary": meshes.grid(6, 7),
    "handles": meshes.double_torus(),
    "components": meshes.union(meshes.torus(5, 4), meshes.grid(4, 4)),
    "isolated": meshes.with_isolated(),
}

# An importance that falls along an axis, and none beyond the middle.
IMPORTANCE = {
    "steps": lambda x: 0.125 + 0.875 * (x - x.min()) / np.ptp(x),
    "no bits": lambda x: (x > x.mean()).astype(float),
}

# Few anchors, and a bound on the largest error that is kept best by corrections.
CORRECTED = {
    "highpass": (meshes.grid(15, 15), HIGHPASS | {"anchors": 1}),
    "refined": (meshes.grid(15, 15), REFINED | {"anchors": 1}),
    "refined, isolated": (meshes.with_isolated(meshes.grid(15, 15)), REFINED | {"anchors": 1}),
}


def test_golden_files_have_attributes_of_all_kinds() -> None:
    """Every coding of every domain, all that flags can say, and each of the weights."""
    seen = [
        one
        for path in GOLDEN
        if "ATTR" in info(path.read_bytes()).sections
        for one in spec_decoder.decode(path.read_bytes())[2]["attributes"]
    ]
    entries = [one.entry for one in seen]
    assert {(e.domain, e.coding) for e in entries} >= {
        (domain, coding) for domain in ("vertex", "corner", "face") for coding in range(4)
    }
    assert {e.type for e in entries} >= {*spec_attributes.TYPES} - {"I"}
    assert {(e.domain, e.partly) for e in entries} >= {
        (domain, partly) for domain in ("vertex", "corner", "face") for partly in (False, True)
    }
    assert {e.classes for e in entries} >= {None, 0, 1, 2}
    assert {e.width for e in entries} >= {0, 1, 2, 3, 4, 5}
    assert {bool(e.palette) for e in entries} == {False, True}
    assert {(e.mixed, e.coding) for e in entries} >= {(True, 0)}
    assert {e.limbs > 1 for e in entries} == {False, True}
    assert {e.first for e in entries} == {0, 1}
    assert {one.weights for one in seen if one.weights is not None} == {0, 1, 2, 3}


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, id=path.stem, marks=[pytest.mark.slow] * (path.stem in LONG))
        for path in GOLDEN
    ],
)
def test_golden_file(path: Path) -> None:
    assert_same(path.read_bytes())


SOLVED = [
    path
    for path in GOLDEN
    if path.stem.startswith(("highpass", "refined")) and info(path).vertices <= 150
]


@pytest.mark.parametrize("path", SOLVED, ids=lambda path: path.stem)
def test_prefixes_of_a_golden_file(path: Path) -> None:
    """Each stage, and a byte before the first one."""
    data = path.read_bytes()
    container = info(data)
    for size in list(stages_of(container).values())[:-1]:
        assert_same_prefix(data[:size])
    with pytest.raises(spec_coder.RefusedError):
        spec_decoder.decode(data[: stages_of(container)["anchors"] - 1], cut=True)


@pytest.mark.parametrize("name", FRESH)
def test_fresh_file(name: str) -> None:
    (vertices, faces), options = FRESH[name]
    noise = np.random.default_rng(2003).normal(size=vertices.shape)
    assert_same(encode(vertices + 0.03 * noise, faces, **options))


@pytest.mark.parametrize("method", ["refined", "highpass", "cartesian"])
@pytest.mark.parametrize("name", IMPORTANCE)
def test_file_of_importance(name: str, method: str) -> None:
    V, F = meshes.two_components()
    data = encode(V, F, method=method, step=0.02, importance=IMPORTANCE[name](V[:, 0]))
    assert "regs" in info(data).sections
    assert_same(data)


@pytest.mark.parametrize("name", CORRECTED)
def test_corrected_file(name: str) -> None:
    mesh, options = CORRECTED[name]
    data = encode(*mesh, **options, normal_error=8.0, max_error_rel=1e-3)
    assert "FIXS" in info(data).sections
    assert_same(data)


@pytest.mark.parametrize("size", [7, 20])
def test_lattice(size: int) -> None:
    """Few different coordinates, as machine parts have: candidates are often right."""
    vertices, faces = meshes.grid(size, size)
    heights = np.random.default_rng(size).integers(0, 3, len(vertices))
    places = np.stack([*np.rint((size - 1) * vertices[:, :2]).T, heights], axis=1)
    turned = np.argsort(np.random.default_rng(1).random(len(vertices)))
    data = encode(places[turned] + 0.0, np.argsort(turned)[faces], method="cartesian", step=0.01)
    assert_same(data)


@pytest.mark.parametrize("seed", [None, 8])
@pytest.mark.parametrize("name", KEPT)
def test_kept_order(name: str, seed: int | None) -> None:
    V, F = KEPT[name]
    mesh = TriangleMesh(V, F) if seed is None else meshes.shuffled(V, F, seed)[0]
    data = encode(mesh.vertices, mesh.faces, method="cartesian", keep_order=True)
    assert_same(data)
    np.testing.assert_array_equal(spec_decoder.decode(data)[1], mesh.faces)


@pytest.mark.parametrize("plan", [0, 1, 2, 4, 8, 9, 10, 13])
def test_each_plan_of_an_order(plan: int) -> None:
    """As the encoder would write it if the plan were the best."""
    V, F = meshes.union(meshes.torus(7, 5), meshes.grid(4, 5))
    mesh = meshes.shuffled(V, F, plan)[0]
    # A part in an order of its own, so that steps of all kinds come up.
    own = np.argsort(np.where(np.arange(len(F)) % 7, mesh.faces.min(axis=1), -1), kind="stable")
    kept = Order(np.argsort(mesh.vertices[:, 0], kind="stable"), own, np.arange(len(F)) % 3)
    coded = [order._vertex_stream, order._polygon_stream]
    rows = order._rows(mesh.faces, plain(len(F)))
    first, second = (code(rows, kept, plan, 0, None) for code in coded)
    payload = bytes([plan]) + write_varint(len(first)) + first + second
    faces = [tuple(map(int, face)) for face in mesh.faces]
    polygons = spec_polygons.polygons(faces, [-1] * (3 * len(faces)))
    for expected, found in zip(
        (kept.vertices, kept.polygons, kept.rotations),
        spec_decoder.read_order(payload, faces, polygons, len(V)),
        strict=True,
    ):
        np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("kinds", ["one", "patches", "noise", "many", "again"])
def test_labels(kinds: str) -> None:
    """Each kind of candidate, labels that come late, and the match that goes on."""
    vertices, faces = meshes.torus(15, 12)
    rng, n = np.random.default_rng(516), len(vertices)
    values = {
        "one": np.zeros(n, int),
        "patches": np.floor(3 * vertices[:, 0]).astype(int),
        "noise": rng.integers(0, 4, n),
        "many": rng.integers(0, 100, n),
        "again": np.tile(rng.integers(0, 9, 40), 9)[:n],
    }[kinds]
    elements = of_vertices(faces, n)
    rows = zip(elements.indptr, elements.indptr[1:], strict=False)
    near = [elements.indices[first:end].tolist() for first, end in rows]
    _, first, inverse = np.unique(values, return_index=True, return_inverse=True)
    labels = np.argsort(np.argsort(first))[inverse]
    payload = bytes(encode_labels(elements, labels))
    assert spec_labels.labels(payload, near) == labels.tolist()
    assert (payload == b"") == (kinds == "one")


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
