"""Table of the metrics: what tables, JSON and messages call each, and its unit.

`metrics` has the functions; nothing here imports them, so that the command line starts fast.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Metric:
    """A metric of two meshes.

    Attributes
    ----------
    name : str
        The field of `metrics.Errors`.
    column : str
        The field of `bench.Measurement`, and the column of its tables.
    title, heading : str
        The names for people: in a list, and short above a column.
    is_length : bool
        Whether it is a length, which measurements divide by the diagonal, or an angle in degrees.
    """

    name: str
    column: str
    title: str
    heading: str
    is_length: bool


METRICS: Final = (
    Metric("rms", "rms", "RMS", "RMS", is_length=True),
    Metric("max", "max", "max", "max", is_length=True),
    Metric("hausdorff", "hausdorff", "Hausdorff", "Hausdorff", is_length=True),
    Metric("visual", "visual", "visual", "visual", is_length=True),
    Metric("normal_deviation", "normal_deg", "face normals", "normals", is_length=False),
    Metric("dihedral", "dihedral_deg", "dihedral angles", "dihedral", is_length=False),
)
