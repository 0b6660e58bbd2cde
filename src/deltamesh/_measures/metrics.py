"""Metrics of two meshes, each defined once.

All compare a mesh with another of the same connectivity and vertex order, `reference` first.
Lengths are in the unit of the vertices, angles in degrees. The sources are in each docstring.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from deltamesh._graph.adjacency import edges
from deltamesh._measures.differences import Differences, Reference
from deltamesh._measures.hausdorff import squared_hausdorff
from deltamesh._mesh import TriangleMesh
from deltamesh._vectors import lengths, safe_lengths, sides
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.errors import OptionError

# Of Mq in the visual error (Sorkine, Cohen-Or and Toledo 2003, section 5).
VISUAL_WEIGHT = 0.15
# Share of an error that may be lost where it is computed.
ROUNDING = 2.0**-46


@dataclass(frozen=True)
class VertexErrors:
    """The errors that an encoder checks.

    Attributes
    ----------
    rms, max : float
        Vertex distances, in the unit of the vertices.
    normal_deviation : float
        The mean angle between corresponding face normals, weighted by the area in the reference, in
        degrees. A face without area there has no weight; one that lost its area counts 90 degrees.
    dihedral : float
        The mean |change of the dihedral angle| over the interior edges, in degrees: the unweighted
        form of L. Vasa, J. Rus, "Dihedral Angle Mesh Error", Comput. Graph. Forum 31(5), 2012.
        Angles are oriented, convex and concave differ in sign, and a change is at most 180. An
        interior edge is one of exactly two faces. A face without area continues its neighbour flat.
    """

    rms: float
    max: float
    normal_deviation: float
    dihedral: float


@dataclass(frozen=True)
class Errors(VertexErrors):
    """All errors.

    Attributes
    ----------
    hausdorff, visual : float
        In the unit of the vertices.
    diagonal : float
        Of the reference's bounding box, to make lengths relative.
    """

    hausdorff: float
    visual: float
    diagonal: float


def compare(reference: TriangleMesh, other: TriangleMesh) -> Errors:
    """Return all errors of another mesh with the same faces.

    Raises
    ------
    ValueError
        If the meshes differ in faces or in the number of vertices; `correspondence.match` may help.
    """
    cheap = vertex_errors(reference.vertices, other.vertices, reference.faces)
    if not np.array_equal(reference.faces, other.faces):
        raise ValueError("the meshes must have the same faces, in the same order")
    V, W, F = reference.vertices, other.vertices, reference.faces
    return Errors(
        **vars(cheap),
        hausdorff=hausdorff(reference, other),
        visual=visual_error(V, W, F),
        diagonal=diagonal(V),
    )


def vertex_errors(V: ArrayLike, W: ArrayLike, F: ArrayLike) -> VertexErrors:
    """Return the errors that cost little (bunny, 70k faces: 0.1 s).

    Parameters
    ----------
    V, W : float array (n, 3)
        Reference and other positions.
    F : int array (m, 3)

    Raises
    ------
    ValueError
        If the shapes of V and W differ.
    OptionError
        If a face names a vertex that is not there.
    TypeError
        If the faces are not of integers.
    """
    first, second = (np.ascontiguousarray(X, dtype=np.float64) for X in (V, W))
    faces = np.asarray(F).astype(np.int64, order="C", casting="same_kind", copy=False)
    if faces.size and not 0 <= faces.min() <= faces.max() < len(first):
        raise OptionError(f"a face names a vertex outside of 0 to {len(first) - 1}")
    reference = reference_of(first, faces)
    return vertex_errors_of(reference, reference.differences(second))


def reference_of(V: Floats, F: Ints) -> Reference:
    """Return the reference of `vertex_errors`; its unit is the diagonal."""
    return Reference(V, F, diagonal(V) or 1.0)


def vertex_errors_of(reference: Reference, d: Differences) -> VertexErrors:
    """Return the errors that differences amount to."""
    return VertexErrors(
        rms=reference.unit * _rms(d.distance),
        max=reference.unit * float(d.distance.max(initial=0.0)),
        normal_deviation=_normal_deviation(d.angle, reference.areas),
        dihedral=float(d.change.mean()) if len(d.change) else 0.0,
    )


def rounded_up(errors: VertexErrors) -> VertexErrors:
    """Return errors that are not below the truth: rounding is added, and angles fit binary32."""
    angles = np.array([errors.normal_deviation, errors.dihedral])
    lengths = np.array([errors.rms, errors.max])
    return VertexErrors(*length_rounded_up(lengths).tolist(), *angles_rounded_up(angles).tolist())


def length_rounded_up(length: Floats) -> Floats:
    """Return lengths, float64 (k,), with the rounding that may have made them too small."""
    return length * (1 + ROUNDING)


def angles_rounded_up(angle: Floats) -> Floats:
    """Return the least numbers of binary32 not below angles, float64 (k,), with their rounding."""
    wanted = angle * (1 + ROUNDING)
    single = wanted.astype(np.float32)
    above = np.nextafter(single, np.float32(np.inf))
    return np.where(single >= wanted, single, above).astype(np.float64)


def single_above(x: float) -> float:
    """Return the least number of binary32 that is not below x."""
    return float(angles_rounded_up(np.array([x]))[0])


def diagonal(V: Floats) -> float:
    """Return the length of the bounding box's diagonal, 0 without vertices."""
    return math.hypot(*sides(V))


def mean_edges(V: Floats, F: Ints, component: Ints, count: int) -> Floats:
    """Return the mean length of the edges of each component, float64 (count,).

    Edges of two faces count twice; `component`, int64 (m,), is that of each face.
    """
    sides = [safe_lengths(V[F[:, i]] - V[F[:, i - 1]]) for i in range(3)]
    if count == 1:
        return np.array([np.mean(sides)])
    total = np.bincount(component, np.sum(sides, axis=0), count)
    return total / np.maximum(3 * np.bincount(component, minlength=count), 1)


def visual_error(V: Floats, W: Floats, F: Ints) -> float:
    """Return 0.15 Mq + 0.85 Sq of O. Sorkine, D. Cohen-Or, S. Toledo, SGP 2003, section 5.

    Mq is the RMS of the vertex distances, Sq that of the differences of geometric Laplacians.
    """
    V, W, unit = _normalized(V, W)
    pairs = edges(F, len(V))
    mq = _rms(lengths(W - V))
    sq = _rms(lengths(geometric_laplacian(W, pairs) - geometric_laplacian(V, pairs)))
    return unit * (VISUAL_WEIGHT * mq + (1 - VISUAL_WEIGHT) * sq)


def geometric_laplacian(V: Floats, pairs: Ints) -> Floats:
    """Return GL(v_i) = v_i - sum_j v_j / l_ij / sum_j 1 / l_ij, l_ij the length of edge ij.

    Z. Karni, C. Gotsman, "Spectral compression of mesh geometry", SIGGRAPH 2000, section 6.

    Parameters
    ----------
    V : float64 (n, 3)
        With a bounding box of about unit size.
    pairs : int64 (e, 2)
        Undirected edges, each once.

    Returns
    -------
    float64 (n, 3)
        Zero for a vertex without edges, and in the limit for one that coincides with a neighbour.
    """
    i, j = pairs[:, 0], pairs[:, 1]
    difference = V[i] - V[j]
    weight = 1.0 / np.maximum(lengths(difference), 1e-30)
    total = np.bincount(i, weight, len(V)) + np.bincount(j, weight, len(V))
    weighted = difference * weight[:, None]
    laplacian = np.stack(
        [np.bincount(i, w, len(V)) - np.bincount(j, w, len(V)) for w in weighted.T], axis=1
    )
    return laplacian / np.where(total > 0, total, 1.0)[:, None]


def hausdorff(reference: TriangleMesh, other: TriangleMesh) -> float:
    """Return the symmetric Hausdorff distance of the two surfaces, by samples.

    The samples of each surface are the vertices of its faces and points spread over it in
    proportion to area; the distance from each to the other surface is exact (not to its samples),
    so the result is a lower bound, and less than the distance of neighbouring samples below the
    truth. Connectivity may differ. P. Cignoni, C. Rocchini, R. Scopigno, "Metro: measuring error
    on simplified surfaces", Comput. Graph. Forum 17(2), 1998.

    Raises
    ------
    ValueError
        If just one of the meshes has faces.
    """
    if (len(reference.faces) == 0) != (len(other.faces) == 0):
        raise ValueError("a mesh without faces has no distance to one with faces")
    if len(reference.faces) == 0:
        return 0.0
    V, W, unit = _normalized(reference.vertices, other.vertices)
    squared = squared_hausdorff(V[reference.faces], W[other.faces])
    return unit * float(np.sqrt(squared))


def _normalized(V: Floats, W: Floats) -> tuple[Floats, Floats, float]:
    """Return both meshes moved and scaled by the reference's box, and the length of the unit."""
    centre, unit = _frame(V)
    return (V - centre) / unit, (W - centre) / unit, unit


def _frame(V: Floats) -> tuple[Floats, float]:
    """Return the centre and the unit of the reference.

    Squares and cubes of lengths then neither overflow nor vanish, far from the origin or not.
    """
    centre: Floats = V.mean(axis=0) if len(V) else np.zeros(3)
    return centre, diagonal(V) or 1.0


def _rms(x: Floats) -> float:
    return float(np.sqrt(np.mean(x * x))) if len(x) else 0.0


def _normal_deviation(angle: Floats, area: Floats) -> float:
    total = float(area.sum())
    # A product of BLAS has other last bits for another number of threads.
    return float((area * angle).sum()) / total if total > 0 else 0.0
