"""Edits of files: poses that are added, chosen vertices, what stays, and what is refused."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import bars
import meshes
import numpy as np
import posed
import pytest

import deltamesh
from deltamesh import LimitError, MeshError, OptionError, decode, edit, encode, remove_poses
from deltamesh._decode_options import DecodeOptions
from deltamesh._editing import edit_chosen
from deltamesh._handles import indices_of
from deltamesh._limits import check_pose, memory_needed
from deltamesh._measures.metrics import diagonal
from deltamesh._pipeline.decoder import read_content
from deltamesh._posing import check_name, posing_system
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh, from_triangles

BAR = from_triangles(*bars.bar(24, 40))
FILES = {
    "refined": encode(BAR, method="refined", bits=9, anchors=40),
    "highpass": encode(BAR, method="highpass", bits=9, anchors=40),
    "0 bits": encode(BAR, method="highpass", bits=0, anchors=90),
    "kept order": encode(BAR, method="refined", bits=9, anchors=40, keep_order=True),
    "frames": encode(
        [BAR, replace(BAR, vertices=1.1 * BAR.vertices)], bits=9, method="highpass", anchors=40
    ),
    "random": encode(BAR, method="highpass", bits=9, anchors=40, anchor_method="random", seed=3),
}
DATA = FILES["refined"]
REST = decode(DATA)
TOP, BOTTOM = REST.vertices[:, 2] > 5.7, REST.vertices[:, 2] < 0.3
BENT = np.eye(4)
BENT[:3, :3], middle = bars.EDITS["bend"]
BENT[:3, 3] = np.array(middle) - BENT[:3, :3] @ REST.vertices[TOP].mean(axis=0)


def bent(data: bytes = DATA, **options: object) -> deltamesh.Edited:
    z = decode(data).vertices[:, 2]
    return edit(data, [(z > 5.7, BENT)], [z < 0.3], name="bent", **options)


@pytest.mark.parametrize("name", FILES)
def test_all_but_the_pose_and_the_checksum_stays(name: str) -> None:
    data = FILES[name]
    made = bent(data)
    before, after = read_container(data).sections, read_container(made.data).sections
    changed = {
        key
        for key in after
        if key not in before or bytes(after[key].payload) != bytes(before[key].payload)
    }
    assert changed == {"POSE", "CHEK"}
    assert decode(made.data).vertices.tobytes() == decode(data).vertices.tobytes()


@pytest.mark.parametrize("name", FILES)
def test_the_pose_is_the_edit_as_near_as_its_anchors_are(name: str) -> None:
    made = bent(FILES[name])
    found = decode(made.data, pose="bent")
    np.testing.assert_array_equal(found.vertices, made.mesh.vertices)
    np.testing.assert_array_equal(found.corners, decode(FILES[name]).corners)
    z = decode(FILES[name]).vertices[:, 2]
    wanted = np.c_[decode(FILES[name]).vertices, np.ones(len(z))] @ BENT[:3].T
    scale = diagonal(decode(FILES[name]).vertices)
    assert np.abs(made.exact.vertices - wanted)[z > 5.7].max() < 1e-6 * scale
    assert made.missed < 1e-6
    assert np.abs(found.vertices - wanted)[z > 5.7].max() < 0.01 * scale
    off = np.linalg.norm(found.vertices - made.exact.vertices, axis=1)
    assert made.max == pytest.approx(off.max() / scale)
    assert made.rms == pytest.approx(np.sqrt((off**2).mean()) / scale)
    assert made.rms < 1.5e-3


def test_anchors_that_move_land_within_a_step_of_the_record() -> None:
    made = bent()
    anchors = read_content(read_container(DATA), 1 << 30, 1 << 40).integers.anchors
    missed = made.mesh.vertices[anchors] - made.exact.vertices[anchors]
    assert np.abs(missed).max() < diagonal(REST.vertices) / 4096


def test_a_finer_step_takes_more_bytes_and_comes_nearer() -> None:
    coarse, fine = bent(step=0.1), bent(step=0.001)
    assert coarse.size < fine.size
    assert fine.rms < coarse.rms


def test_a_pose_takes_few_bytes() -> None:
    made = bent()
    assert made.size == len(read_container(made.data).sections["POSE"].payload)
    assert made.anchors == 40
    assert made.size < 0.1 * len(DATA)
    still = edit(DATA, [(TOP, np.eye(4))], [BOTTOM], name="still")
    assert still.size < 30
    np.testing.assert_allclose(still.mesh.vertices, REST.vertices, atol=1e-9)


def test_a_file_has_many_poses() -> None:
    data = bent().data
    for k in range(5):
        shift = [0.1 * k, 0, 0]
        data = edit(data, [(TOP, shift)], [BOTTOM], name=f"shift {k}").data
    container = deltamesh.info(data)
    assert 'poses (6): "bent"' in str(container)
    first = decode(data, pose="bent").vertices
    np.testing.assert_array_equal(first, bent().mesh.vertices)
    x = [decode(container, pose=f"shift {k}").vertices[TOP, 0].mean() for k in range(5)]
    np.testing.assert_allclose(np.diff(x), 0.1, atol=5e-3)
    assert deltamesh.verify(data).digest == container.digest


def test_poses_are_removed_and_all_else_stays() -> None:
    for name, data in FILES.items():
        two = edit(bent(data).data, [(TOP, [0.5, 0, 0])], [BOTTOM], name="two").data
        assert remove_poses(two, "two") == bent(data).data, name
        assert remove_poses(two, ["bent", "two"]) == data, name
        left = deltamesh.info(remove_poses(two, ["bent"]))
        np.testing.assert_array_equal(
            decode(left, pose="two").vertices, decode(two, pose="two").vertices
        )
        assert deltamesh.info(remove_poses(two, ())).digest == deltamesh.info(two).digest
    with pytest.raises(OptionError, match="there is no pose 'none': the poses are 'bent'"):
        remove_poses(bent().data, ["bent", "none"])


def test_sources_are_those_of_verify(tmp_path: Path) -> None:
    path = tmp_path / "a.dmesh"
    path.write_bytes(DATA)
    wanted = bent().data
    for source in (path, str(path), io.BytesIO(DATA), deltamesh.info(DATA), bytearray(DATA)):
        assert edit(source, [(TOP, BENT)], [BOTTOM], name="bent").data == wanted
    path.write_bytes(wanted)
    np.testing.assert_array_equal(
        deltamesh.load(path, pose="bent").vertices, decode(wanted, pose="bent").vertices
    )


def test_vertices_are_chosen_in_all_ways() -> None:
    wanted = bent().data
    for top in (np.flatnonzero(TOP), np.flatnonzero(TOP).tolist(), np.flatnonzero(TOP)[::-1]):
        assert edit(DATA, [(top, BENT)], [BOTTOM], name="bent").data == wanted
    chosen = edit_chosen(
        deltamesh.info(DATA),
        lambda mesh: ([(mesh.vertices[:, 2] > 5.7, BENT)], [mesh.vertices[:, 2] < 0.3]),
        DecodeOptions(),
        name="bent",
    )
    assert chosen.data == wanted


def test_positions_are_those_of_the_list_in_its_order() -> None:
    three = np.array([900, 17, 500])
    target = REST.vertices[three] + [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]
    made = edit(
        DATA, [(three, target)], [BOTTOM & ~np.isin(np.arange(len(BOTTOM)), three)], name="a"
    )
    np.testing.assert_allclose(made.exact.vertices[three], target, atol=1e-7)


def test_a_vertex_that_is_listed_twice_has_one_place() -> None:
    target = REST.vertices[[9, 3, 9]] + 0.1
    made = edit(DATA, [([9, 3, 9], target)], name="a")
    assert made.data == edit(DATA, [([3, 9], target[[1, 0]])], name="a").data


def test_parts_are_chosen_by_their_names() -> None:
    V, F = meshes.union(meshes.torus(9, 7), meshes.icosphere(1))
    of_face = (F[:, 0] >= 63).astype(np.int64)
    mesh = from_triangles(V, F)
    parts = Parts("object", ("ring", "ball"), of_face)
    data = encode(
        PolyMesh(mesh.vertices, mesh.corners, mesh.offsets, parts=(parts,)), method="highpass"
    )
    rest = decode(data)
    moved = edit(data, [("ball", [0, 0, 1.0])], name="up").mesh
    ball = indices_of(rest, "ball")
    assert len(ball) == 42
    shift = moved.vertices - rest.vertices
    np.testing.assert_allclose(shift[ball], [[0, 0, 1]] * 42, atol=1e-3)
    others = np.setdiff1d(np.arange(len(V)), ball)  # a component of which nothing is moved
    np.testing.assert_allclose(shift[others], 0, atol=1e-9)


def test_split_vertices_move_together_and_isolated_ones_stay() -> None:
    V, F = meshes.with_isolated(meshes.grid(6, 6))
    F[::2] = np.where(F[::2] < 6, F[::2] + len(V), F[::2])
    V = np.concatenate((V, V[:6]))
    data = encode(V, F, method="highpass", bits=10, anchors=9)
    rest = decode(data)
    used = np.isin(np.arange(len(rest.vertices)), rest.corners)
    made = edit(data, [(used, [0, 0, 1.0])], name="up")
    shift = made.mesh.vertices - rest.vertices
    np.testing.assert_allclose(shift[used], [[0, 0, 1]] * used.sum(), atol=1e-3)
    np.testing.assert_array_equal(shift[~used], 0)


def test_normals_turn_with_the_surface() -> None:
    data = encode(posed.with_normals("vertex"), method="highpass", bits=10, anchors=9)
    rest = decode(data)
    quarter = np.eye(4)
    quarter[:3, :3] = bars.turn((0, 0, 1), 90)
    found = edit(data, [(np.arange(len(rest.vertices)), quarter)], name="quarter").mesh
    wanted = rest.attributes[0].values @ quarter[:3, :3].T
    np.testing.assert_allclose(found.attributes[0].values, wanted, atol=2e-3)


@pytest.mark.parametrize("solver", ["core", "scipy"])
def test_solvers_agree(solver: str) -> None:
    made = bent(solver=solver)
    np.testing.assert_allclose(made.mesh.vertices, bent().mesh.vertices, atol=2e-4)
    found = decode(bent().data, pose="bent", solver=solver)
    np.testing.assert_allclose(found.vertices, bent().mesh.vertices, atol=1e-8)


REFUSED = {
    "no vertices are moved": ([], []),
    "a move of no vertices": ([([], [0, 0, 1])], []),
    "vertex 3 is moved twice": ([([3], [0, 0, 1]), ([9, 3], [0, 0, 1])], []),
    "vertex 4 is moved, and fixed": ([([4], [0, 0, 1])], [[4]]),
    "vertex 960 of a mesh of 960": ([([960], [0, 0, 1])], []),
    "vertex -1 of a mesh of 960": ([([-1], [0, 0, 1])], []),
    "a mask of shape": ([(np.ones(7, dtype=bool), [0, 0, 1])], []),
    "indices, a mask or a name": ([([0.5], [0, 0, 1])], []),
    "there is no part 'ear'": ([("ear", [0, 0, 1])], []),
    "a matrix that mirrors": ([([3], np.diag([1, 1, -1, 1]))], []),
    "0 0 0 1": ([([3], np.ones((4, 4)))], []),
    "a move of shape": ([([3], [0, 1])], []),
    r"of shape \(2, 3\): it is \(4, 4\), \(3,\) or \(3, 3\)": ([([3, 4, 5], np.ones((2, 3)))], []),
    r"of shape \(3, 3\): it is \(4, 4\), \(3,\) or \(2, 3\)": ([([3, 4], np.eye(3))], []),
    "vertex 9 is put in two places": ([([9, 3, 9], np.eye(3))], []),
    "finite": ([([3], [0, np.nan, 1])], []),
}


@pytest.mark.parametrize("message", REFUSED)
def test_what_cannot_be_moved_is_refused(message: str) -> None:
    moves, fix = REFUSED[message]
    with pytest.raises(OptionError, match=message):
        edit(DATA, moves, fix, name="a")


def test_a_vertex_of_no_face_cannot_be_moved() -> None:
    data = encode(*meshes.with_isolated(), method="highpass", anchors=5)
    lone = int(np.setdiff1d(np.arange(len(decode(data).vertices)), decode(data).corners)[0])
    with pytest.raises(OptionError, match=f"vertex {lone} belongs to no face"):
        edit(data, [([lone], [0, 0, 1])], name="a")


@pytest.mark.parametrize("name", ["", "a\n", "x" * 256, "é" * 128])
def test_names_that_no_pose_has_are_refused(name: str) -> None:
    with pytest.raises(OptionError, match="name"):
        edit(DATA, [([3], [0, 0, 1])], name=name)


def test_a_name_that_is_taken_is_refused() -> None:
    with pytest.raises(OptionError, match="has a pose 'bent' already"):
        bent(bent().data)
    with pytest.raises(OptionError, match="step"):
        edit(DATA, [([3], [0, 0, 1])], name="a", step=0.0)


@pytest.mark.parametrize("method", ["cartesian", "lossless"])
def test_files_without_anchors_take_no_poses(method: str) -> None:
    with pytest.raises(MeshError, match=f"method {method} has none"):
        edit(encode(BAR, method=method), [([3], [0, 0, 1])], name="a")


def test_a_pose_that_is_not_there_is_refused_by_the_names_of_others() -> None:
    with pytest.raises(OptionError, match="no pose 'up': the file has none"):
        decode(DATA, pose="up")
    container = deltamesh.info(bent().data)
    check_name(container, "bent")
    with pytest.raises(OptionError, match="no pose 'up': the poses are 'bent'"):
        decode(container, pose="up")
    with pytest.raises(OptionError, match="may be cut"):
        decode(bent().data, pose="bent", partial=True)


def test_a_pose_needs_memory_that_rest_does_not() -> None:
    container = deltamesh.info(bent().data)
    enough = memory_needed(container)
    decode(container, memory=enough)
    with pytest.raises(LimitError, match="more than the limit"):
        decode(container, pose="bent", memory=enough)
    with pytest.raises(LimitError, match="more than the limit"):
        edit(container, [(TOP, BENT)], name="a", memory=enough)
    more = enough + 2 * (300 << 20)
    assert check_pose(container, more) > 0
    decode(container, pose="bent", memory=more)


def test_many_poses_need_memory_before_they_are_read() -> None:
    """Names and empty streams are cheap; the numbers that they announce are not."""
    data = bent().data
    before = memory_needed(read_container(DATA))
    assert memory_needed(read_container(data)) >= before + 160 * 40


def test_a_factorization_is_refused_before_it_is_made() -> None:
    content = read_content(deltamesh.info(DATA), 1 << 30, 1 << 40)
    with pytest.raises(LimitError, match="MiB"):
        posing_system(content, "auto", None, 1000.0)
