"""Figures of a `.dmesh` file, read without decoding it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from deltamesh_formats.container.container import Container
from deltamesh_formats.container.fields import read_varint
from deltamesh_formats.container.layout import ATTRIBUTES, POLYGONS, STEPS
from deltamesh_formats.container.payload_layout import PER_OCTAVE, QUARTERS
from deltamesh_formats.errors import FormatError

if TYPE_CHECKING:
    from deltamesh_formats.container.attribute_entry import Entry
    from deltamesh_formats.container.frame_table import Frame


def bits_per_vertex(size: int, vertices: int) -> float:
    """Return bits per vertex of `size` bytes."""
    return 8 * size / max(vertices, 1)


def relative(length: float, diagonal: float) -> float:
    """Return a length as a fraction of the bounding box diagonal; a point has none."""
    return length / diagonal if diagonal else 0.0


def header_bytes(container: Container) -> int:
    """Return the bytes before the first section."""
    return container.size - sum(section.size for section in container.sections.values())


def polygons(container: Container) -> int:
    """Return how many polygons a file has; it may be damaged there, which decoding tells.

    Without any of more than three corners, these are the faces.
    """
    if POLYGONS not in container.sections:
        return container.triangles
    try:
        return read_varint(memoryview(container.sections[POLYGONS].payload), 0)[0]
    except FormatError:
        return container.triangles


def finest_step(container: Container) -> float:
    """Return the finest step of any vertex; it may be damaged there, which decoding tells."""
    finest = 0
    if STEPS in container.sections:
        payload = container.sections[STEPS].payload
        finest = max(payload[1 : 1 + payload[0]], default=0) if payload else 0
    octaves, quarter = divmod(finest, PER_OCTAVE)
    return container.parameters.step * QUARTERS[quarter] / (1 << octaves)


def worst_frame(frames: Sequence[Frame]) -> Frame:
    """Return the frame beyond the first that is kept worst, of normals and RMS as they count alike.

    A bound of quality 5 is 1 degree for normals, and 1.5e-3 of the diagonal for the RMS distance.
    """
    return max(frames, key=lambda frame: max(frame.normal / 1.0, frame.rms / 1.5e-3))


def attributes_of(container: Container) -> Sequence[Entry]:
    """Return the entries of the attributes of a file.

    Raises
    ------
    FormatError
        If that is damaged.
    """
    if ATTRIBUTES not in container.sections:
        return ()
    from deltamesh_formats.container.attribute_table import entries_of  # which needs numpy

    return entries_of(container)
