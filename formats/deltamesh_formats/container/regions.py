"""Errors of what is important and of the rest; the optional section `regs`, SPEC.md 4.3."""

from __future__ import annotations

import math
from dataclasses import dataclass

from deltamesh_formats.container import layout
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.fields import read_table, write_fields
from deltamesh_formats.container.sections import payload_of
from deltamesh_formats.errors import FormatError


@dataclass(frozen=True)
class Regions:
    """Errors of the vertices of importance 1, and of the others, in a file that weighs them.

    Attributes
    ----------
    full, reduced, none : int
        Vertices in faces, by position, of importance 1, of less, and of 0.
    rms_full, max_full : float
        Distances, in the unit of the mesh, where the importance is 1.
    normal_full, dihedral_full : float
        Mean deviations there, in degrees.
    rms_reduced, max_reduced, normal_reduced, dihedral_reduced : float
        The same of all others.
    """

    full: int
    reduced: int
    none: int
    rms_full: float
    max_full: float
    normal_full: float
    dihedral_full: float
    rms_reduced: float
    max_reduced: float
    normal_reduced: float
    dihedral_reduced: float


def write_regions(regions: Regions) -> bytes:
    """Return the payload of `regs`.

    Raises
    ------
    MeshError
        For a value that its field does not hold.
    """
    return write_fields(layout.REGION_FIELDS, vars(regions))


def regions_of(container: Container) -> Regions | None:
    """Return the regions of a file; None where its errors are not weighted.

    Raises
    ------
    FormatError
    """
    if layout.REGIONS not in container.sections:
        return None
    with payload_of(container.sections[layout.REGIONS]) as payload:
        values, offsets = read_table(payload, layout.REGION_FIELDS)
        for name, value in values.items():
            if not (math.isfinite(value) and value >= 0):
                raise FormatError(f"{name} is {value}", offsets[name])
    return Regions(**values)
