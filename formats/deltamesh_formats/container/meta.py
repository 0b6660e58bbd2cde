"""Errors that the encoder measured, and where a file is from: the section `meta`; SPEC.md 4.2."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from deltamesh_formats.container import layout
from deltamesh_formats.container.fields import Buffer, Field, read_fields, read_table, write_fields
from deltamesh_formats.errors import FormatError


@dataclass(frozen=True)
class Meta:
    """Errors that the encoder measured, its name, and its source; the payload of `meta`.

    Attributes
    ----------
    rms, max : float
        Distances between input and decoded vertices, in the unit of the mesh.
    normal, dihedral : float
        Mean deviation of the face normals and of the dihedral angles, in degrees.
    diagonal : float
        Diagonal of the bounding box of the input, in the unit of the mesh.
    margin : int
        Halvings of the diagonal, 0 to 255; 0 stands for no margin. See `room`.
    encoder : str
        Name and version of the program.
    source : str
        Format of the input file, empty for arrays.
    lost, turned : int
        Faces that had an area and have lost it, and faces that have turned over.
    parts : int
        Connected components, and objects that are not made of whole components.
    part : str
        Name of the worst part where there are several; it may be empty.
    part_normal, part_rms : float
        Of that part, the mean deviation of the face normals in degrees, and the RMS distance over
        its own diagonal.
    """

    rms: float
    max: float
    normal: float
    dihedral: float
    diagonal: float
    margin: int
    encoder: str
    source: str
    lost: int = 0
    turned: int = 0
    parts: int = 1
    part: str = ""
    part_normal: float = 0.0
    part_rms: float = 0.0

    @property
    def room(self) -> float:
        """How far each decoded coordinate may be rounded, with which the errors are still kept."""
        return self.diagonal * 2.0**-self.margin if self.margin else 0.0

    @property
    def has_losses(self) -> bool:
        """Whether the file tells of faces that are lost or turned over, and of parts."""
        return self.lost > 0 or self.turned > 0 or self.parts > 1


def meta_faults(meta: Meta) -> Iterator[tuple[str, str]]:
    """Yield (field, what is wrong with it) by the rules of SPEC.md 4.2, for reader and writer."""
    for name in ("rms", "max", "normal", "dihedral", "diagonal", "part_normal", "part_rms"):
        value = getattr(meta, name)
        if not (math.isfinite(value) and value >= 0):
            yield name, f"{name} is {value}"
    for name in ("encoder", "source", "part"):
        # It will be printed on a terminal: no escape sequences, no line ends.
        if not getattr(meta, name).isprintable():
            yield name, f"the {name} name holds control characters"
    for name in ("lost", "turned"):
        if getattr(meta, name) < 0:
            yield name, f"{getattr(meta, name)} faces are {name}"
    if meta.parts < 1:
        yield "parts", f"{meta.parts} parts"
    if meta.parts == 1 and (meta.part or meta.part_normal or meta.part_rms):
        yield "parts", "a worst part among one"


def read_meta(payload: Buffer) -> Meta:
    """Return what the payload of `meta` holds.

    Raises
    ------
    FormatError
    """
    fields: tuple[Field, ...] = layout.META_FIELDS
    _, _, end = read_fields(payload, 0, fields)
    has_losses = end < len(payload)
    if has_losses:
        fields += layout.META_LOSS_FIELDS
        if read_fields(payload, 0, fields)[0]["parts"] > 1:
            fields += layout.META_PART_FIELDS
    values, offsets = read_table(payload, fields)
    meta = Meta(**values)
    for field, message in meta_faults(meta):
        raise FormatError(message, offsets[field])
    if has_losses != meta.has_losses:
        raise FormatError("no faces are lost or turned, and there is one part", offsets["lost"])
    return meta


def write_meta(meta: Meta) -> bytes:
    """Return the payload of `meta`.

    Raises
    ------
    MeshError
        For a value that its field does not hold.
    """
    fields: tuple[Field, ...] = layout.META_FIELDS
    if meta.has_losses:
        fields += layout.META_LOSS_FIELDS
    if meta.parts > 1:
        fields += layout.META_PART_FIELDS
    return write_fields(fields, vars(meta))
