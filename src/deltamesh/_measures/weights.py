"""Weights of errors, where some vertices are more important than others.

An error counts times the importance w of its element: that of a vertex, the least of the corners of
a face, and the least of both faces at an edge. So a bound B is kept where an element of importance
w errs by B / w. Means are weighted by w, too, so that what is important is not diluted; and since
it must not be made up for by others either, the mean over the elements of importance 1 alone is
taken where it is larger.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from deltamesh._measures.differences import Differences, Reference
from deltamesh._measures.metrics import VertexErrors
from deltamesh_formats.array_types import Floats


@dataclass(frozen=True)
class Weights:
    """Weights of the vertices (n,), faces (m,) and interior edges (e,) of a reference, float64."""

    vertices: Floats
    faces: Floats
    edges: Floats

    def of(self, d: Differences) -> Differences:
        """Return differences times their weights."""
        return replace(
            d,
            distance=self.vertices * d.distance,
            angle=self.faces * d.angle,
            change=self.edges * d.change,
        )

    @property
    def full(self) -> Weights:
        """Weight 1 for all of importance 1, and 0 for others."""
        return Weights(*((each == 1).astype(np.float64) for each in self._all))

    @property
    def reduced(self) -> Weights:
        """Weight 1 for all of less importance, and 0 for others."""
        return Weights(*((each < 1).astype(np.float64) for each in self._all))

    @property
    def _all(self) -> tuple[Floats, Floats, Floats]:
        return self.vertices, self.faces, self.edges


def weights_of(reference: Reference, importance: Floats) -> Weights:
    """Return the weights of a reference whose vertices have this importance, float64 (n,)."""
    left, right = reference.edges.T // 3
    faces = importance[reference.faces].min(axis=1, initial=1.0)
    return Weights(importance, faces, np.minimum(faces[left], faces[right]))


def weighted_errors(reference: Reference, d: Differences, weights: Weights) -> VertexErrors:
    """Return the errors of which a bound keeps what is important."""
    whole, full = (mean_errors(reference, weights.of(d), w) for w in (weights, weights.full))
    return VertexErrors(*map(max, vars(whole).values(), vars(full).values()))


def mean_errors(reference: Reference, d: Differences, weights: Weights) -> VertexErrors:
    """Return the errors that differences amount to, with means over weighted elements."""
    unit, areas = reference.unit, reference.areas * weights.faces
    return VertexErrors(
        rms=unit * float(np.sqrt(_mean(d.distance**2, weights.vertices))),
        max=unit * float((d.distance * (weights.vertices > 0)).max(initial=0.0)),
        normal_deviation=_mean(d.angle, areas),
        dihedral=_mean(d.change, weights.edges),
    )


def _mean(x: Floats, weights: Floats) -> float:
    total = float(weights.sum())
    return float((weights * x).sum()) / total if total > 0 else 0.0
