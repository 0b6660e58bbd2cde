"""Errors of meshes that were encoded and decoded, of the whole and of each part by itself.

They come from the arrays that `deltamesh.decode` returns, not from what the encoder recorded. Each
component and each object is measured as if it were a mesh of its own.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from deltamesh import decode
from deltamesh._graph.adjacency import components_of_faces
from deltamesh._measures.differences import Differences
from deltamesh._measures.metrics import diagonal, reference_of, vertex_errors_of
from deltamesh._measures.named_parts import OBJECTS
from deltamesh._measures.parts import LINE, QUALITY_NORMAL, QUALITY_RMS
from deltamesh._options import Options
from deltamesh._pipeline.encoder import Encoded, encode_mesh
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.polymesh.mesh import PolyMesh


class PartError(NamedTuple):
    """Errors of a part: distances over its own diagonal, angles in degrees."""

    rms: float
    max: float
    normal: float
    dihedral: float


class Found(NamedTuple):
    """A file.

    Attributes
    ----------
    encoded : Encoded
    seconds : float
        CPU time of encoding.
    trials : int
    whole : PartError
    parts : list of PartError
        Of each component and object; empty if there is just one.
    lost, turned : int
        Numbers of triangles without an area, and of those turned over.
    """

    encoded: Encoded
    seconds: float
    trials: int
    whole: PartError
    parts: list[PartError]
    lost: int
    turned: int

    @property
    def size(self) -> int:
        """Bytes of all of it."""
        return len(self.encoded.data)

    @property
    def worst(self) -> PartError:
        """The part whose RMS distance or normals are the worst, by what counts alike."""
        return max(self.parts or [self.whole], key=badness)

    @property
    def largest(self) -> PartError:
        """The largest error of each kind over all parts."""
        return largest_of(self.parts or [self.whole])


def largest_of(parts: Iterable[PartError]) -> PartError:
    """Return the largest error of each kind."""
    return PartError(*map(max, zip(*parts, strict=True)))


def badness(part: PartError) -> float:
    """Return the larger of normal and RMS error, over those of quality 5."""
    return max(part.rms / QUALITY_RMS, part.normal / QUALITY_NORMAL)


def found(mesh: PolyMesh, **options: Any) -> Found:
    """Encode and decode a mesh.

    Raises
    ------
    DeltameshError
    """
    stages: list[str] = []
    start = time.process_time()
    encoded = encode_mesh(mesh, Options(**options), stages.append)
    seconds = time.process_time() - start
    trials = sum(stage.startswith("geometry") for stage in stages)
    made = decode(encoded.data)
    reference = replace(made, vertices=mesh.vertices[encoded.order])
    return Found(encoded, seconds, trials, *errors_of(reference, made.vertices))


def errors_of(mesh: PolyMesh, W: Floats) -> tuple[PartError, list[PartError], int, int]:
    """Return the errors of other positions: of the whole and the parts; faces lost and turned."""
    V, F = mesh.vertices, mesh.triangles
    d = reference_of(V, F).differences(W)
    whole = part_error(V, W, F)
    parts = [part_error(V[used], W[used], faces) for used, faces in _parts(mesh)]
    return whole, parts if len(parts) > 1 else [], int(d.lost.sum()), int(d.turned.sum())


def part_error(V: Floats, W: Floats, F: Ints) -> PartError:
    """Return the errors of a mesh; one that is a line has no normals."""
    reference = reference_of(V, F)
    d: Differences = reference.differences(W)
    errors, unit = vertex_errors_of(reference, d), diagonal(V) or 1.0
    line = reference.areas.sum() <= 2 * LINE * (unit / reference.unit) ** 2
    normal = 0.0 if line else errors.normal_deviation
    return PartError(errors.rms / unit, errors.max / unit, normal, errors.dihedral)


def _parts(mesh: PolyMesh) -> Iterator[tuple[Ints, Ints]]:
    """Yield the vertices of each component and object, and its triangles over them."""
    cut = mesh.triangulation()
    component = components_of_faces(cut.faces, len(mesh.vertices))
    divisions = [component[cut.faces[:, 0]]]
    divisions += [one.of_face[cut.polygon] for one in mesh.parts if one.kind in OBJECTS]
    for part in divisions:
        order = np.argsort(part, kind="stable")
        starts = np.flatnonzero(np.diff(part[order], prepend=-2))
        for rows in np.split(order, starts[1:]):
            if part[rows[0]] >= 0:
                used, faces = np.unique(cut.faces[rows], return_inverse=True)
                yield used, faces.reshape(-1, 3)
