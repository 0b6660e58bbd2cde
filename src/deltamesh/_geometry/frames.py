"""Integers of a frame, relative to those of the one that it is predicted from, and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from deltamesh._geometry.integers import Integers
from deltamesh._geometry.methods import frame_codec
from deltamesh._geometry.motion import Motion
from deltamesh._geometry.prediction import Reference, finer
from deltamesh._geometry.quantize import MOST_STEPS
from deltamesh._graph.adjacency import without_edges
from deltamesh._shape.surface import Surface
from deltamesh._streams.vectors import decode_vectors, encode_vectors
from deltamesh._vectors import largest
from deltamesh_formats.array_types import Ints
from deltamesh_formats.container.container import Parameters, Section
from deltamesh_formats.container.method_layouts import METHODS
from deltamesh_formats.container.payload_layout import MAPS
from deltamesh_formats.container.sections import payload_of
from deltamesh_formats.errors import MeshError


def relative(parameters: Parameters, integers: Integers, reference: Reference) -> Integers:
    """Return the integers with grid points as seen from those of the reference.

    Raises
    ------
    MeshError
        If they are more than 2^30 steps apart.
    """
    base = _on_grid(parameters, reference)
    if not METHODS[parameters.method].anchored:
        values = integers.values - base.values
        _check_reach(values)
        return replace(integers, values=values)
    positions = integers.positions - base.positions
    isolated = integers.isolated - base.isolated
    _check_reach(np.concatenate([positions, isolated]))
    return replace(integers, positions=positions, isolated=isolated)


def _check_reach(moved: Ints) -> None:
    if not largest(moved) < MOST_STEPS:
        raise MeshError("vertices move too far, for steps so small, from one frame to another")


def absolute(parameters: Parameters, integers: Integers, reference: Reference) -> Integers:
    """Return the integers that `relative` was given."""
    base = _on_grid(parameters, reference)
    if not METHODS[parameters.method].anchored:
        return replace(integers, values=integers.values + base.values)
    positions = integers.positions + base.positions
    return replace(integers, positions=positions, isolated=integers.isolated + base.isolated)


def _on_grid(parameters: Parameters, reference: Reference) -> Integers:
    """Return the integers of the reference, its grid points on the grid of the parameters."""
    by, i = finer(reference.parameters, parameters), reference.integers
    if not METHODS[parameters.method].anchored:
        return replace(i, values=_shifted(i.values, by))
    return replace(i, positions=_shifted(i.positions, by), isolated=_shifted(i.isolated, by))


def _shifted(points: Ints, by: int) -> Ints:
    return points << by if by >= 0 else points >> -by


def encode_frame(
    surface: Surface, parameters: Parameters, integers: Integers, motion: Motion | None
) -> dict[str, bytes]:
    """Return the streams of a frame by their names, from relative integers."""
    maps = {}
    if motion is not None:
        maps[MAPS] = encode_vectors(*without_edges(len(motion.rows)), motion.rows)
    return {**maps, **frame_codec(parameters.method).encode_frame(surface, parameters, integers)}


def decode_frame(
    surface: Surface,
    parameters: Parameters,
    sections: Mapping[str, Section],
    first: Integers,
    maps: int,
) -> tuple[Ints, Integers]:
    """Return the rows of so many maps, (3 k, 3), and relative integers: the mirror.

    Raises
    ------
    FormatError
    """
    rows = np.zeros((3 * maps, 3), dtype=np.int64)
    if maps:
        with payload_of(sections[MAPS]) as payload:
            rows = decode_vectors(*without_edges(3 * maps), payload)
    coder = frame_codec(parameters.method)
    return rows, coder.decode_frame(surface, parameters, sections, first)
