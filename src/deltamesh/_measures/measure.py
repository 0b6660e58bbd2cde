"""Measure of all that an encoder bounds and records."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from deltamesh._measures.metrics import (
    VertexErrors,
    angles_rounded_up,
    length_rounded_up,
    reference_of,
    rounded_up,
    vertex_errors_of,
)
from deltamesh._measures.parts import PartErrors, PartReference, Parts
from deltamesh._measures.weights import mean_errors, weighted_errors, weights_of
from deltamesh_formats.array_types import Bools, Floats, Ints


@dataclass(frozen=True)
class Measured:
    """Errors of a decoded mesh, rounded up.

    Attributes
    ----------
    errors : VertexErrors
        Over the whole.
    parts : PartErrors or None
        Of each part; None if the mesh is one part that has all vertices.
    lost, turned : bool (m,), or None
        See `differences.Differences`.
    area : float
        Of the surface, over that of the reference.
    doubt : float
        How far the vertices of another decoder may be from those that were measured.
    """

    errors: VertexErrors
    parts: PartErrors | None = None
    lost: Bools | None = None
    turned: Bools | None = None
    area: float = 1.0
    doubt: float = 0.0


class Measure:
    """Measure of other positions of the vertices of a mesh.

    Parameters
    ----------
    V : float64 (n, 3)
    F : int64 (m, 3)
    parts : Parts
    importance : float64 (n,), optional
        Of the vertices, by which errors are weighted; see `weights`.
    """

    def __init__(self, V: Floats, F: Ints, parts: Parts, importance: Floats | None = None) -> None:
        self._reference = reference_of(V, F)
        weights = None if importance is None else weights_of(self._reference, importance)
        self._weights = weights
        # Vertices in no face may be far away: the whole says nothing of its one part.
        apart = parts.count > 1 or (parts.count > 0 and bool((parts.component < 0).any()))
        self._parts = PartReference(self._reference, parts, weights) if apart else None

    @property
    def diagonals(self) -> Floats:
        """The diagonals of the parts, float64 (q,)."""
        return np.array([self._reference.unit]) if self._parts is None else self._parts.diagonal

    def __call__(self, W: Floats) -> Measured:
        """Return the errors of other positions, float64 (n, 3)."""
        d = self._reference.differences(W)
        if self._weights is None:
            errors = rounded_up(vertex_errors_of(self._reference, d))
        else:
            errors = rounded_up(weighted_errors(self._reference, d, self._weights))
            d = self._weights.of(d)
        parts = None if self._parts is None else _rounded_up(self._parts.errors(d))
        return Measured(errors, parts, d.lost, d.turned, d.area)


def errors_by_importance(
    V: Floats, F: Ints, W: Floats, importance: Floats
) -> tuple[VertexErrors, VertexErrors]:
    """Return the errors of other positions W where the importance is 1, and where it is less.

    Those of elements, without weights; see `weights` for the importance of faces and edges.
    """
    reference = reference_of(V, F)
    d, weights = reference.differences(W), weights_of(reference, importance)
    full, reduced = (mean_errors(reference, d, w) for w in (weights.full, weights.reduced))
    return rounded_up(full), rounded_up(reduced)


def _rounded_up(errors: PartErrors) -> PartErrors:
    return replace(
        errors,
        rms=length_rounded_up(errors.rms),
        max=length_rounded_up(errors.max),
        normal_deviation=angles_rounded_up(errors.normal_deviation),
        dihedral=angles_rounded_up(errors.dihedral),
    )
