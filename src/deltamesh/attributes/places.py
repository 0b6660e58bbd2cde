"""What attributes belong to, in the order of the file, and what of it is near what."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from deltamesh.attributes.elements import Elements, of_faces, of_vertices
from deltamesh.shape.polygons import Polygons
from deltamesh.shape.structure import Structure
from deltamesh_formats.polymesh import Domain

_Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Places:
    """The vertices, corners and faces of a file, known to encoder and decoder.

    Attributes
    ----------
    structure : Structure
    """

    structure: Structure

    @property
    def polygons(self) -> Polygons:
        """Those of the file."""
        return self.structure.polygons

    def count(self, domain: Domain) -> int:
        """Return how many elements a domain has."""
        counts = {
            "vertex": len(self.structure.points),
            "corner": len(self.polygons.corners),
            "face": len(self.polygons.offsets) - 1,
        }
        return counts[domain]

    @cached_property
    def vertices(self) -> Elements:
        """The vertices, those in no face too."""
        return of_vertices(self.structure.faces, len(self.structure.points))

    @cached_property
    def faces(self) -> Elements:
        """The polygons."""
        s = self.structure
        return of_faces(s.points[s.faces], self.polygons)

    @cached_property
    def face_of_corners(self) -> _Ints:
        """The polygon of each corner, (c,)."""
        return np.repeat(np.arange(self.count("face")), np.diff(self.polygons.offsets))


def of_classes(classes: _Ints) -> Elements:
    """Return the classes of corners of triangles, (3 m,), each an element."""
    return of_vertices(classes.reshape(-1, 3), int(classes.max(initial=-1)) + 1)


def alone(count: int) -> Elements:
    """Return elements that are near none but the one before."""
    none = np.zeros(count + 1, dtype=np.int64)
    return Elements(count, none, none[:0], none, np.zeros((0, 3), dtype=np.int64), none[:count])


def among(elements: Elements, keep: NDArray[np.bool_]) -> Elements:
    """Return only some of the elements, in their order, and what is near among these."""
    if keep.all():
        return elements
    e, number = elements, np.cumsum(keep) - 1
    owner = np.repeat(np.arange(e.count), np.diff(e.indptr))
    near = keep[owner] & keep[e.indices]
    apex = np.repeat(np.arange(e.count), np.diff(e.first))
    whole = keep[apex] & keep[e.corners].all(axis=1)
    count = int(keep.sum())
    return Elements(
        count,
        _starts(number[owner[near]], count),
        number[e.indices[near]],
        _starts(number[apex[whole]], count),
        number[e.corners[whole]],
        np.zeros(count, dtype=np.int64),
    )


def _starts(owners: _Ints, count: int) -> _Ints:
    return np.concatenate(([0], np.cumsum(np.bincount(owners, minlength=count)))).astype(np.int64)
