"""The decoder in JavaScript against that in Python: golden files, refused files, damaged files."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import animated
import children
import forging
import meshes
import numpy as np
import posed
import pytest
from graphs import tolerances_of
from places import GOLDEN, REFUSED

from deltamesh import decode, edit, encode, frames, from_arrays
from deltamesh._measures.metrics import diagonal
from deltamesh_formats.container.pose_table import entries_of
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import DeltameshError
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh

TABLE = (REFUSED / "expected.tsv").read_text(encoding="utf-8").splitlines()[1:]
HERE = Path(__file__).parent
# The messages of other programs, of which Python has those of zlib.
OTHER_WORDS = {"parts-no-deflate"}
ARRAYS = {
    "Uint8Array": "u1",
    "Uint16Array": "u2",
    "Uint32Array": "u4",
    "BigUint64Array": "u8",
    "Int8Array": "i1",
    "Int16Array": "i2",
    "Int32Array": "i4",
    "BigInt64Array": "i8",
    "Float32Array": "f4",
    "Float64Array": "f8",
}


def decoded_by_node(
    node: str, package: Path, folder: Path, paths: list[Path], memory: str = "", frame: str = ""
) -> list[dict[str, Any]]:
    """Return what comes of files, one after the other, with arrays where meshes have some."""
    folder.mkdir()
    lines = "".join(f"{path}\t{memory}\t{frame}\n" for path in paths)
    command = [node, str(HERE / "decode_all.mjs"), str(package), str(folder)]
    done = children.run(command, given=lines.encode(), text=True)
    assert done.stderr == ""
    results = [json.loads(line, object_hook=_array) for line in done.stdout.splitlines()]
    assert len(results) == len(paths)
    return results


def _array(found: dict[str, Any]) -> Any:
    if found.keys() == {"kind", "file"}:
        return np.fromfile(found["file"], "<" + ARRAYS[found["kind"]])
    return found


@pytest.fixture(scope="module")
def golden(
    node: str, package: Path, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, dict[str, Any]]:
    paths = sorted(GOLDEN.glob("*.dmesh"))
    folder = tmp_path_factory.mktemp("golden") / "arrays"
    found = decoded_by_node(node, package, folder, paths)
    return {path.stem: one for path, one in zip(paths, found, strict=True)}


@pytest.mark.parametrize("name", sorted(path.stem for path in GOLDEN.glob("*.dmesh")))
def test_golden_file_decodes_alike(name: str, golden: dict[str, dict[str, Any]]) -> None:
    data = (GOLDEN / f"{name}.dmesh").read_bytes()
    # The digest of all integers has been checked: it is wrong for any other.
    assert "error" not in golden[name], golden[name]["error"]
    assert_alike(golden[name]["mesh"], decode(data), data)
    about = golden[name]["about"]
    container = read_container(data)
    entries = entries_of(container)
    assert [(one["name"], one["step"], one["bytes"]) for one in about["poses"]] == [
        (entry.name, entry.step, entry.size) for entry in entries
    ]
    for entry, found in zip(entries, golden[name]["poses"], strict=True):
        mesh = decode(data, pose=entry.name)
        allowed = posed.tolerances(data, decode(data))
        assert (np.abs(found["positions"].reshape(-1, 3) - mesh.vertices) <= allowed).all()
    assert (about["frames"], about["fps"]) == (container.frame_count, container.fps)
    assert_frames_alike(golden[name]["frames"], data)
    assert about["parameters"]["method"] == container.parameters.method
    assert [one["id"] for one in about["sections"]] == list(container.sections)
    assert [one["bytes"] for one in about["sections"]] == [
        section.size for section in container.sections.values()
    ]


def assert_alike(found: dict[str, Any], mesh: PolyMesh, data: bytes) -> None:
    """Compare a mesh of JavaScript with that of Python, of the same file."""
    container = read_container(data)
    np.testing.assert_array_equal(found["corners"], mesh.corners)
    np.testing.assert_array_equal(found["offsets"], mesh.offsets)
    V = found["positions"].reshape(-1, 3)
    assert (np.abs(V - mesh.vertices) <= tolerances_of(data, mesh)).all()
    assert len(found["attributes"]) == len(mesh.attributes)
    for one, attribute in zip(found["attributes"], mesh.attributes, strict=True):
        assert_attribute_alike(one, attribute)
    for one, parts in zip(found["parts"], mesh.parts, strict=True):
        assert (one["kind"], one["names"]) == (parts.kind, list(parts.names))
        np.testing.assert_array_equal(one["ofFace"], parts.of_face)
        assert (one["transforms"] is None) == (parts.transforms is None)
        if parts.transforms is not None:
            assert one["transforms"].tobytes() == parts.transforms.tobytes()
    assert found["metadata"] == {key: list(lines) for key, lines in mesh.metadata.items()}
    assert (found["lost"], found["precision"]) == (list(mesh.lost), mesh.precision)
    assert len(found["anchors"]) == container.parameters.anchor_count


def assert_frames_alike(found: list[dict[str, Any]], data: bytes) -> None:
    """Compare the frames beyond the first, which may differ by the sums of what each may."""
    container = read_container(data)
    assert len(found) == len(container.frames)
    first = decode(data)
    allowed = zero = tolerances_of(data, first)
    for one, frame, mesh in zip(found, container.frames, list(frames(data))[1:], strict=True):
        coarser = max(1.0, frame.step / container.parameters.step)
        larger = max(1.0, diagonal(mesh.vertices) / diagonal(first.vertices))
        allowed = (zero if frame.is_key else allowed) + zero * max(coarser, larger)
        V = one["positions"].reshape(-1, 3)
        assert (np.abs(V - mesh.vertices) <= allowed).all()
        assert np.abs(V - first.vertices).max() > 100 * allowed.max()
        np.testing.assert_array_equal(one["corners"], mesh.corners)
        for own, attribute in zip(one["attributes"], mesh.attributes, strict=True):
            assert_attribute_alike(own, attribute)


def assert_attribute_alike(found: dict[str, Any], attribute: Attribute) -> None:
    facts = found["name"], found["domain"], found["role"], found["width"], found["normalized"]
    a = attribute
    assert facts == (a.name, a.domain, a.role, a.width, a.normalized)
    assert found["type"] == a.values.dtype.name
    rows = a.rows()
    has = rows >= 0
    np.testing.assert_array_equal(np.ones(len(rows)) if found["has"] is None else found["has"], has)
    values = a.values[rows[has]]
    if values.dtype.kind == "c":
        values = values.view(values.real.dtype)
    if values.dtype == np.float16:
        values = values.astype(np.float32)
    own = found["values"].reshape(len(rows), values.shape[1])[has]
    if a.role == "normal" and a.margin:
        np.testing.assert_allclose(own, values, rtol=0, atol=1e-7)
    elif values.dtype.kind == "f":
        # NaNs are as they are, but for their payloads, which JavaScript does not keep.
        np.testing.assert_array_equal(own, values)
        assert (np.signbit(own) == np.signbit(values))[~np.isnan(values)].all()
    else:
        np.testing.assert_array_equal(own, values)


@pytest.fixture(scope="module")
def refused(
    node: str, package: Path, tmp_path_factory: pytest.TempPathFactory
) -> list[dict[str, Any]]:
    paths = [REFUSED / f"{row.split(chr(9))[0]}.dmesh" for row in TABLE]
    return decoded_by_node(node, package, tmp_path_factory.mktemp("refused") / "arrays", paths)


@pytest.mark.parametrize("k", range(len(TABLE)), ids=lambda k: TABLE[k].split("\t")[0])
def test_refused_file_is_refused_alike(k: int, refused: list[dict[str, Any]]) -> None:
    name, kind, offset, message = TABLE[k].split("\t")
    error = refused[k]["error"]
    assert error["name"] == kind
    assert error["offset"] == (int(offset) if offset else None)
    if name in OTHER_WORDS:
        message = message[: message.rindex(": ")]
    assert error["message"].startswith(message)


def test_damaged_files_are_refused_alike(node: str, package: Path, tmp_path: Path) -> None:
    """Payloads with a byte changed, and right checksums around it."""
    generator = np.random.default_rng(7)
    files = sorted(GOLDEN.glob("*.dmesh"))
    paths, expected = [], []
    for k in range(160):
        data = files[k % len(files)].read_bytes()
        sections = list(read_container(data).sections.values())
        section = sections[generator.integers(len(sections) - 1)]
        payload = bytearray(section.payload)
        if not payload:
            continue
        payload[generator.integers(len(payload))] ^= 1 << int(generator.integers(8))
        own = forging.section(section.id, bytes(payload))
        damaged = data[: section.offset] + own + data[section.end :]
        try:
            decode(damaged, memory=1 << 31)
        except DeltameshError as error:
            expected.append((type(error).__name__, getattr(error, "offset", None)))
        else:
            expected.append(("", None))
        paths.append(tmp_path / f"{k}.dmesh")
        paths[-1].write_bytes(damaged)
    found = decoded_by_node(node, package, tmp_path / "arrays", paths, str(1 << 31))
    assert len(paths) > 100
    assert sum(name != "" for name, _ in expected) > 80
    for path, one, (name, offset) in zip(paths, found, expected, strict=True):
        error = one.get("error", {"name": "", "offset": None})
        assert (error["name"], error["offset"]) == (name, offset), (path, error)


def test_a_vertex_of_many_neighbours_is_solved_for(
    node: str, package: Path, tmp_path: Path
) -> None:
    """Its row of the normal equations would have ten million entries."""
    n = 3200
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    rim = np.stack([np.cos(t), np.sin(t), 0.1 * np.sin(9 * t)], axis=1)
    V = np.concatenate([[[0, 0, 1.0]], rim, [[0, 0, -1.0]]])
    i = np.arange(n)
    top = np.stack([0 * i, 1 + i, 1 + (i + 1) % n], axis=1)
    bottom = np.stack([0 * i + n + 1, 1 + (i + 1) % n, 1 + i], axis=1)
    data = encode(V, np.concatenate([top, bottom]), method="highpass", bits=8, anchors=20)
    path = tmp_path / "hub.dmesh"
    path.write_bytes(data)
    data = edit(data, [([0], [0.1, 0, 0.2])], [[n // 2]], name="a").data
    path.write_bytes(data)
    (found,) = decoded_by_node(node, package, tmp_path / "arrays", [path])
    assert_alike(found["mesh"], decode(data), data)
    V, wanted = found["poses"][0]["positions"].reshape(-1, 3), decode(data, pose="a")
    np.testing.assert_allclose(V, wanted.vertices, atol=1e-8)


@pytest.mark.parametrize("domain", ["vertex", "corner", "face"])
def test_normals_turn_alike(node: str, package: Path, tmp_path: Path, domain: str) -> None:
    data = posed.with_poses(encode(posed.with_normals(domain), method="highpass", anchors=9))
    path = tmp_path / "normals.dmesh"
    path.write_bytes(data)
    (found,) = decoded_by_node(node, package, tmp_path / "arrays", [path])
    for name, one in zip(posed.NAMES, found["poses"], strict=True):
        wanted = decode(data, pose=name).attributes[0]
        assert wanted.domain == domain
        own = one["attributes"][0]["values"].reshape(-1, 3)
        np.testing.assert_allclose(own, wanted.values, atol=1e-5)


MOVING = animated.moving(meshes.torus(12, 9), 8, each=0.1)


@pytest.mark.parametrize("method", ["refined", "highpass", "cartesian"])
@pytest.mark.parametrize(
    "options",
    [
        {"step": 0.05, "key_every": 3, "solution": "interpolated"},
        {"step": 0.05, "key_every": 255, "solution": "least-squares"},
        {"quality": 6, "keep_order": True},
    ],
)
def test_frames_decode_alike(
    node: str, package: Path, tmp_path: Path, method: str, options: dict[str, Any]
) -> None:
    path = tmp_path / "walk.dmesh"
    path.write_bytes(encode(MOVING, method=method, **options))
    (found,) = decoded_by_node(node, package, tmp_path / "arrays", [path])
    assert "error" not in found, found["error"]
    assert_frames_alike(found["frames"], path.read_bytes())


def test_frames_on_finer_and_coarser_grids_decode_alike(
    node: str, package: Path, tmp_path: Path
) -> None:
    V, F = meshes.torus(24, 18)
    given = [from_arrays(V * size, F) for size in (1, 1.2, 2e-4, 1.1)]
    paths = []
    for method, options in (("refined", {}), ("cartesian", {"quality": 5})):
        paths.append(tmp_path / f"{method}.dmesh")
        paths[-1].write_bytes(encode(given, method=method, keep_order=True, **options))
    found = decoded_by_node(node, package, tmp_path / "arrays", paths)
    for path, one in zip(paths, found, strict=True):
        data = path.read_bytes()
        assert len({frame.finer for frame in read_container(data).frames}) > 1
        assert_frames_alike(one["frames"], data)


def test_frames_with_streams_that_are_wrong_are_refused_alike(
    node: str, package: Path, tmp_path: Path
) -> None:
    """Their records have right checksums, so that only decoding the frame shows it."""
    generator = np.random.default_rng(5)
    refined, cartesian = (animated.file_of(f"{name}-sequence") for name in ("refined", "cartesian"))
    files = [
        animated.with_first(refined, digest=bytes(8)),
        animated.with_first(refined, maps=0),
        animated.with_first(refined, rounds=0, unit=0),
        animated.with_first(refined, step=1e160),
        animated.with_first(cartesian, digest=bytes(8)),
    ]
    for k in range(60):
        data = (refined, cartesian)[k % 3 == 2]
        (frame, *_) = read_container(data).frames
        names = list(frame.sections)
        name = names[generator.integers(len(names))]
        payload = bytearray(frame.sections[name].payload)
        if not payload:
            continue
        payload[generator.integers(len(payload))] ^= 1 << int(generator.integers(8))
        section = replace(frame.sections[name], payload=memoryview(bytes(payload)))
        files.append(animated.with_first(data, sections={**frame.sections, name: section}))
    paths, expected = [], []
    for k, data in enumerate(files):
        paths.append(tmp_path / f"{k}.dmesh")
        paths[-1].write_bytes(data)
        expected.append(None)
        try:
            decode(data, frame=1)
        except DeltameshError as error:
            expected[-1] = (type(error).__name__, str(error), getattr(error, "offset", None))
    found = decoded_by_node(node, package, tmp_path / "arrays", paths, frame="1")
    assert sum(one is not None for one in expected) > 50
    for path, one, wanted in zip(paths, found, expected, strict=True):
        error = one.get("error")
        own = error and (error["name"], error["message"], error["offset"])
        assert own == wanted, (path, error)


def test_frames_that_are_missing_are_refused(node: str, package: Path, tmp_path: Path) -> None:
    path = GOLDEN / "refined-sequence.dmesh"
    for frame in ("4", "-1", "0.5"):
        (one,) = decoded_by_node(node, package, tmp_path / frame, [path], frame=frame)
        assert one["error"]["name"] == "DeltameshError"
        assert one["error"]["message"] == f"there is no frame {frame}: the file has 4, from 0 on"


def test_frames_decode_in_a_worker(node: str, package: Path) -> None:
    path = GOLDEN / "refined-sequence.dmesh"
    done = children.run(
        [node, str(HERE / "decode_in_worker.mjs"), str(package), str(path)], text=True
    )
    assert done.stderr == ""
    wanted = "4 DeltameshError: there is no frame 4: the file has 4, from 0 on"
    assert done.stdout.strip() == wanted


@pytest.mark.parametrize("keep_order", [False, True])
def test_the_next_frame_costs_no_more_than_that(
    node: str, package: Path, tmp_path: Path, keep_order: bool
) -> None:
    path = tmp_path / "walk.dmesh"
    options = {"method": "refined", "step": 0.05, "key_every": 4, "keep_order": keep_order}
    path.write_bytes(encode(animated.moving(meshes.torus(9, 7), 7), **options))
    done = children.run([node, str(HERE / "play_all.mjs"), str(package), str(path)], text=True)
    assert done.stderr == ""
    forth, back = [0, 1, 1, 1, 1, 1, 1], [0, 2, 1, 3, 2, 1, 0]
    assert json.loads(done.stdout) == [*forth, *back, 2, 1, 2]  # 1 to 3, 3 to 1, and 1 to 3


def test_wrong_arguments_are_named(node: str, package: Path) -> None:
    path = GOLDEN / "refined-sequence.dmesh"
    command = [node, str(HERE / "wrong_arguments.mjs"), str(package), str(path)]
    done = children.run(command, text=True)
    assert done.stderr == ""
    needed = "TypeError: a Uint8Array, or an ArrayBuffer, with the bytes of a file is needed"
    assert done.stdout.splitlines() == [
        "buffer: decoded",
        *(f"{name}: {needed}" for name in ("nothing", "list", "text", "frames", "worker")),
        "memory: DeltameshError: memory must be a number from 0 on, not much",
        "maxVertices: DeltameshError: maxVertices must be a number from 0 on, not NaN",
    ]


def test_limits_are_kept(node: str, package: Path, tmp_path: Path) -> None:
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    path = tmp_path / "a.dmesh"
    path.write_bytes(encode(V, F))
    (one,) = decoded_by_node(node, package, tmp_path / "arrays", [path], "1000000")
    with pytest.raises(DeltameshError) as caught:
        decode(path.read_bytes(), memory=1_000_000)
    assert one["error"]["name"] == "LimitError"
    assert one["error"]["message"] == str(caught.value)
