"""Everything together: any polygons, with any attributes, parts and text, in every way to encode.

The encoder tells which vertex, corner and polygon of the input each of the file was. These have to
be all there are, and everything at them has to be what it was: bit for bit, but for positions that
are quantized and attributes that may lose something, which have bounds.
"""

from __future__ import annotations

import contextlib
import io
from dataclasses import dataclass, replace
from typing import Any

import meshes
import numpy as np
import pytest
import strategies
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps

from deltamesh import decode, encode
from deltamesh._compare import likeness
from deltamesh._options import Options
from deltamesh._pipeline.encoder import Encoded, encode_mesh
from deltamesh_formats.container import payload_layout
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.files import read_mesh, written
from deltamesh_formats.polymesh.descriptions import unreferenced_rows
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh, from_triangles

METHODS = ("lossless", "cartesian", "highpass", "refined")
TYPES = tuple(map(np.dtype, payload_layout.TYPES))
DOMAINS = ("vertex", "corner", "face")
BITS_UV, BITS_NORMAL = 9, 8

MANY = settings(max_examples=2 * settings.default.max_examples)

seeds = strategies.SMALL
texts = st.text(st.characters(), max_size=6)  # surrogates too: bytes that were no UTF-8
usual = st.sampled_from(["normal", "uv", "colour", "uv1", "quality", ""])


# ---- Meshes ------------------------------------------------------------------------------------


@st.composite
def places(draw: st.DrawFn, n: int) -> tuple[np.ndarray, str]:
    """Positions: alike, on a grid, far away, tiny, anything."""
    rng = np.random.default_rng(draw(seeds))
    kind = draw(st.sampled_from(["grid", "plain", "far", "flat", "tiny", "zeros", "any"]))
    V = rng.normal(size=(n, 3))
    if kind == "grid":
        V = rng.integers(-2, draw(st.sampled_from([-1, 1, 50])), (n, 3)).astype(float)
    elif kind == "far":
        V = np.round(V, 3) + np.array([4.1e6, 5.2e6, 310.0])
    elif kind == "flat":
        V *= [1.0, 1e-9, 0.0]
    elif kind == "tiny":
        V *= 1e-160
    elif kind == "zeros":
        V = np.where(V > 0, 0.0, -0.0)
    elif kind == "any":
        some = st.floats(-1e150, 1e150, allow_subnormal=True)
        V = draw(nps.arrays(float, (n, 3), elements=some))
    same = rng.random(n) < draw(st.sampled_from([0.0, 0.0, 0.3]))
    V = V[np.where(same, rng.integers(0, n, n), np.arange(n))]
    if draw(st.booleans()) and np.abs(V).max() < 1e38:
        return V.astype(np.float32).astype(float), "float32"
    return V, "float64"


@st.composite
def polygons(draw: st.DrawFn) -> tuple[int, list[list[int]]]:
    """Number of vertices and polygons over them: any, or triangles of a surface and unions."""
    if draw(st.booleans()):
        n = draw(st.integers(1, 10))
        polygon = st.lists(st.integers(0, n - 1), min_size=3, max_size=7)
        rows = draw(st.lists(polygon, min_size=1, max_size=8))
    else:
        V, F = draw(strategies.complexes())
        n, rows = len(V), F.tolist()
        rng = np.random.default_rng(draw(seeds))
        share = draw(st.sampled_from([0.0, 0.5, 1.0]))
        rows = [row for row in united(rows, share, rng) if len(row) >= 3]
    rng = np.random.default_rng(draw(seeds))
    again = draw(st.sampled_from([0.0, 0.0, 0.3]))
    others = [list(np.roll(r[:: rng.choice([1, -1])], rng.integers(9))) for r in rows]
    rows = rows + [row for row in others if rng.random() < again]
    alone = draw(st.integers(0, 3))
    return n + alone, [list(map(int, rows[i])) for i in rng.permutation(len(rows))]


def united(rows: list[list[int]], share: float, rng: np.random.Generator) -> list[list[int]]:
    """Polygons, some joined with another one that has one of their edges the other way round."""
    left = [list(row) for row in rows]
    done: list[list[int]] = []
    while left:
        row = left.pop()
        for i, other in enumerate(left[-12:], start=max(len(left) - 12, 0)):
            ends = {(other[k - 1], other[k]): k for k in range(len(other))}
            edge = next((k for k in range(len(row)) if (row[k], row[k - 1]) in ends), None)
            if edge is not None and len(row) + len(other) <= 9 and rng.random() < share:
                at = ends[row[edge], row[edge - 1]]
                rest = [other[(at + 1 + k) % len(other)] for k in range(len(other) - 2)]
                left[i] = row[:edge] + rest + row[edge:]
                break
        else:
            done.append(row)
    return done


@st.composite
def numbers(draw: st.DrawFn, shape: tuple[int, int]) -> np.ndarray:
    """Numbers of any type: any bits, few different ones, or such as attributes really are."""
    rng = np.random.default_rng(draw(seeds))
    if draw(st.booleans()):
        kind = draw(st.sampled_from(["unit", "smooth", "fractions", "zero", "huge"]))
        V = rng.normal(size=shape)
        if kind == "unit":
            V /= np.maximum(np.linalg.norm(V, axis=1, keepdims=True), 1e-30)
            V[rng.random(shape[0]) < 0.2] = 0.0
        elif kind == "fractions":
            V = rng.integers(0, 256, shape) / draw(st.sampled_from([255.0, 256.0]))
        elif kind == "zero":
            V *= 0.0
        elif kind == "huge":
            V *= 1e300
        with np.errstate(over="ignore"):
            return V.astype(draw(st.sampled_from(["f4", "f8", "f2"])))
    dtype = draw(st.sampled_from(TYPES))
    bits = rng.integers(0, 256, (shape[0], shape[1] * dtype.itemsize), dtype=np.uint8)
    if dtype.kind == "b":
        return bits > 127
    return bits.view(dtype).reshape(shape)


@st.composite
def attributes(draw: st.DrawFn, counts: dict[str, int]) -> Attribute:
    domain = draw(st.sampled_from(DOMAINS))
    count, width = counts[domain], draw(st.sampled_from([1, 2, 3, 3, 4, 7, 0]))
    rng = np.random.default_rng(draw(seeds))
    low, rows = draw(st.sampled_from([0, 0, -1])), draw(st.sampled_from([1, 2, 5, count]))
    values = draw(numbers((rows, width)))
    index = rng.integers(low, rows, count)
    if draw(st.booleans()):
        values, index = values[np.maximum(index, 0)], None
    name = draw(usual | texts)
    role = draw(st.sampled_from(["other", name.rstrip("1")]))
    role = role if role in ("normal", "uv", "colour") else "other"
    return Attribute(name, domain, values, role, index, draw(st.booleans()))


@st.composite
def parts(draw: st.DrawFn, kind: Any, faces: int) -> Parts:
    count = draw(st.integers(1, 4))
    names = tuple(draw(st.lists(texts, min_size=count, max_size=count)))
    rng = np.random.default_rng(draw(seeds))
    of_face = rng.integers(draw(st.sampled_from([0, -1])), count, faces)
    transforms = None
    if draw(st.booleans()):
        transforms = rng.normal(size=(count, 4, 4))
        transforms[rng.random(count) < 0.5] = np.eye(4)
    return Parts(kind, names, of_face, transforms)


@st.composite
def wholes(draw: st.DrawFn) -> PolyMesh:
    n, rows = draw(polygons())
    V, precision = draw(places(n))
    sizes = [len(row) for row in rows]
    counts = {"vertex": n, "corner": sum(sizes), "face": len(sizes)}
    kinds = draw(st.lists(st.sampled_from(list(payload_layout.KINDS)), max_size=3, unique=True))
    lines = st.lists(texts, max_size=2).map(tuple)
    return PolyMesh(
        V,
        np.array([v for row in rows for v in row], dtype=np.int64),
        np.concatenate(([0], np.cumsum(sizes))).astype(np.int64),
        tuple(draw(st.lists(attributes(counts), max_size=4))),
        tuple(draw(parts(kind, len(sizes))) for kind in kinds),
        draw(st.dictionaries(texts, lines, max_size=2)),
        draw(lines.map(lambda words: tuple(dict.fromkeys(words)))),
        precision=precision,
    )


# ---- What has to come back ---------------------------------------------------------------------


@dataclass(frozen=True)
class Came:
    """The vertex, corner and face of the input that each of those of the decoded mesh was."""

    vertex: np.ndarray
    corner: np.ndarray
    face: np.ndarray


def came_from(mesh: PolyMesh, one: Encoded, drop_isolated: bool) -> Came:
    """Where everything comes from; nothing is missing, and nothing there twice."""
    vertices = np.unique(mesh.corners) if drop_isolated else np.arange(len(mesh.vertices))
    sizes = mesh.sizes[one.face_order]
    starts = mesh.offsets[one.face_order]
    corner = [
        start + (turn + k) % size
        for start, turn, size in zip(starts, one.rotation, sizes, strict=True)
        for k in range(size)
    ]
    came = Came(one.order, np.array(corner, dtype=np.int64), one.face_order)
    assert np.sort(came.vertex).tolist() == vertices.tolist()
    assert np.sort(came.corner).tolist() == list(range(len(mesh.corners)))
    assert np.sort(came.face).tolist() == list(range(len(mesh.sizes)))
    return came


def assert_same_rows(wanted: Attribute, found: Attribute, came: np.ndarray, exact: bool) -> None:
    for what in ("name", "domain", "role", "normalized", "width"):
        assert getattr(wanted, what) == getattr(found, what)
    assert found.values.dtype == wanted.values.dtype
    rows, others = wanted.rows()[came], found.rows()
    assert ((rows < 0) == (others < 0)).all()
    a = np.ascontiguousarray(wanted.values[rows[rows >= 0]])
    b = np.ascontiguousarray(found.values[others[others >= 0]])
    floats = a.dtype.kind == "f" and wanted.role != "other"
    if exact or not floats or a.tobytes() == b.tobytes():
        assert a.tobytes() == b.tobytes()
        return
    a, b = a.astype(float), b.astype(float)
    coarse = 2.0 ** {2: -11, 4: -24, 8: -53}[found.values.dtype.itemsize]
    if wanted.role == "normal":
        bound = 1.01 * np.sqrt(2) / (2 ** (BITS_NORMAL - 1) - 1) + 4 * coarse
        assert (np.linalg.norm(b - a, axis=1) <= bound).all()
        assert ((np.abs(b).sum(axis=1) == 0) == (np.abs(a).sum(axis=1) == 0)).all()
        return
    extent = np.ptp(a, axis=0).max() / (2**BITS_UV - 1) if wanted.role == "uv" else 1 / 255
    assert (np.abs(b - a) <= 0.52 * extent + coarse).all()


def assert_whole(mesh: PolyMesh, decoded: PolyMesh, came: Came, exact: bool) -> None:
    """Polygons, their corners and windings, attributes, parts and text are as they were."""
    assert decoded.sizes.tolist() == mesh.sizes[came.face].tolist()
    assert came.vertex[decoded.corners].tolist() == mesh.corners[came.corner].tolist()
    assert len(decoded.attributes) == len(mesh.attributes)
    for wanted, found in zip(mesh.attributes, decoded.attributes, strict=True):
        assert_same_rows(wanted, found, getattr(came, wanted.domain), exact)
    assert len(decoded.parts) == len(mesh.parts)
    for p, q in zip(mesh.parts, decoded.parts, strict=True):
        assert (p.kind, p.names, p.of_face[came.face].tolist()) == (
            q.kind,
            q.names,
            q.of_face.tolist(),
        )
        assert (p.transforms is None) == (q.transforms is None)
        assert p.transforms is None or p.transforms.tobytes() == q.transforms.tobytes()
    assert decoded.metadata == mesh.metadata
    assert decoded.lost == tuple(dict.fromkeys((*mesh.lost, *unreferenced_rows(mesh))))
    assert decoded.precision == mesh.precision


OPTIONS = st.fixed_dictionaries(
    {
        "method": st.sampled_from(METHODS),
        "keep_order": st.booleans(),
        "lossless_attributes": st.booleans(),
        "drop_isolated": st.booleans(),
    }
)


@MANY
@given(wholes(), OPTIONS)
def test_everything_comes_back(mesh: PolyMesh, given_options: dict[str, Any]) -> None:
    options = Options(bits_uv=BITS_UV, bits_normal=BITS_NORMAL, threads=1, **given_options)
    if options.method in ("highpass", "refined") and np.abs(mesh.vertices).max() > 1e145:
        with contextlib.suppress(MeshError):  # too large for these
            encode_mesh(mesh, options)
        return
    one = encode_mesh(mesh, options)
    decoded = decode(one.data, threads=1)
    came = came_from(mesh, one, options.drop_isolated)
    exact = options.lossless_attributes or options.method == "lossless"
    assert_whole(mesh, decoded, came, exact)
    assert_near(mesh.vertices[came.vertex], decoded.vertices, one)
    if options.keep_order:
        for kept in (came.vertex, came.corner, came.face):
            assert (np.diff(kept) > 0).all()


@strategies.FEW
@given(wholes())
def test_the_comparison_of_meshes_finds_everything(mesh: PolyMesh) -> None:
    """What the command line calls alike, without being told what became of what."""
    decoded = decode(encode_mesh(mesh, Options(method="lossless", threads=1)).data)
    found = likeness.corresponding(mesh, decoded, exact=True)
    assert found is not None
    pairs = likeness.matched_corners(mesh, decoded, found)
    assert pairs is not None


def assert_near(V: np.ndarray, decoded: np.ndarray, one: Encoded) -> None:
    """Positions are as far from where they were as the file says, of lossless files not at all."""
    container = read_container(one.data)
    if container.parameters.method == "lossless":
        assert decoded.tobytes() == V.tobytes()
        return
    meta = container.meta
    assert meta is not None
    assert np.isfinite(decoded).all()
    scale = np.abs(V).max() or 1.0  # squares may leave double precision
    away = scale * np.linalg.norm(decoded / scale - V / scale, axis=1).max()
    assert away <= meta.max * (1 + 1e-6) + 1e-8 * meta.diagonal + 1e-15 * scale


@pytest.mark.parametrize("method", METHODS)
def test_positions_that_no_decoder_would_take_are_not_written(method: str) -> None:
    V, F = meshes.icosphere(1)
    assert len(decode(encode(1e140 * V, F, method=method)).vertices) == len(V)
    if method in ("lossless", "cartesian"):
        assert len(decode(encode(0.9e150 * V, F, method=method)).vertices) == len(V)
    else:
        with pytest.raises(MeshError, match=f"too large for method {method}: try lossless"):
            encode(0.9e150 * V, F, method=method)


def test_rows_that_nothing_refers_to_are_named_as_lost() -> None:
    mesh = from_triangles(*meshes.tetrahedron())
    index = np.arange(12) % 3
    uv = Attribute("uv", "corner", np.eye(4)[:, :2], "uv", index)
    flags = Attribute("flags", "vertex", np.arange(4)[:, None], index=np.array([0, 1, 1, -1]))
    decoded = decode(encode(replace(mesh, attributes=(uv, flags))))
    assert decoded.lost == (
        "texture coordinates that no face refers to",
        "flags of vertices that no vertex refers to",
    )
    whole = replace(mesh, attributes=(replace(uv, values=uv.values[:3]),))
    assert decode(encode(whole)).lost == ()


@pytest.mark.parametrize("file_format", ["obj", "stl", "glb"])
def test_as_many_objects_as_faces_in_any_order(file_format: str) -> None:
    mesh = from_triangles(*meshes.grid(12, 9))
    count = len(mesh.sizes)
    own = np.random.default_rng(1).permutation(count)
    parts = Parts("object", tuple(f"object {i}" for i in range(count)), own)
    mesh = replace(mesh, vertices=mesh.vertices.astype(np.float32).astype(float), parts=(parts,))
    decoded = decode(encode(mesh, method="lossless"))
    found = read_mesh(io.BytesIO(written(decoded, file_format).data), file_format)
    objects = found.parts_of("object")
    assert objects is not None
    placed = {
        objects.names[i]: found.vertices[f]
        for i, f in zip(objects.of_face, found.faces, strict=True)
    }
    for i, face in zip(own, mesh.faces, strict=True):
        wanted = mesh.vertices[face].tolist()
        rotations = [np.roll(placed[f"object {i}"], k, axis=0).tolist() for k in range(3)]
        assert wanted in rotations
