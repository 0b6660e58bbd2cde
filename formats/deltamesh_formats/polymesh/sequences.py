"""Sequences: meshes of one connectivity, the frames of something that moves.

What is the same in all frames is kept once, with the first one; positions are kept frame by frame,
and what else differs is named in `lost`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import MeshError, in_frame
from deltamesh_formats.polymesh.descriptions import describe_attribute
from deltamesh_formats.polymesh.kinds import KIND_WORDS
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh


def joined(
    frames: Iterable[PolyMesh], check: Callable[[PolyMesh], PolyMesh]
) -> tuple[PolyMesh, tuple[Floats, ...]]:
    """Return the first of several frames, with what is the same in all, and their positions.

    Parameters
    ----------
    frames : iterable of PolyMesh
    check : callable
        Returns a frame that has been checked, or raises MeshError.

    Returns
    -------
    PolyMesh
    tuple of float64 (n, 3)
        The vertices of all further frames.

    Raises
    ------
    MeshError
        If there is no frame, one is at fault, or has another connectivity than the first; the
        message names the frame, from 0, and the first face that differs.
    """
    first: PolyMesh | None = None
    whole: PolyMesh | None = None
    positions: list[Floats] = []
    for index, given in enumerate(frames):
        if not isinstance(given, PolyMesh):
            what = type(given).__name__
            raise in_frame(MeshError(f"{what} is no PolyMesh"), index)
        try:
            frame = check(given)
        except MeshError as error:
            raise in_frame(error, index) from error
        if first is None or whole is None:
            first = whole = frame
            continue
        difference = _difference(first, frame)
        if difference:
            raise in_frame(MeshError(difference), index)
        positions.append(frame.vertices)
        first = _common(first, frame, whole)
    if first is None:
        raise MeshError("a sequence without frames")
    return first, tuple(positions)


def _difference(first: PolyMesh, frame: PolyMesh) -> str:
    """Return in which way the connectivity of a frame is another one, "" if it is the same."""
    if len(frame.vertices) != len(first.vertices):
        return f"{len(frame.vertices)} vertices, where frame 0 has {len(first.vertices)}"
    if len(frame.sizes) != len(first.sizes):
        return f"{len(frame.sizes)} faces, where frame 0 has {len(first.sizes)}"
    other = np.flatnonzero(frame.sizes != first.sizes)
    if len(other):
        at = other[0]
        return f"face {at} has {frame.sizes[at]} corners, where frame 0 has {first.sizes[at]}"
    corners = np.flatnonzero(frame.corners != first.corners)
    if len(corners):
        face = int(np.searchsorted(first.offsets, corners[0], side="right")) - 1
        return f"face {face} has other vertices than in frame 0"
    return ""


def _common(first: PolyMesh, frame: PolyMesh, whole: PolyMesh) -> PolyMesh:
    """Return the first frame without what another one has not, or not alike.

    The `whole` first frame has what others were lacking, too.
    """
    lost = dict.fromkeys((*first.lost, *frame.lost))
    attributes, parts, metadata = [], [], {}
    for attribute in first.attributes:
        if any(_is_same(attribute, other) for other in frame.attributes):
            attributes.append(attribute)
        else:
            lost[f"{describe_attribute(attribute)} that differ between frames"] = None
    for division in first.parts:
        if any(_is_same_division(division, other) for other in frame.parts):
            parts.append(division)
        else:
            lost[f"{KIND_WORDS[division.kind]} that differ between frames"] = None
    for key, lines in first.metadata.items():
        if list(frame.metadata.get(key, ())) == list(lines):
            metadata[key] = lines
        else:
            lost[f"{key} that differ between frames"] = None
    names = {(one.name, one.domain) for one in whole.attributes}
    for attribute in frame.attributes:
        if (attribute.name, attribute.domain) not in names:
            lost[f"{describe_attribute(attribute)} of some frames"] = None
    kinds = {one.kind for one in whole.parts}
    for division in frame.parts:
        if division.kind not in kinds:
            lost[f"{KIND_WORDS[division.kind]} of some frames"] = None
    for key in frame.metadata.keys() - whole.metadata.keys():
        lost[f"{key} of some frames"] = None
    both = {first.precision, frame.precision}
    return replace(
        first,
        attributes=tuple(attributes),
        parts=tuple(parts),
        metadata=metadata,
        lost=tuple(lost),
        precision=first.precision if len(both) == 1 else "float64",
    )


def _is_same(one: Attribute, other: Attribute) -> bool:
    same = (one.name, one.domain, one.role, one.normalized) == (
        *(other.name, other.domain, other.role, other.normalized),
    )
    if not same or one.values.dtype != other.values.dtype:
        return False
    if one.values.shape != other.values.shape or one.values.tobytes() != other.values.tobytes():
        return False
    if one.index is None or other.index is None:
        return one.index is other.index
    return np.array_equal(one.index, other.index)


def _is_same_division(one: Parts, other: Parts) -> bool:
    if (one.kind, one.names) != (other.kind, other.names):
        return False
    if not np.array_equal(one.of_face, other.of_face):
        return False
    if one.transforms is None or other.transforms is None:
        return one.transforms is other.transforms
    return np.array_equal(one.transforms, other.transforms)
