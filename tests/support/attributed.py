"""Small meshes with attributes of every coding, domain and type: for golden files and refusals."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np

from deltamesh._attributes.normals.surface import Surroundings, surface_normals
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh, from_triangles

# Zeros, infinities, quiet and signalling NaNs, the smallest and the largest numbers.
ODD = {
    "f2": [0x0000, 0x8000, 0x7C00, 0xFC00, 0x7E00, 0x7D01, 0x0001, 0x7BFF],
    "f4": [0, 1 << 31, 0x7F800000, 0xFF800000, 0x7FC00000, 0xFF812345, 1, 0x7F7FFFFF],
    "f8": [0, 1 << 63, 0x7FF << 52, 0xFFF << 52, 0x7FF8 << 48, (0x7FF << 52) + 9, 1, 0x7FE << 52],
}


def odd(kind, count, width):
    """Odd numbers among tidy ones, so that raw numbers and both kinds of form come up."""
    size = int(kind[1])
    bits = np.resize(np.array(ODD[kind], dtype=f"u{size}"), (count, width))
    tidy = (np.arange(count * width).reshape(count, width) / 4 - 3).astype(kind)
    often = np.arange(count)[:, None] % 3 > 0
    return np.where(often, tidy.view(bits.dtype), bits).view(kind)


def seamed(mesh):
    """A value of each corner that jumps along a seam: float64 (c, 3)."""
    first = mesh.corners[mesh.offsets[:-1]]
    left = np.repeat(mesh.vertices[first, 0] > 0, mesh.sizes)
    return mesh.vertices[mesh.corners] + 3.0 * left[:, None]


def rounded_normals(rows):
    """Unit vectors of binary32, some of them zero."""
    length = np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-9)
    normals = rows / length
    normals[5::9] = 0
    return normals.astype(np.float32)


def partly(attribute, every):
    """The attribute without a value for one element of so many."""
    index = np.arange(len(attribute.values))
    index[::every] = -1
    return replace(attribute, index=index)


def triangles():
    return from_triangles(*meshes.torus(4, 3))


def noise(seed, shape):
    return np.random.default_rng(seed).normal(size=shape)


def colours(mesh):
    """Colours that go with each other, few colours, and gaps in both."""
    n, m = len(mesh.vertices), len(mesh.sizes)
    grey = 120 + 60 * mesh.vertices[:, :1] + np.array([0, 1, -2, 9]) + 2 * noise(1, (n, 4))
    few = np.array([[255, 0, 0], [0, 255, 0], [9, 9, 200]], dtype=np.uint8)
    which = np.minimum(np.arange(m) // 5, 2)
    return [
        Attribute("colour", "vertex", grey.astype(np.uint8), "colour", None, True),
        Attribute("colour1", "face", few, "colour", which, True),
        Attribute("colour2", "vertex", few[:2] / 255.0, "colour", np.arange(n) % 3 - 1),
        partly(Attribute("label", "face", which.astype(np.int32)[:, None]), 5),
    ]


def integers(mesh):
    n, m, c = len(mesh.vertices), len(mesh.sizes), len(mesh.corners)
    rng = np.random.default_rng(7)
    wide = rng.integers(-(2**63), 2**63 - 1, (n, 4))
    wide[:2, 0] = -(2**63), 2**63 - 1
    last = np.array([[0, 2**64 - 1]], dtype=np.uint64)
    return [
        Attribute("wide", "vertex", wide),
        Attribute(
            "wide", "face", np.array([[2**64 - 1], [0], [2**33]], np.uint64)[np.arange(m) % 3]
        ),
        Attribute("one", "face", last, "other", np.zeros(m, dtype=np.int64)),
        Attribute("truth", "vertex", (np.arange(5 * n) % 3 > 0).reshape(n, 5)),
        partly(Attribute("truth", "corner", np.arange(c)[:, None] % 4 > 1), 7),
        Attribute("small", "vertex", (np.arange(n)[:, None] - 6).astype(np.int8), "other"),
        Attribute("\N{SNOWMAN}\udcff\0", "vertex", np.zeros((n, 0), np.int16)),
        Attribute("nothing", "face", np.zeros((0, 2), np.uint16), index=np.full(m, -1)),
    ]


def exact(mesh):
    n, m, c = len(mesh.vertices), len(mesh.sizes), len(mesh.corners)
    single = odd("f4", n, 2).view(np.complex64)
    return [
        Attribute("half", "vertex", odd("f2", n, 4)),
        Attribute("single", "face", odd("f4", m, 1)),
        partly(Attribute("double", "face", odd("f8", m, 2)), 4),
        Attribute("complex", "vertex", single),
        Attribute("complex", "vertex", odd("f8", 4, 4).view(np.complex128), index=np.arange(n) % 4),
        Attribute("seam", "corner", odd("f8", c, 1), index=np.arange(c) // 24),
    ]


def textured(mesh):
    """Seams, a second set that shares them, one that has values by faces, and gaps."""
    at = seamed(mesh)
    uv = Attribute("uv", "corner", at[:, :2].astype(np.float32), "uv")
    again = Attribute("uv1", "corner", (at[:, [2, 1, 0]] * [1, 9, 2]).astype(np.float64), "uv")
    other = Attribute("tint", "corner", (40 * at + 99).astype(np.int16), "other")
    flat = np.repeat(np.arange(len(mesh.sizes)), mesh.sizes)
    return [
        uv,
        again,
        other,
        Attribute("flat", "corner", noise(2, (len(mesh.sizes), 2)).round(1), "other", flat),
        partly(replace(uv, name="uv2"), 8),
        partly(Attribute("uv", "face", noise(3, (len(mesh.sizes), 1)), "uv"), 6),
        partly(Attribute("uv", "vertex", mesh.vertices[:, :2].astype(np.float16), "uv"), 3),
    ]


def shaded(mesh, weight):
    """Normals of the surface with these weights, all turned a little; without, made up."""
    flat = np.repeat(np.arange(len(mesh.sizes)), mesh.sizes)
    found = []
    for domain, at, count in (
        ("vertex", mesh.corners, len(mesh.vertices)),
        ("corner", np.arange(len(mesh.corners)), len(mesh.corners)),
        ("face", flat, len(mesh.sizes)),
    ):
        if weight is None:
            rows = noise(5, (count, 3)) * [0.3, 0.3, 0.1] + [0, 0, 1]
        else:
            around = Surroundings(mesh.corners, mesh.offsets, at, count)
            rows, _ = surface_normals(mesh.vertices, around, weight, 0.0)
            rows = rows + np.array([1e-3, 0, 0])
        normals = Attribute("normal", domain, rounded_normals(rows), "normal")
        found.append(partly(normals, 6) if domain == "face" else normals)
    return found


def bumpy():
    """Vertices around which the faces differ much in size and in angle."""
    V, F = meshes.torus(4, 3)
    return from_triangles(V + 0.15 * noise(4, V.shape), F)


def with_copies():
    """Two rows of triangles; a row of vertices between them is there twice, a third vertex free."""
    V, F = meshes.grid(4, 3)
    upper = F[F.min(axis=1) >= 3]
    lower = F[F.min(axis=1) < 3]
    number = np.arange(len(V))
    number[3:6] = len(V) + np.arange(3)
    return from_triangles(
        np.concatenate([V, V[3:6], V[:1]]), np.concatenate([upper, number[lower]])
    )


def with_isolated():
    V, F = meshes.tetrahedron()
    return from_triangles(
        np.insert(V, [0, 2, 4], [[3.0, 0, 0], [0, 3, 0], [9, 9, 9]], 0), F + 1 + (F > 1)
    )


def with_all(mesh):
    """A few of each, on any mesh."""
    some = [*colours(mesh)[::3], textured(mesh)[0], textured(mesh)[3], *shaded(mesh, 0)[:2]]
    return replace(mesh, attributes=tuple(some))


def quads():
    V, F = meshes.torus(4, 3)
    lower, upper = np.split(F, 2)
    rows = np.column_stack([lower, upper[:, 2]])
    rows = [[*row] for row in rows[:-1]] + [rows[-1, :3], rows[-1, [2, 3, 0]]]
    corners = np.concatenate(rows).astype(np.int64)
    offsets = np.cumsum([0, *map(len, rows)]).astype(np.int64)
    return PolyMesh(V + 0.05 * noise(6, V.shape), corners, offsets)


def golden():
    """Name, mesh and options of each golden file; the name begins with the method."""
    plain, rough = triangles(), bumpy()
    stitched = from_triangles(*meshes.union(meshes.three_pages(), meshes.collapsed()))

    def given(mesh, attributes):
        return replace(mesh, attributes=tuple(attributes))

    weighted = [
        (f"cartesian-normals-{name}", given(rough, shaded(rough, weight)), {"bits_normal": bits})
        for name, weight, bits in (("area", 0, 9), ("angle", 1, 12), ("equal", 2, 7))
    ]
    return [
        ("cartesian-colours", given(plain, colours(plain)), {}),
        ("cartesian-integers", given(plain, integers(plain)), {}),
        ("lossless-numbers", given(plain, exact(plain)), {}),
        ("highpass-textured", given(plain, textured(plain)), {"bits_uv": 9, "keep_order": True}),
        *weighted,
        ("refined-normals-free", given(plain, shaded(plain, None)), {"bits_normal": 6}),
        ("cartesian-isolated-attributes", with_all(with_isolated()), {"bits": 9}),
        ("highpass-copies-attributes", with_all(with_copies()), {"bits": 10}),
        ("cartesian-stitched-attributes", with_all(stitched), {"keep_order": True}),
        ("cartesian-quads-attributes", with_all(quads()), {"keep_order": True}),
    ]
