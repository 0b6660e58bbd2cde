"""Sample of a surface: a few balls of vertices, of which a search learns what to try on the whole.

The errors of normals that a step makes, and the bytes that a method takes, are about the same all
over a scan; positions drift over far more than a ball, and no sample tells of that.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from deltamesh._geometry.anchors import farthest
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.systems import Systems
from deltamesh._geometry.trial import Trial
from deltamesh._graph.adjacency import adjacency_between
from deltamesh._measures.measure import Measured
from deltamesh._measures.metrics import reference_of, rounded_up, vertex_errors_of
from deltamesh._options import Settings
from deltamesh._shape.surface import Surface
from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.container.layout import FARTHEST

# Vertices from which a sample costs less than the trials that it saves; balls, and the vertices of
# each. Smaller balls are more border than surface.
LEAST: Final = 30_000
BALLS: Final = 4
BALL: Final = 2_000
# A sample is no larger than that share of the surface: hubs make balls of any size.
LARGEST: Final = 0.5

_NOWHERE: Final = np.zeros((0, 3))


@dataclass(frozen=True)
class Sample:
    """Balls of a surface.

    Attributes
    ----------
    vertices : int64 (s,)
        Those of the surface that are in a ball, ascending.
    surface : Surface
        What is within the balls, on the vertices as numbered here.
    inner : int64 (f, 3)
        The faces none of whose corners is on the border of a ball.
    share : float
        Of the vertices of the surface.
    """

    vertices: Ints
    surface: Surface
    inner: Ints
    share: float

    def attempt(self, V: Floats) -> Callable[[Settings], Trial]:
        """Return the function that makes a trial of settings on the sample, without its parts.

        Parameters
        ----------
        V : float64 (n, 3)
            The vertices of the whole surface.
        """
        own, systems = V[self.vertices], Systems(self.surface)
        reference = reference_of(own, self.inner)

        def attempt(settings: Settings) -> Trial:
            anchors = settings.anchors
            if isinstance(anchors, int):  # a count of the whole
                anchors = min(max(anchors * self.share, 1.0) / len(own), 0.5)
            codec = geometry_codec(settings.method)
            here = replace(settings, anchors=anchors, anchor_method=FARTHEST)
            parameters, integers, W = codec.quantize(self.surface, own, _NOWHERE, here, systems)
            errors = vertex_errors_of(reference, reference.differences(W))
            return Trial(
                settings,
                parameters,
                integers,
                lambda: codec.encode(self.surface, parameters, integers),
                W,
                Measured(rounded_up(errors)),
            )

        return attempt


def sample_of(surface: Surface) -> Sample | None:
    """Return a sample of a surface, None where it is too small for one, or has no balls.

    The balls are cells of vertices that are the farthest apart, as anchors are: they cover the
    surface, and every so many of them are taken.
    """
    n = surface.vertex_count
    if n < LEAST:
        return None
    (indptr, indices), faces = surface.graph, surface.faces
    centres = farthest(indptr, indices, surface.labels, n // BALL)
    cell = Cells(surface.graph, surface.labels, centres).of
    chosen = np.zeros(len(centres), dtype=bool)
    chosen[(np.arange(BALLS) * len(centres) + len(centres) // 2) // BALLS] = True
    inside = chosen[cell]
    vertices = np.flatnonzero(inside)
    number = np.full(n, -1)
    number[vertices] = np.arange(len(vertices))
    count = np.diff(indptr)[vertices].astype(np.int64)
    first = indptr[vertices] - (np.cumsum(count) - count)
    tail = np.repeat(vertices, count)
    head = indices[np.repeat(first, count) + np.arange(len(tail))].astype(np.int64)
    within = cell[tail] == cell[head]
    border = np.zeros(n, dtype=bool)
    border[tail[~within]] = True
    graph = adjacency_between(number[tail[within]], number[head[within]], len(vertices))
    whole = faces[_all_in(faces, cell, inside)]
    quads = surface.quads[_all_in(surface.quads, cell, inside)]
    own = Surface(number[whole], graph, 0, number[quads])
    inner = number[whole[~border[whole].any(axis=1)]]
    if len(vertices) > LARGEST * n or not len(inner):
        return None
    return Sample(vertices, own, inner, len(vertices) / n)


def _all_in(polygons: Ints, cell: Ints, inside: Bools) -> Bools:
    """Return which polygons, int64 (m, c), have all of their corners in one cell that is inside."""
    found = inside[polygons[:, 0]]
    found[found] = (cell[polygons[found]] == cell[polygons[found, :1]]).all(axis=1)
    return found
