"""Differences of a mesh from a reference, by vertex, face and edge; `src/core/differences.c`.

Lengths are divided by a unit, angles are in degrees.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.core import bools_out, call, floats, floats_out, ints, shorts
from deltamesh_formats.array_types import Bools, Floats, Ints, Shorts


def distances(V: Floats, W: Floats, unit: float) -> Floats:
    """Return the distances of points (n, 3) from others, float64 (n,)."""
    n = len(V)
    found = np.empty(n)
    call("dm_distances", floats(V, n, 3), floats(W, n, 3), n, unit, floats_out(found, n))
    return found


def face_normals(V: Floats, F: Ints, unit: float) -> tuple[Floats, Floats]:
    """Return the faces' normals (m, 3), of any length, and twice their areas (m,)."""
    n, m = len(V), len(F)
    normals, areas = np.empty((m, 3)), np.empty(m)
    found = floats_out(normals, m, 3), floats_out(areas, m)
    call("dm_face_normals", floats(V, n, 3), n, ints(F, m, 3), m, unit, *found)
    return normals, areas


def face_changes(
    before: tuple[Floats, Floats], after: tuple[Floats, Floats], least: float, most: float
) -> tuple[Floats, Bools, Bools]:
    """Return the angles between normals (m, 3) of faces, and which are lost or turned, all (m,).

    Parameters
    ----------
    before, after : pair of float64 (m, 3) and (m,)
        Normals and areas, see `face_normals`.
    least : float
        Share of the area below which a face that had one is lost.
    most : float
        Degrees above which a face that had an area, and is not lost, is turned.

    Returns
    -------
    angles : float64 (m,)
        90 where a normal has become zero.
    lost, turned : bool (m,)
    """
    m = len(before[0])
    angles, lost, turned = np.empty(m), np.empty(m, dtype=bool), np.empty(m, dtype=bool)
    given = [(floats(normals, m, 3), floats(areas, m)) for normals, areas in (before, after)]
    found = floats_out(angles, m), bools_out(lost, m), bools_out(turned, m)
    call("dm_face_changes", *given[0], *given[1], m, least, most, *found)
    return angles, lost, turned


def dihedral_angles(V: Floats, normals: Floats, F: Ints, pairs: Shorts) -> Floats:
    """Return the angles (e,) from the left faces' normals to the right ones', convex: positive.

    Parameters
    ----------
    V : float64 (n, 3)
    normals : float64 (m, 3)
        Of the faces, of any length.
    F : int64 (m, 3)
    pairs : int32 (e, 2)
        The half-edges of the left and of the right face along each edge. Where both run in the same
        direction, one of the faces is turned over.
    """
    n, m, e = len(V), len(F), len(pairs)
    angles = np.empty(e)
    surface = floats(V, n, 3), n, floats(normals, m, 3), ints(F, m, 3), m
    call("dm_dihedral_angles", *surface, shorts(pairs, e, 2), e, floats_out(angles, e))
    return angles
