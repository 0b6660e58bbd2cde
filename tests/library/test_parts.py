"""Parts, names, transforms, metadata, losses and precision: round trips and refusals."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import forging
import meshes
import numpy as np
import pytest
import strategies
from annotated import annotated_meshes
from hypothesis import given
from hypothesis import strategies as st
from packed_blocks import deflated, plain

import deltamesh
from deltamesh._limits import memory_needed
from deltamesh_formats.container import texts
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.listing import texts_object
from deltamesh_formats.container.payload_layout import KINDS, MAX_TEXT
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import FormatError, LimitError, MeshError
from deltamesh_formats.meshfiles import files as meshfile
from deltamesh_formats.polymesh.mesh import Kind, Parts, PolyMesh, from_triangles


def test_every_kind_has_a_number() -> None:
    assert set(get_args(Kind)) == set(KINDS)


def bits(transforms: Any) -> Any:
    return None if transforms is None else transforms.view(np.int64).tolist()


def heads(mesh: PolyMesh) -> Any:
    """Everything told of a mesh but which faces it is about."""
    return (
        [(p.kind, p.names, bits(p.transforms)) for p in mesh.parts],
        list(mesh.metadata.items()),
        mesh.lost,
        mesh.precision,
    )


def faces_in_parts(mesh: PolyMesh) -> list[Any]:
    """Each face, by its positions and from its lowest one on, with its part of each kind."""
    points = mesh.vertices[mesh.corners.reshape(-1, 3)].tolist()
    turned = [min([*f[i:], *f[:i]] for i in range(3)) for f in points]
    return sorted(zip(turned, *(p.of_face.tolist() for p in mesh.parts), strict=True))


def with_names(*names: str, of_face: Any = None) -> PolyMesh:
    V, F = meshes.icosphere(1)
    own = np.arange(len(F)) * len(names) // len(F) if of_face is None else of_face
    return replace(from_triangles(V, F), parts=(Parts("group", names, own),))


def sections(data: bytes) -> Any:
    return read_container(data).sections


def part_bytes(mesh: PolyMesh) -> int:
    data = deltamesh.encode(mesh, method="cartesian")
    assert heads(deltamesh.decode(data)) == heads(mesh)
    return sections(data)["PART"].size if "PART" in sections(data) else 0


# ---- Round trips ----------------------------------------------------------------------------


@strategies.SOME
@given(annotated_meshes(), st.booleans())
def test_everything_that_is_told_of_a_mesh_comes_back(mesh: PolyMesh, keep: bool) -> None:
    data = deltamesh.encode(mesh, method="lossless", keep_order=keep)
    found = deltamesh.decode(data)
    assert heads(found) == heads(mesh)
    if keep:
        assert [p.of_face.tolist() for p in found.parts] == [p.of_face.tolist() for p in mesh.parts]
    assert faces_in_parts(found) == faces_in_parts(mesh)
    told = bool(mesh.parts or mesh.metadata or mesh.lost)
    assert ("PART" in sections(data)) == told
    assert texts_object(texts.texts_of(read_container(data)))["not_kept"] == list(mesh.lost)


def test_a_mesh_without_all_this_has_no_such_section() -> None:
    V, F = meshes.icosphere(1)
    assert "PART" not in sections(deltamesh.encode(V, F))
    assert deltamesh.encode(from_triangles(V, F)) == deltamesh.encode(V, F)


def test_the_encoder_says_what_the_decoder_will_make() -> None:
    from deltamesh._options import Options
    from deltamesh._pipeline.encoder import encode_mesh

    mesh = replace(with_names("a", "b"), metadata={"comments": ("x",)}, precision="float32")
    for keep in (False, True):
        made = encode_mesh(mesh, Options(method="lossless", keep_order=keep))
        found = deltamesh.decode(made.data)
        assert heads(made.mesh) == heads(found)
        assert faces_in_parts(made.mesh) == faces_in_parts(found)
        np.testing.assert_array_equal(made.mesh.parts[0].of_face, found.parts[0].of_face)


def test_names_of_any_length_and_number() -> None:
    many = with_names(*(f"part {i}" for i in range(80)), of_face=np.arange(80)[::-1].copy())
    long = with_names("x" * 100_000)
    unused = with_names(*(str(i) for i in range(5000)), of_face=np.full(80, 4321))
    for mesh in (many, long, unused):
        found = deltamesh.decode(deltamesh.encode(mesh, method="lossless"))
        assert heads(found) == heads(mesh)
        assert faces_in_parts(found) == faces_in_parts(mesh)


def test_a_part_costs_little_beside_its_name() -> None:
    halves = part_bytes(with_names("left", "right"))
    assert halves < 50
    assert part_bytes(with_names("all")) == 9 + 11 + 2  # a frame, a text, two empty streams
    mesh = with_names(*(f"{i:03}" for i in range(40)))
    moved = replace(mesh.parts[0], transforms=np.broadcast_to(np.eye(4), (40, 4, 4)).copy())
    assert part_bytes(replace(mesh, parts=(moved,))) - part_bytes(mesh) <= 40 // 8 + 6


# ---- Meshes that are none -------------------------------------------------------------------


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ((Parts("group", ("a",), np.zeros(79, dtype=np.int64)),), r"must be int64 \(80,\)"),
        ((Parts("group", ("a",), np.ones(80, dtype=np.int64)),), "lead out of their 1 names"),
        ((Parts("group", ("a",), np.full(80, -2)),), "lead out of their 1 names"),
        ((Parts("group", ("a",), np.zeros(80, dtype=int), np.ones((2, 4, 4))),), "transforms"),
        ((Parts("group", (), np.full(80, -1)),) * 2, "twice"),
    ],
)
def test_parts_that_are_none_are_refused(parts: tuple[Parts, ...], message: str) -> None:
    mesh = replace(with_names("a"), parts=parts)
    with pytest.raises(MeshError, match=message):
        deltamesh.encode(mesh, method="cartesian")


# ---- Refusals -------------------------------------------------------------------------------


def refused(data: bytes, message: str) -> FormatError:
    with pytest.raises(FormatError, match=message) as caught:
        deltamesh.decode(data)
    assert caught.value.offset is not None
    section = sections(data)["PART"]
    assert section.offset <= caught.value.offset <= section.offset + section.size
    return caught.value


ONE_GROUP = b"\1\2\1\1a\0\0"  # one division, groups, one name, "a"; no metadata; nothing lost
PARTLY = b"\1\x0a\1\1a\0\0"
ZEROS = b"\0" * 600
WHOLE = {
    "nothing": (plain(b"\0\0\0"), "no parts, metadata or losses in the text"),
    "no payload": (b"", "truncated"),
    "form": (b"\3" + write_varint(7) + ONE_GROUP + b"\0\0", "unknown form 3 of a block"),
    "short": (plain(ONE_GROUP[:-1]), "in the text, truncated"),
    "long": (plain(ONE_GROUP + b"\0"), "1 bytes follow the end of the text"),
    "kind": (plain(b"\1\5\0\0\0"), "in the text, unknown kind of parts 5"),
    "reserved": (plain(b"\1\x22\0\0\0"), "in the text, parts of kind group: reserved bits are set"),
    "kind twice": (plain(b"\2\2\0\2\0\0\0"), "parts of kind group come a second time"),
    "key twice": (plain(b"\0\2\1a\0\1a\0\0"), "metadata key 'a' comes a second time"),
    "not UTF-8": (plain(b"\0\0\1\1\xff"), "not UTF-8"),
    "overlong UTF-8": (plain(b"\0\0\1\2\xc0\x80"), "not UTF-8"),
    "many names": (plain(b"\1\2\xff\xff\xff\x7f\0\0"), "in the text, truncated"),
    "size beyond": (b"\0" + write_varint(MAX_TEXT + 1) + ONE_GROUP, "more than 16777216"),
    "size too small": (deflated(b"\0\1\1a" + ZEROS, 500), "another size than 500 bytes"),
    "size too large": (deflated(b"\0\1\1a" + ZEROS, 700), "another size than 700 bytes"),
    "after deflate": (deflated(b"\0\1\1a" + ZEROS, 604, b"\0"), "another size than 604 bytes"),
    "not shorter": (deflated(b"\0\0\1\1a", 5), "a block of 5 bytes packed into"),
    "no deflate": (b"\1\x09\2\xff\xff", "invalid deflate stream"),
    "no labels": (plain(ONE_GROUP), "truncated"),
    "trailing": (plain(ONE_GROUP) + b"\0\0\0", "after the last parts"),
    "zero in labels": (plain(ONE_GROUP) + b"\1\0\0", "zero byte at the end"),
    "zero in order": (plain(ONE_GROUP) + b"\0\1\0", "zero byte at the end"),
    "too many labels": (plain(ONE_GROUP) + b"\1\x80\0", "labels for 1 parts"),
    "none is not there": (plain(PARTLY) + b"\0\1\x80", "no face without a part"),
    "passed over": (plain(ONE_GROUP) + b"\0\1\x80", "non-canonical part number"),
    "moved": (plain(b"\1\x12\1\1a\0\0") + b"\0\0" + plain(b"\0\0"), "transform count differs"),
    "unused bits": (plain(b"\1\x12\1\1a\0\0") + b"\0\0" + plain(b"\2"), "transform count differs"),
    "identity": (
        plain(b"\1\x12\1\1a\0\0") + b"\0\0" + plain(b"\1" + np.eye(4).tobytes()),
        "non-canonical transform: identity",
    ),
}


@pytest.fixture(scope="module")
def plain_file() -> bytes:
    return deltamesh.encode(with_names("a"), method="cartesian")


@pytest.mark.parametrize("name", WHOLE)
def test_payloads_that_are_refused(name: str, plain_file: bytes) -> None:
    payload, message = WHOLE[name]
    refused(forging.forged(plain_file, PART=payload), message)


def test_hand_made_payloads_are_what_they_say(plain_file: bytes) -> None:
    """Those above are refused for what is wrong with them only."""
    good = {
        plain(ONE_GROUP) + b"\0\0": [("group", ("a",), None)],
        plain(PARTLY) + b"\0\0": [("group", ("a",), None)],
        deflated(b"\0\0\1\x80\x08" + b"b" * 1024, 1029): [],
    }
    for payload, parts in good.items():
        found = deltamesh.decode(forging.consistent(forging.forged(plain_file, PART=payload)))
        assert heads(found)[0] == parts
    with pytest.raises(FormatError, match="checksum of the decoded integers"):
        deltamesh.decode(forging.forged(plain_file, PART=plain(PARTLY) + b"\0\0"))


@pytest.mark.parametrize("seed", range(2))
def test_flipped_bytes_are_refused_or_mean_something_else(seed: int) -> None:
    """Whatever decodes is written by no encoder, or is what an encoder writes of it."""
    rng = np.random.default_rng(seed)
    mesh = with_names("a", "bb", "", "bb", of_face=rng.integers(-1, 4, 80))
    transforms = np.array([2.0, 1.0, 1.0, 3.0])[:, None, None] * np.eye(4)
    moved = replace(mesh.parts[0], transforms=transforms)
    mesh = replace(mesh, parts=(moved,), metadata={"comments": ("x", "y")}, lost=("z",))
    data = deltamesh.encode(mesh, method="cartesian")
    payload = bytes(sections(data)["PART"].payload)
    outcomes = [0, 0]
    for at in range(len(payload)):
        changed = bytearray(payload)
        changed[at] ^= 1 << int(rng.integers(8))
        forged = forging.forged(data, PART=bytes(changed))
        try:
            found = deltamesh.decode(forging.consistent(forged))
        except FormatError:
            outcomes[0] += 1
            continue
        outcomes[1] += 1
        again = deltamesh.encode(found, method="cartesian")
        assert heads(deltamesh.decode(again)) == heads(found)
    assert min(outcomes) > 0


def test_a_small_file_does_not_grow_beyond_the_memory(plain_file: bytes) -> None:
    memory = memory_needed(read_container(plain_file))
    text = b"\0\0" + write_varint(2**22) + b"\0" * 2**22
    large = forging.forged(plain_file, PART=deflated(text, len(text)))
    assert len(large) < 20_000
    with pytest.raises(LimitError, match="bytes"):
        deltamesh.decode(large, memory=memory + 2**20)
    names = b"\1\x12" + write_varint(2**18) + b"\0" * 2**18 + b"\0\0"
    moved = forging.forged(plain_file, PART=deflated(names, len(names)) + b"\0\0")
    with pytest.raises(LimitError, match="bytes"):
        deltamesh.decode(moved, memory=memory + 24 * len(names) + 2**26)


# ---- Precision ------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["cartesian", "highpass", "refined", "lossless"])
def test_positions_are_written_in_the_precision_of_the_source(method: str) -> None:
    V, F = meshes.icosphere(2)
    single = replace(from_triangles(V.astype("f4").astype("f8"), F), precision="float32")
    double = replace(single, precision="float64")
    sizes = {}
    for mesh in (single, double):
        found = deltamesh.decode(deltamesh.encode(mesh, method=method))
        assert found.precision == mesh.precision
        written = meshfile.mesh_bytes(found, "ply")
        sizes[mesh.precision] = len(written)
        assert (b"property float x" in written) == (mesh.precision == "float32")
    assert sizes["float64"] - sizes["float32"] == 12 * len(V) + 3  # and "double" for "float"
    lossless = deltamesh.decode(deltamesh.encode(single, method="lossless"))
    assert sorted(lossless.vertices.tolist()) == sorted(single.vertices.tolist())


def test_the_precision_is_all_that_differs() -> None:
    V, F = meshes.icosphere(1)
    double = deltamesh.encode(from_triangles(V, F), method="cartesian")
    single = deltamesh.encode(
        replace(from_triangles(V, F), precision="float32"), method="cartesian"
    )
    assert len(double) == len(single)
    differ = {i for i, s in sections(double).items() if s.payload != sections(single)[i].payload}
    assert differ == {"PARM"}


@pytest.mark.parametrize("name", ["unstated/horse.ply", "cycloidal.ply"])
def test_a_real_file_of_float32_is_one_again(name: str, tmp_path: Path) -> None:
    files = sorted(meshes.folder().rglob(Path(name).name)) if meshes.folder().is_dir() else []
    if not files:
        pytest.skip(f"{name} is not here")
    mesh = meshfile.read_mesh(files[0])
    assert mesh.precision == "float32"
    found = deltamesh.decode(deltamesh.encode(mesh, method="cartesian", bits=12))
    meshfile.write_mesh(tmp_path / "out.ply", found)
    back = meshfile.read_mesh(tmp_path / "out.ply")
    assert back.precision == "float32"
    np.testing.assert_array_equal(back.vertices, found.vertices.astype("f4"))


# ---- Files ----------------------------------------------------------------------------------


@pytest.mark.parametrize("file_format", ["obj", "stl", "glb"])
def test_files_of_several_meshes_keep_their_names(file_format: str) -> None:
    V, F = meshes.union(meshes.icosphere(1), meshes.grid(4, 5), meshes.torus(6, 5))
    V = V.astype("f4").astype("f8")
    objects = np.repeat([0, 1, 2], [80, len(F) - 80 - 60, 60])
    moves = np.array([np.eye(4), np.diag([2.0, 2.0, 2.0, 1.0]), np.eye(4)])
    moves[2, :3, 3] = 1.0, -2.0, 0.5
    part = Parts("object", ("left", "no ascii é", "left"), objects, moves)
    if file_format != "glb":
        part = replace(part, names=("left", "no ascii é", "right"), transforms=None)
    mesh = replace(from_triangles(V, F), parts=(part,))
    first = meshfile.read_mesh(io.BytesIO(meshfile.mesh_bytes(mesh, file_format)), file_format)
    data = deltamesh.encode(first, method="lossless")
    again = meshfile.mesh_bytes(deltamesh.decode(data), file_format)
    second = meshfile.read_mesh(io.BytesIO(again), file_format)
    for found in (first, second):
        assert set(found.parts[0].names) == set(part.names)
    assert by_object(second) == by_object(first) == by_object(mesh)


def by_object(mesh: PolyMesh) -> list[Any]:
    """Of each object its name, its transform, and where its faces are."""
    (part,) = mesh.parts
    points = mesh.vertices[mesh.corners.reshape(-1, 3)].round(5) + 0.0
    moves = np.eye(4)[None].repeat(len(part.names), axis=0)
    moves = moves if part.transforms is None else part.transforms
    faces = [sorted(sorted(f) for f in points[part.of_face == i].tolist()) for i in range(3)]
    return sorted(zip(part.names, moves.tolist(), faces, strict=True))
