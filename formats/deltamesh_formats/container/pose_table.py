"""Poses of a file: their names, and where their motions are; SPEC.md 5.21.

Plain bytes, so that programs can list poses without decoding any, and without numpy. `read_poses`
and `write_poses` are mirrors.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from deltamesh_formats.container import layout
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.fields import Buffer, read_fields, take, write_fields
from deltamesh_formats.container.payload_layout import MOST_OCTAVES, POSE_FIELDS
from deltamesh_formats.container.sections import payload_of
from deltamesh_formats.errors import FormatError


@dataclass(frozen=True)
class PoseEntry:
    """One pose of a file.

    Attributes
    ----------
    name : str
        Printable, and no other pose's.
    step : float
        Of the displacements, in the unit of the mesh.
    octaves : int
        The unit of the rotations is 2^-octaves; see `deltamesh._geometry.poses`.
    stream : bytes or memoryview
        The coded numbers.
    offset : int
        Where the stream begins in the payload.
    """

    name: str
    step: float
    octaves: int
    stream: Buffer
    offset: int = 0

    @property
    def size(self) -> int:
        """Bytes that the pose takes in the payload."""
        return len(_written(self))


def entries_of(container: Container) -> tuple[PoseEntry, ...]:
    """Return the poses of a file, in their order; nothing is decoded.

    Raises
    ------
    FormatError
    """
    if layout.POSES not in container.sections:
        return ()
    with payload_of(container.sections[layout.POSES]) as payload:
        return read_poses(payload)


def write_poses(entries: Iterable[PoseEntry]) -> bytes:
    """Return the payload of POSE.

    Raises
    ------
    MeshError
        For a value that its field does not hold.
    """
    return b"".join(map(_written, entries))


def _written(entry: PoseEntry) -> bytes:
    fields = write_fields(POSE_FIELDS, {**vars(entry), "size": len(entry.stream)})
    return fields + bytes(entry.stream)


def read_poses(payload: memoryview) -> tuple[PoseEntry, ...]:
    """Return the poses in a payload.

    Raises
    ------
    FormatError
        With an offset from the beginning of the payload.
    """
    entries: dict[str, PoseEntry] = {}
    at = 0
    while at < len(payload) or not entries:
        values, offsets, start = read_fields(payload, at, POSE_FIELDS)
        fault = pose_fault(values["name"], values["step"], values["octaves"])
        if fault:
            raise FormatError(fault[1], offsets[fault[0]])
        if values["name"] in entries:
            raise FormatError(f"pose {values['name']!r} comes a second time", at)
        stream = take(payload, start, values.pop("size"))
        entries[values["name"]] = PoseEntry(**values, stream=stream, offset=start)
        at = start + len(stream)
    return tuple(entries.values())


def pose_fault(name: str, step: float, octaves: int) -> tuple[str, str] | None:
    """Return the field of a pose that is wrong, and what is; None if none is."""
    if not name or not name.isprintable():
        return "name", "an empty name of a pose" if not name else "a name with control characters"
    if not (math.isfinite(step) and step > 0):
        return "step", f"a step of {step}"
    if octaves > MOST_OCTAVES:
        return "octaves", f"a unit of 2^-{octaves}"
    return None
