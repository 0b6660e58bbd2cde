"""Golden files of whole meshes: polygons, parts and words. `make_golden` writes them.

What they decode to is compared with the input here, and positions with the second decoder, which
solves densely; what is stored of it, arrays and words, with what they decode to in `test_golden`.
"""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import spec_decoder
from graphs import tolerances_of
from polygon_meshes import MADE, mesh_of, quad_torus, quads

from deltamesh import decode
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.polymesh.mesh import Parts

BOUNDS = {"anchors": 1, "normal_error": 8.0, "max_error_rel": 1e-3}
# Short, and with few letters that come again: deflate makes nothing of them, and the bytes of the
# files are those of any build of zlib.
WORDS = {
    "comments": (" x", "", "é\N{SNOWMAN}\U0001f4d0"),
    "": ("\0\x1b[2J\r\n",),
    "\udcff": ("\ud800",),
}


def shuffled(mesh):
    """Vertices, polygons and where these begin in another order, parts of it in runs."""
    rng = np.random.default_rng(513)
    n, count = len(mesh.vertices), len(mesh.sizes)
    names, order = rng.permutation(n), rng.permutation(count)
    names[n // 2 :].sort()
    order[count // 3 :].sort()
    rows = np.split(mesh.corners, mesh.offsets[1:-1])
    V = np.empty_like(mesh.vertices)
    V[names] = mesh.vertices
    return mesh_of(V, [np.roll(names[rows[i]], -rng.integers(4)).tolist() for i in order])


def with_parts(mesh):
    """Every kind of parts: in rows or anywhere, all faces or some, moved or not."""
    count = len(mesh.sizes)
    i = np.arange(count)
    moves = np.random.default_rng(16).normal(size=(3, 4, 4))
    moves[1] = np.eye(4)
    moves[2, :3, 3] = 1e-300, -0.0, np.nan
    parts = (
        Parts("object", ("ab", "", "ab"), 3 * i // count, moves),
        Parts("mesh", ("Öl", "\x1b\0", "\udcff"), i % 4 - 1),
        Parts("group", ("a", "no", "c", "d"), np.array([3, 0, 1])[7 * i // count % 3]),
        Parts(
            "material",
            ("r", "s.t", "-", "ü", "(v)"),
            np.random.default_rng(5).integers(-1, 5, count),
        ),
        Parts("smoothing", ("1",), np.where(i > count // 2, 0, -1)),
    )
    return replace(mesh, parts=parts, metadata={"k": ("v",)}, lost=("lines",))


def single(mesh):
    V = mesh.vertices.astype("f4").astype("f8")
    return replace(mesh, vertices=V, precision="float32")


def polymeshes():
    """Name, mesh and options of each golden file; the name begins with the method."""
    grid, torus, prism = quads(6, 5), quad_torus(7, 6), MADE["prism"]
    parts = with_parts(quads(5, 5))
    names = tuple(f"a part of a name that comes again {i}" for i in range(6))
    group = Parts("group", names, 6 * np.arange(20) // 20)
    counted = tuple(f"Object_{i:03}" for i in range(20))
    zstd = Parts("group", counted, np.arange(20))
    only = Parts("object", ("an object",), np.zeros(20, int))
    return [
        ("cartesian-quads", grid, {}),
        ("highpass-quads", torus, {"bits": 8}),
        ("refined-quads", torus, {}),
        ("refined-quads-corrected", quads(12, 12), BOUNDS),
        ("lossless-quads", torus, {}),
        ("cartesian-ngons", prism, {}),
        ("highpass-ngons", MADE["mixed"], {"anchors": 3}),
        ("lossless-ngons", prism, {}),
        ("cartesian-ngons-listed", MADE["tetrahedra"], {"bits": 8}),
        ("cartesian-ngons-collapsed", MADE["repeated_vertices"], {}),
        ("cartesian-quads-moebius", MADE["moebius"], {}),
        ("cartesian-quads-doubled", MADE["doubled"], {}),
        ("cartesian-quads-order", shuffled(torus), {"keep_order": True}),
        ("highpass-ngons-order", shuffled(MADE["fan"]), {"keep_order": True, "anchors": 4}),
        ("lossless-ngons-order", shuffled(MADE["mixed"]), {"keep_order": True}),
        ("cartesian-parts", parts, {}),
        ("lossless-parts-single-order", single(parts), {"keep_order": True}),
        ("refined-parts", replace(parts, metadata={}, lost=()), {}),
        ("cartesian-parts-one", replace(quads(5, 6), parts=(only,)), {}),
        ("cartesian-parts-deflated", replace(quads(5, 6), parts=(group,)), {}),
        ("cartesian-parts-zstd", replace(quads(5, 6), parts=(zstd,)), {}),
        ("cartesian-words", replace(quads(3, 3), metadata=WORDS, lost=("\x7f", "Ω")), {}),
    ]


def told(mesh):
    """The words of a mesh, as JSON: lone surrogates come back, too."""
    parts = [(part.kind, part.names, part.transforms is not None) for part in mesh.parts]
    return json.dumps([parts, list(mesh.metadata.items()), mesh.lost, mesh.precision])


def stored(mesh):
    """What is stored of a mesh beside its file."""
    small = {"corners": mesh.corners.astype(np.uint16), "offsets": mesh.offsets.astype(np.uint16)}
    of_face = [part.of_face for part in mesh.parts]
    moved = [part.transforms.ravel() for part in mesh.parts if part.transforms is not None]
    return small | {
        "vertices": mesh.vertices,
        "of_face": np.array(of_face, dtype=np.int16),
        "transforms": np.concatenate([np.zeros(0), *moved]),
        "told": np.array(told(mesh)),
    }


def assert_right(name, mesh, encoded):
    """Compare what a file decodes to with what does not come from the decoder."""
    container, decoded = read_container(encoded.data), decode(encoded.data)
    rows, found = (np.split(m.corners, m.offsets[1:-1]) for m in (mesh, decoded))
    for row, face, turn in zip(found, encoded.face_order, encoded.rotation, strict=True):
        assert encoded.order[row].tolist() == np.roll(rows[face], -turn).tolist()
    assert told(decoded) == told(mesh)
    for own, part in zip(mesh.parts, decoded.parts, strict=True):
        np.testing.assert_array_equal(part.of_face, own.of_face[encoded.face_order])
        assert own.transforms is None or part.transforms.tobytes() == own.transforms.tobytes()
    V = mesh.vertices[encoded.order]
    if container.parameters.method == "lossless":
        assert decoded.vertices.tobytes() == V.tobytes()
    if container.parameters.method == "cartesian":
        assert np.abs(decoded.vertices - V).max() <= 0.500001 * container.parameters.step
    if "order" in name:
        assert [row.tolist() for row in found] == [row.tolist() for row in rows]
    vertices = spec_decoder.decode(encoded.data)[0]
    assert (np.abs(vertices - decoded.vertices) <= tolerances_of(encoded.data, decoded)).all()
    payloads = {key: bytes(section.payload) for key, section in container.sections.items()}
    assert ("corrected" in name) == ("FIXS" in payloads)
    assert ("POLY" in payloads) == (max(mesh.sizes) > 3)
    assert ("PART" in payloads) == bool(mesh.parts or mesh.metadata or mesh.lost)
    if "PART" in payloads:
        assert payloads["PART"][0] == ("deflated" in name) + 2 * ("zstd" in name)
        for part in mesh.parts:
            moves = [] if part.transforms is None else part.transforms
            moved = [m.view(np.uint8) for m in moves if m.tobytes() != np.eye(4).tobytes()]
            planes = np.reshape(moved, (len(moved), 128)).astype(np.uint8).T.tobytes()
            assert planes in payloads["PART"]  # as they are
    return decoded
