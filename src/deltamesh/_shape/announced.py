"""Counts that a file announces before any of its elements is decoded."""

from __future__ import annotations

from deltamesh._limits import Counts
from deltamesh._shape.split_vertices import read_point_count
from deltamesh._shape.stitches import read_manifold_counts
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.layout import SPLIT_VERTICES, STITCHES
from deltamesh_formats.container.sections import payload_of


def announced(container: Container) -> Counts:
    """Return the counts that the header, PARM, COPY and STCH announce.

    Raises
    ------
    FormatError
        For counts that contradict each other.
    """
    sections, isolated = container.sections, container.parameters.isolated
    points, faces = container.vertices, container.triangles
    if SPLIT_VERTICES in sections:
        with payload_of(sections[SPLIT_VERTICES]) as payload:
            points = read_point_count(payload, container.vertices, isolated)
    vertices = points - isolated
    if STITCHES in sections:
        with payload_of(sections[STITCHES]) as payload:
            vertices, faces = read_manifold_counts(payload, points - isolated, container.triangles)
    return Counts(points, isolated, vertices, faces)
