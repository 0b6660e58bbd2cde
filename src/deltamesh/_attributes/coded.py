"""An attribute as both sides know it: exact integers, and the values that they stand for."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes.directions import surroundings
from deltamesh._attributes.domains import Places
from deltamesh._attributes.numbers import to_values
from deltamesh._attributes.unit_normals import Normals, values_of
from deltamesh_formats.container.attribute_table import Entry
from deltamesh_formats.polymesh.mesh import Attribute

_Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Coded:
    """The integers of an attribute.

    Attributes
    ----------
    entry : Entry
    units : int64 (count,)
        What each element has its value from: itself or, of corners, their class or face.
    classes : int64 (3 m,) or None
        Of the corners of the triangles, where the units are classes.
    has : bool (units,)
        Whether a unit has a value.
    labels : int64 (values,)
        The row of each unit that has one.
    codes : int64 (rows, columns)
    normals : Normals or None
        What the codes are of, where the coding is octahedral; each unit has a row then.
    """

    entry: Entry
    units: _Ints
    classes: _Ints | None
    has: NDArray[np.bool_]
    labels: _Ints
    codes: _Ints
    normals: Normals | None = None

    @property
    def arrays(self) -> tuple[_Ints, ...]:
        """What the digest of a file covers."""
        return self.units, self.has.astype(np.int64), self.labels, self.codes


# Any bits may be numbers, those of a signalling NaN too.
@np.errstate(over="ignore", invalid="ignore")
def restored(coded: Coded, places: Places, V: NDArray[np.float64]) -> Attribute:
    """Return the attribute: of vertices and faces row by row, where all have one.

    Parameters
    ----------
    coded : Coded
    places : Places
    V : float64 (n, 3)
        Decoded positions of the vertices.
    """
    e = coded.entry
    if coded.normals is None:
        values = to_values(e, coded.codes)
    else:
        around = surroundings(e, coded.units, len(coded.has), places)
        values = values_of(coded.normals, V, around).astype(e.dtype)
    row = np.full(len(coded.has), -1, dtype=np.int64)
    row[coded.has] = coded.labels
    index = row[coded.units]
    if e.domain == "corner" or not coded.has.all():
        return Attribute(e.name, e.domain, values, e.role, index, e.normalized)
    return Attribute(e.name, e.domain, values[index], e.role, normalized=e.normalized)


def all_arrays(coded: Iterable[Coded]) -> tuple[_Ints, ...]:
    """Return what the digest of a file covers of its attributes."""
    return tuple(array for one in coded for array in one.arrays)
