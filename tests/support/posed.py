"""Files with poses: golden ones, and ones that are refused."""

from __future__ import annotations

import struct
from dataclasses import replace

import forging
import meshes
import numpy as np
from graphs import tolerances_of
from rotations_oracle import matrix_of

from deltamesh import decode, edit, encode
from deltamesh._measures.metrics import diagonal
from deltamesh._pipeline.decoder import read_content
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.pose_table import entries_of, write_poses
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.polymesh.arrays import from_arrays
from deltamesh_formats.polymesh.mesh import from_triangles

NAMES = ("gebückt", "dragged")


def turned(V):
    """A matrix that turns by a third of a turn about the middle of V, and shifts."""
    matrix = np.eye(4)
    matrix[:3, :3] = matrix_of(np.array([0.5, 0.5, 0.5, 0.5]))
    middle = V.mean(axis=0)
    matrix[:3, 3] = middle - matrix[:3, :3] @ middle + [0.2, 0, 0.4]
    return matrix


def with_poses(data, names=NAMES):
    """A file with two poses more: one end is turned, a vertex is dragged."""
    mesh = decode(data)
    used = np.zeros(len(mesh.vertices), dtype=bool)
    used[mesh.corners] = True
    x = np.where(used, mesh.vertices[:, 0], 0)
    moved, fixed = x > 0.6 * x.max(), x < 0.6 * x.min()
    matrix = turned(mesh.vertices[moved])
    data = edit(data, [(moved, matrix)], [fixed], name=names[0]).data
    return edit(data, [([int(x.argmax())], [0.3, 0, 0.2])], [fixed], name=names[1]).data


def with_normals(domain):
    """A torus with unit normals."""
    V, F = meshes.torus(9, 5)
    spokes = V * [1, 1, 0]
    normals = V - 2 * spokes / np.linalg.norm(spokes, axis=1, keepdims=True)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    rows = {"vertex": normals, "corner": normals[F].reshape(-1, 3), "face": normals[F[:, 0]]}
    return from_arrays(V, F, **{domain: {"normal": rows[domain].astype(np.float32)}})


def golden():
    """Name and bytes of each golden file."""
    torus = from_triangles(*meshes.torus(9, 5))
    many = from_triangles(
        *meshes.with_isolated(meshes.union(meshes.torus(7, 4), meshes.grid(3, 3)))
    )
    return [
        ("refined-poses", with_poses(encode(torus, method="refined", bits=8, anchors=9))),
        (
            "highpass-poses-order",
            with_poses(encode(many, method="highpass", bits=8, anchors=9, keep_order=True)),
        ),
    ]


def refused():
    """Files whose poses no encoder has written, by their names."""
    small = from_triangles(*meshes.icosphere(1))
    one = encode(small, method="highpass", bits=6, anchors=4)
    data = edit(one, [([3], [0.5, 0, 0])], [[7]], name="ab").data
    other = encode(small, method="cartesian", bits=6)
    (entry,) = entries_of(read_container(data))
    stream, raw = bytes(entry.stream), bytes(read_container(data).sections["POSE"].payload)

    def named(name):
        return write_poses([replace(entry, name="xx")]).replace(b"\2xx", bytes([len(name)]) + name)

    def fields(step=entry.step, octaves=entry.octaves, size=None, stream=stream):
        size = len(stream) if size is None else size
        return b"\2ab" + struct.pack("<dB", step, octaves) + write_varint(size) + stream

    payloads = {
        "empty": b"",
        "cut": raw[:-1],
        "cut-in-fields": raw[:7],
        "and-zero": fields(stream=stream + b"\0"),
        "and-more": raw + b"\1",
        "longer": fields(size=len(stream) + 9),
        "noise": fields(stream=bytes(range(1, 41))),
        "nameless": named(b""),
        "name-control": named(b"a\x1b["),
        "name-not-utf8": named(b"a\xff"),
        "name-twice": raw + raw,
        "step-zero": fields(step=0.0),
        "step-negative": fields(step=-1.0),
        "step-infinite": fields(step=float("inf")),
        "step-another": fields(step=2 * entry.step),
        "octaves": fields(octaves=25),
        "octaves-another": fields(octaves=entry.octaves - 1),
    }
    files = {f"poses-{name}": forging.forged(data, POSE=raw) for name, raw in payloads.items()}
    files["poses-huge"] = forging.forged(data, POSE=fields(step=1e151))
    return files | {"poses-of-cartesian": inserted(other, "meta", raw)}


def inserted(data, before, payload):
    """The file with poses before another section."""
    container = read_container(data)
    at = container.sections[before].offset
    return data[:at] + forging.section("POSE", payload) + data[at:]


def tolerances(data, mesh):
    """By how much positions of a pose may differ, by vertex: ten times as far as at rest."""
    return 10 * tolerances_of(data, mesh) + 1e-9 * diagonal(mesh.vertices)


def numbers_of(data):
    """The integers of the poses of a file."""
    return [pose.numbers for pose in read_content(read_container(data), 1 << 40, 1 << 50).poses]
