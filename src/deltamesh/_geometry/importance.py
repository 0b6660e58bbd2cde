"""Importance of the vertices: 1 keeps a bound, one half allows twice the error, 0 any.

The step of a vertex is that of importance 1 over its own importance. It grows away from what is
important by a factor of two every two edges at most: where it jumped, the coarse side would bend
the fine one. Vertices of importance 0 have no bits at all, their integers are zeros: the shape
there follows from the connectivity and from anchors, a ring of which holds the rest in place.

D. Cohen-Or, O. Sorkine, "Encoding Meshes in Differential Coordinates", SCCG 2006, section 4.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Final

import numpy as np

from deltamesh._options import Settings
from deltamesh._shape.surface import Surface
from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.container.payload_layout import PER_OCTAVE
from deltamesh_formats.errors import MeshError, OptionError
from deltamesh_formats.polymesh.mesh import PolyMesh

# Levels, in quarters of an octave, are whole octaves: finer ones cost more in STEP than they save.
LEVEL: Final = PER_OCTAVE
MOST: Final = 24 * PER_OCTAVE
# By default, that share of the vertices are interpolated anchors where steps differ: errors of the
# coarse side drift into the fine one. With 0.1 %, files of a bunny and a horse were a tenth larger.
ANCHORS: Final = 0.004
# How much coarser a neighbour may be: an octave every two edges.
SLOPE: Final = PER_OCTAVE // 2
# Rings of anchors around vertices without bits: where surfaces go through them, one holds the rest;
# where they are weighed in least squares, two hold its slope, too.
RINGS: Final = {True: 1, False: 2}


def importance_of(mesh: PolyMesh, given: str | Iterable[float]) -> Floats:
    """Return the importance of each vertex, float64 (n,).

    Parameters
    ----------
    mesh : PolyMesh
    given : str or array_like (n,)
        The name of an attribute of the vertices, or numbers from 0 to 1.

    Raises
    ------
    OptionError
        If there is no such attribute, or another number of rows.
    MeshError
        If a number is not in 0..1, or none is above 0; the first vertex at fault is named.
    """
    values = _named(mesh, given) if isinstance(given, str) else np.asarray(given)
    if values.dtype.kind not in "buif":
        raise OptionError(f"importance must be real numbers, not {values.dtype}")
    n = len(mesh.vertices)
    if values.shape not in ((n,), (n, 1)):
        raise OptionError(f"importance has shape {values.shape}, not ({n},)")
    found = values.astype(np.float64).reshape(n)
    wrong = ~((found >= 0) & (found <= 1))
    if wrong.any():
        i = int(np.argmax(wrong))
        least, most = np.nanmin(found), np.nanmax(found)
        raise MeshError(
            f"importance {found[i]:g} of vertex {i} is not in 0..1:"
            f" values run from {least:g} to {most:g}"
        )
    if not found.any():
        raise MeshError("no vertex has an importance above 0")
    return found


def _named(mesh: PolyMesh, name: str) -> Floats:
    """Return the numbers of an attribute; integers that stand for fractions become these."""
    known = [one for one in mesh.attributes if one.domain == "vertex" and one.width == 1]
    for one in known:
        if one.name == name:
            values = one.dense()
            if one.normalized and values.dtype.kind in "ui":
                return values / np.iinfo(values.dtype).max
            return values
    listed = ", ".join(one.name for one in known) or "there is none"
    raise OptionError(
        f"no attribute {name!r} of one number for each vertex to be the importance: {listed}"
    )


def of_points(importance: Floats, points: Ints, count: int) -> Floats:
    """Return the largest importance of the vertices at each point, float64 (count,).

    Parameters
    ----------
    importance : float64 (n,)
    points : int64 (n,)
        The point of each vertex, -1 for those that are left out.
    count : int
    """
    result, there = np.zeros(count), points >= 0
    np.maximum.at(result, points[there], importance[there])
    return result


def coarser(surface: Surface, importance: Floats) -> tuple[bytes, bytes]:
    """Return what `Settings.coarser` and `Settings.no_bits` are for an importance.

    Parameters
    ----------
    surface : Surface
    importance : float64 (n,)
        Of the vertices of the faces.
    """
    none = importance == 0
    asked = LEVEL * np.floor(-np.log2(np.where(none, 1.0, importance)) * PER_OCTAVE / LEVEL)
    level = np.where(none, MOST, np.minimum(asked, MOST)).astype(np.int64)
    indptr, head = surface.graph
    tail = np.repeat(np.arange(len(level)), np.diff(indptr))
    for _ in range(MOST // SLOPE):
        before = level.copy()
        np.minimum.at(level, tail, before[head] + SLOPE)
        if (level == before).all():
            break
    # Any step does for zeros: that of what is the least important otherwise costs the fewest bytes.
    level[none] = level[~none].max(initial=0)
    level -= level.min(initial=MOST)
    return (
        level.astype(np.uint8).tobytes() if level.any() else b"",
        none.tobytes() if none.any() else b"",
    )


def important(
    surface: Surface, importance: Floats | None, settings: Settings, solution: str | None
) -> Settings:
    """Return settings with an importance of the points, float64 (p,), if there is any.

    Anchors around vertices without bits are interpolated unless another `solution` is asked for:
    what they go through there does not move the rest, as it does in least squares.
    """
    if importance is None:
        return settings
    levels, no_bits = coarser(surface, importance[: surface.vertex_count])
    through = bool(no_bits) and solution is None and settings.layout.anchored
    drifts = settings.interpolated and bool(levels) and settings.anchors is None
    anchors = ANCHORS if drifts else settings.anchors
    return replace(
        settings,
        coarser=levels,
        no_bits=no_bits,
        interpolated=settings.interpolated or through,
        anchors=anchors,
    )


def without_bits(settings: Settings) -> Bools | None:
    """Return which vertices have no bits, bool (n,); None if all have."""
    return np.frombuffer(settings.no_bits, dtype=bool) if settings.no_bits else None


def holding(surface: Surface, none: Bools, interpolated: bool) -> Ints:
    """Return the anchors that hold the rest where vertices have no bits, ascending, int64.

    They are in rings around, and, in each component, one is among the vertices without bits, as far
    inside as it can be: its cell takes what their deltas lack in all.
    """
    indptr, head = surface.graph
    tail = np.repeat(np.arange(len(none)), np.diff(indptr))
    near = none.copy()
    for _ in range(RINGS[interpolated]):
        near[tail[near[head]]] = True
    edges = np.zeros(len(none), dtype=np.int64)  # to the nearest vertex with bits
    reached = ~none
    while True:
        new = np.zeros_like(none)
        new[tail[reached[head]]] = True
        new &= ~reached
        if not new.any():
            break
        reached |= new
        edges[none & ~reached] += 1
        edges[new] += 1
    inside = np.flatnonzero(none)
    inside = inside[np.argsort(-edges[inside], kind="stable")]
    _, first = np.unique(surface.labels[inside], return_index=True)
    return np.union1d(np.flatnonzero(near & ~none), inside[first])


def largest_distances(settings: Settings) -> Floats | float:
    """Return how far each vertex may be from where it was, float64 (n,), or the one for all."""
    if not (settings.coarser or settings.no_bits):
        return settings.largest
    none, level = without_bits(settings), np.frombuffer(settings.coarser, dtype=np.uint8)
    n = len(settings.coarser or settings.no_bits)
    found = np.full(n, settings.largest)
    if len(level):
        found *= 2.0 ** (level / PER_OCTAVE)
    if none is not None:
        found[none] = np.inf
    return found
