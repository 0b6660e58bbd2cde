"""An attribute as both sides know it: exact integers, and the values that they stand for."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from deltamesh.attributes.numbers import to_values
from deltamesh_formats.attribute_table import Entry
from deltamesh_formats.polymesh import Attribute

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
    """

    entry: Entry
    units: _Ints
    classes: _Ints | None
    has: NDArray[np.bool_]
    labels: _Ints
    codes: _Ints

    @property
    def arrays(self) -> tuple[_Ints, ...]:
        """What the digest of a file covers."""
        return self.units, self.has.astype(np.int64), self.labels, self.codes


# Any bits may be numbers, those of a signalling NaN too.
@np.errstate(over="ignore", invalid="ignore")
def restored(coded: Coded) -> Attribute:
    """Return the attribute: of vertices and faces row by row, where all have one."""
    entry = coded.entry
    row = np.full(len(coded.has), -1, dtype=np.int64)
    row[coded.has] = coded.labels
    values, index = to_values(entry, coded.codes), row[coded.units]
    attribute = Attribute(entry.name, entry.domain, values, entry.role, index, entry.normalized)
    if entry.domain == "corner" or not coded.has.all():
        return attribute
    return Attribute(
        entry.name, entry.domain, values[index], entry.role, normalized=entry.normalized
    )


def all_arrays(coded: Iterable[Coded]) -> tuple[_Ints, ...]:
    """Return what the digest of a file covers of its attributes."""
    return tuple(array for one in coded for array in one.arrays)
