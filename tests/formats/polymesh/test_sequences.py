"""Sequences: what has to be the same in all frames, and what is kept of what need not be."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import pytest
from animated import moving

from deltamesh import from_arrays
from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh.mesh import Attribute, Parts
from deltamesh_formats.polymesh.sequences import joined

FRAMES = moving(meshes.grid(4, 4), 3)


def same(mesh):
    return mesh


def with_attribute(mesh, values, name="quality", role="other"):
    own = Attribute(name, "vertex", np.asarray(values, dtype=np.float32), role)
    return replace(mesh, attributes=(*mesh.attributes, own))


def test_the_first_frame_and_positions_of_the_others() -> None:
    first, positions = joined(iter(FRAMES), same)
    assert first.vertices is FRAMES[0].vertices
    assert [p is frame.vertices for p, frame in zip(positions, FRAMES[1:], strict=True)] == [
        True,
        True,
    ]


def test_frames_are_checked_and_named() -> None:
    def refuse(mesh):
        if mesh is FRAMES[1]:
            raise MeshError("it is at fault")
        return mesh

    with pytest.raises(MeshError, match=r"^frame 1: it is at fault$"):
        joined(FRAMES, refuse)
    with pytest.raises(MeshError, match="frame 1: int is no PolyMesh"):
        joined([FRAMES[0], 3], same)
    with pytest.raises(MeshError, match="without frames"):
        joined([], same)


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (lambda V, F: (V[:-1], F[:4]), "frame 1: 15 vertices, where frame 0 has 16"),
        (lambda V, F: (V, F[:-1]), "frame 1: 17 faces, where frame 0 has 18"),
        (lambda V, F: (V, np.roll(F, 1, axis=1)), "frame 1: face 0 has other vertices"),
        (lambda V, F: (V, F[[*range(7), 8, 7, *range(9, 18)]]), "frame 1: face 7 has other"),
    ],
)
def test_another_connectivity_is_refused_with_frame_and_face(other, message) -> None:
    V, F = meshes.grid(4, 4)
    with pytest.raises(MeshError, match=message):
        joined([from_arrays(V, F), from_arrays(*other(V, F))], same)


def test_other_corners_are_refused() -> None:
    V = np.zeros((5, 3))
    one, other = (
        from_arrays(V, [[0, 1, 2, 3], [0, 1, 4]]),
        from_arrays(V, [[0, 1, 2], [0, 1, 4, 3]]),
    )
    with pytest.raises(MeshError, match="face 0 has 3 corners, where frame 0 has 4"):
        joined([one, other], same)


def test_attributes_that_are_alike_are_kept_and_others_named() -> None:
    n = len(FRAMES[0].vertices)
    kept = [with_attribute(frame, np.ones((n, 1)), "weight") for frame in FRAMES]
    frames = [with_attribute(f, np.full((n, 3), i), "normal", "normal") for i, f in enumerate(kept)]
    frames[2] = with_attribute(frames[2], np.ones((n, 1)), "late")
    first, _ = joined(frames, same)
    assert [one.name for one in first.attributes] == ["weight"]
    assert first.lost == ("normals that differ between frames", "late of vertices of some frames")


def test_an_attribute_that_comes_back_is_still_not_in_all_frames() -> None:
    n = len(FRAMES[0].vertices)
    frames = [with_attribute(frame, np.ones((n, 1))) for frame in FRAMES]
    frames[1] = FRAMES[1]
    first, _ = joined(frames, same)
    assert first.attributes == ()
    assert first.lost == ("quality of vertices that differ between frames",)


def test_parts_and_metadata_are_compared() -> None:
    of_face = np.zeros(len(FRAMES[0].sizes), dtype=np.int64)
    own = Parts("object", ("a",), of_face)
    frames = [replace(f, parts=(own,), metadata={"comments": ["x"]}) for f in FRAMES]
    first, _ = joined(frames, same)
    assert (first.parts, first.metadata, first.lost) == ((own,), {"comments": ["x"]}, ())
    moved = replace(own, transforms=np.eye(4)[None] * 2)
    frames[1] = replace(frames[1], parts=(moved,), metadata={"comments": ["y"], "copyright": ["z"]})
    first, _ = joined(frames, same)
    assert (first.parts, first.metadata) == ((), {})
    assert first.lost == (
        "objects that differ between frames",
        "comments that differ between frames",
        "copyright of some frames",
    )


def test_losses_of_all_frames_and_the_finer_precision() -> None:
    frames = [replace(f, lost=(f"thing {i}",), precision="float32") for i, f in enumerate(FRAMES)]
    first, _ = joined(frames, same)
    assert (first.lost, first.precision) == (("thing 0", "thing 1", "thing 2"), "float32")
    first, _ = joined([*frames[:2], replace(frames[2], precision="float64")], same)
    assert first.precision == "float64"
