"""Parts of a mesh, each measured for itself: its components, and objects within components.

What bounds a whole scene says little of a small part of it: a ball of radius 0.5 on a ground of 500
units may vanish within an RMS error of 0.15 % of the scene. So each connected component is measured
against its own diagonal, and each object too that is not made of whole components; where one is,
the errors of its components bound its own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from deltamesh._measures.differences import Differences, Reference
from deltamesh_formats.array_types import Floats, Ints

if TYPE_CHECKING:  # which are of this one's errors
    from deltamesh._measures.weights import Weights
from deltamesh_formats.caching import cached_property
from deltamesh_formats.polymesh.permutations import distinct

# A part is a line, and has no normals to keep, whose area is less than that share of the square of
# its diagonal.
LINE: Final = 1e-6
# The bounds of quality 5, which count alike where parts are compared: the mean deviation of the
# face normals in degrees, which shading does not show, and the RMS distance over the diagonal,
# which bounds the error of a silhouette. Two levels up halve both.
QUALITY_NORMAL: Final = 1.0
QUALITY_RMS: Final = 1.5e-3


@dataclass(frozen=True)
class Parts:
    """Parts of a mesh.

    Attributes
    ----------
    component : int64 (n,)
        The component of each vertex, -1 for one in no face.
    divisions : sequence of int64 (m,)
        The part of each face, -1 for none, in a division into parts that do not overlap. The first
        is that into components, whose parts come first.
    """

    component: Ints
    divisions: Sequence[Ints]

    @cached_property
    def components(self) -> int:
        """Number of components."""
        return int(self.component.max(initial=-1)) + 1

    @cached_property
    def count(self) -> int:
        """Number of parts."""
        return 1 + max(int(part.max(initial=-1)) for part in self.divisions)


@dataclass(frozen=True)
class PartErrors:
    """Errors of each part; the arrays are float64 (q,), lengths in the unit of the vertices.

    Attributes
    ----------
    rms, max : array
    normal_deviation, dihedral : array
        In degrees, as those of `metrics.VertexErrors`; the normals of a line have no weight.
    diagonal : array
        Of the part's own bounding box.
    """

    rms: Floats
    max: Floats
    normal_deviation: Floats
    dihedral: Floats
    diagonal: Floats

    @property
    def relative_rms(self) -> Floats:
        """The RMS distance over the part's diagonal; 0 for a point."""
        return np.where(
            self.diagonal > 0, self.rms / np.where(self.diagonal > 0, self.diagonal, 1), 0
        )

    @property
    def worst(self) -> int:
        """The part with the largest of normal deviation and RMS, in what counts alike."""
        share = np.maximum(self.normal_deviation / QUALITY_NORMAL, self.relative_rms / QUALITY_RMS)
        return int(np.argmax(share))


class PartReference:
    """Parts of a reference; what their errors need of it is computed once.

    Parameters
    ----------
    reference : Reference
    parts : Parts
    weights : Weights, optional
        Of the elements, by which the means of their differences are weighted.
    """

    def __init__(self, reference: Reference, parts: Parts, weights: Weights | None = None) -> None:
        self.parts = parts
        self._unit, q = reference.unit, parts.count
        V, F = reference.vertices, reference.faces
        left, right = reference.edges.T // 3
        self._vertex, self._starts = _members(F, parts, len(V))
        low = np.minimum.reduceat(V[self._vertex], self._starts)
        high = np.maximum.reduceat(V[self._vertex], self._starts)
        self.diagonal: Floats = np.array([math.hypot(*side) for side in high - low])
        self._weights: list[tuple[Ints, Ints, Floats]] = []
        self._edges: list[tuple[Ints, Ints, Floats]] = []
        alike: Floats = np.broadcast_to(1.0, len(self._vertex))
        self._of_vertex = alike if weights is None else weights.vertices[self._vertex]
        self._counts = _divisors(np.add.reduceat(self._of_vertex, self._starts))
        counts = np.zeros(q)
        square = (self.diagonal / self._unit) ** 2
        for part in parts.divisions:
            faces = np.flatnonzero(part >= 0)
            area = reference.areas[faces]
            total = np.bincount(part[faces], area, q)
            surface = total > 2 * LINE * square
            if weights is not None:
                area = area * weights.faces[faces]
                total = np.bincount(part[faces], area, q)
                surface &= total > 0
            weight = np.where(surface, 1 / np.where(surface, total, 1), 0)[part[faces]] * area
            self._weights.append((part[faces], faces, weight))
            edges = np.flatnonzero((part[left] >= 0) & (part[left] == part[right]))
            of_edge: Floats = np.broadcast_to(1.0, len(edges))
            if weights is not None:
                of_edge = weights.edges[edges]
            self._edges.append((part[left][edges], edges, of_edge))
            counts += np.bincount(part[left][edges], of_edge, q)
        self._edge_counts = _divisors(counts)

    def errors(self, d: Differences) -> PartErrors:
        """Return the errors that differences from the reference amount to."""
        q, unit = self.parts.count, self._unit
        distance = d.distance[self._vertex]
        normal, change = np.zeros(q), np.zeros(q)
        for part, faces, weight in self._weights:
            normal += np.bincount(part, weight * d.angle[faces], q)
        for part, at, weight in self._edges:
            change += np.bincount(part, weight * d.change[at], q)
        squares = np.add.reduceat(self._of_vertex * (distance * distance), self._starts)
        return PartErrors(
            rms=unit * np.sqrt(squares / self._counts),
            max=unit * np.maximum.reduceat(distance, self._starts),
            normal_deviation=normal,
            dihedral=change / self._edge_counts,
            diagonal=self.diagonal,
        )


def _divisors(sums: Floats) -> Floats:
    """Return sums to divide by, 1 for those of nothing."""
    return np.where(sums > 0, sums, 1.0)


def _members(F: Ints, parts: Parts, n: int) -> tuple[Ints, Ints]:
    """Return the vertices of the parts, part after part, and where those of each begin."""
    found = []
    for part in parts.divisions:
        inside = part >= 0
        key = np.repeat(part[inside], 3) * n + F[inside].ravel()
        found.append(distinct(key))
    key = np.concatenate(found)
    key.sort()
    starts = np.searchsorted(key // n, np.arange(parts.count))
    return key % n, starts


def parts_of(F: Ints, component: Ints, objects: Sequence[Ints] = ()) -> Parts:
    """Return the parts of a mesh.

    Parameters
    ----------
    F : int64 (m, 3)
    component : int64 (n,)
        The component of each vertex, -1 for one in no face.
    objects : sequence of int64 (m,)
        Divisions into objects: the object of each face, -1 for none.
    """
    of_face = component[F[:, 0]]
    count = int(component.max(initial=-1)) + 1
    divisions = [of_face]
    for part in objects:
        split = np.zeros(count, dtype=bool)
        first = np.full(count, -2, dtype=np.int64)
        first[of_face[::-1]] = part[::-1]
        split[of_face[part != first[of_face]]] = True
        within = distinct(part[split[of_face] & (part >= 0)])
        if len(within):
            number = np.full(int(part.max()) + 1, -1, dtype=np.int64)
            number[within] = count + np.arange(len(within))
            divisions.append(np.where(part >= 0, number[part], -1))
            count += len(within)
    return Parts(component, tuple(divisions))
