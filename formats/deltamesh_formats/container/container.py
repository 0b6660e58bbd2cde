"""Plain data of a `.dmesh` file, and the rules that its values keep.

A `Container` is a file that is not decoded: `reader.read_container` makes one of bytes,
`building.build_container` of what an encoder has, and `writer.write_container` makes bytes of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from deltamesh_formats.container.layout import (
    CHECK,
    CRC_SIZE,
    ID_SIZE,
    INTERPOLATED,
    LEAST_SQUARES,
    MAX_BITS,
    METHODS,
    RANDOM,
    ZONE_UNIT,
)


@dataclass(frozen=True)
class Parameters:
    """Coding of the geometry; the payload of `PARM`.

    Attributes
    ----------
    method : str
        A key of `METHODS`.
    diffusion : bool
        Whether the encoder diffused the quantization error; the decoder has no use for it.
    anchor_method : str or None
        A key of `ANCHOR_METHODS`; None exactly for the methods without anchors.
    bits : int or None
        What was asked for, bits per coordinate; None when it was a step.
    step : float
        Quantization step, in the unit of the mesh; 0 exactly for an exact method, and for a bare
        one at 0 bits.
    origin : (float, float, float)
        Origin of the grid of the anchors, or of the Cartesian coordinates.
    anchor_step : float
        Step of that grid for the anchors; 0 without any.
    seed : int
        Seed of the random choice of anchors; 0 for other anchors.
    anchor_count : int
        Number of anchors; 0 for the methods without.
    isolated : int
        Number of points without a face.
    coarse : float
        The step of the deltas over `step`; 1 unless the method has coarse deltas.
    dead_zone, normal_dead_zone : float
        How far beyond half a step the encoder still rounded deltas, and refinements, to 0, in
        steps; multiples of 0.01. The decoder has no use for them.
    single : bool
        Whether the source holds positions in float32.
    interpolated : bool
        Whether the positions go through the anchors; else deltas and anchors are weighed against
        each other, in the least-squares sense.
    """

    method: str
    diffusion: bool = False
    anchor_method: str | None = None
    bits: int | None = None
    step: float = 0.0
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    anchor_step: float = 0.0
    seed: int = 0
    anchor_count: int = 0
    isolated: int = 0
    coarse: float = 1.0
    dead_zone: float = 0.0
    normal_dead_zone: float = 0.0
    single: bool = False
    interpolated: bool = False

    @property
    def solution(self) -> str | None:
        """Name of what positions make of deltas and anchors; None without anchors."""
        if self.anchor_method is None:
            return None
        return INTERPOLATED if self.interpolated else LEAST_SQUARES


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


@dataclass(frozen=True)
class Section:
    """Section of a file.

    Attributes
    ----------
    id : str
        Four letters.
    offset : int
        Where the section begins in the file, in bytes.
    payload : bytes or memoryview
    """

    id: str
    offset: int
    payload: bytes | memoryview = field(repr=False)

    @property
    def start(self) -> int:
        """Where the payload begins in the file, in bytes."""
        return self.offset + ID_SIZE + varint_size(len(self.payload))

    @property
    def end(self) -> int:
        """Where the section after this one begins, in bytes."""
        return self.start + len(self.payload) + CRC_SIZE

    @property
    def size(self) -> int:
        """Bytes of the whole section: id, length, payload and checksum."""
        return self.end - self.offset

    def __reduce__(self) -> tuple[type[Section], tuple[str, int, bytes]]:
        """Copy the payload: a view of a file cannot go to another process."""
        return Section, (self.id, self.offset, bytes(self.payload))


@dataclass(frozen=True)
class Container:
    """A file, checked but not decoded: a whole one, unless a prefix was asked for.

    Attributes
    ----------
    version : int
        Of the container.
    vertices, triangles : int
        Counts of the decoded mesh, whose polygons are cut into triangles.
    parameters : Parameters
    meta : Meta or None
    sections : dict of str to Section
        All of them by their ids, in the order of the file; of a prefix, those that have come.
    digest : bytes, 8
        Checksum of the decoded integers; empty in a prefix.
    cut : str
        The id of the section that a prefix ends within; "" for none, or before its id is there.
    """

    version: int
    vertices: int
    triangles: int
    parameters: Parameters
    meta: Meta | None
    sections: dict[str, Section]
    digest: bytes
    cut: str = ""

    @property
    def is_whole(self) -> bool:
        """Whether all sections have come."""
        return CHECK in self.sections

    @property
    def size(self) -> int:
        """Bytes of the whole file; of a prefix, up to the end of the last section."""
        return next(reversed(self.sections.values())).end

    @property
    def margin(self) -> float:
        """How far each decoded coordinate may be rounded; see `Meta.room`."""
        return 0.0 if self.meta is None else self.meta.room

    def __str__(self) -> str:
        from deltamesh_formats.container.summary import container_text

        return container_text(self)

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        from deltamesh_formats.container.summary import container_html

        return container_html(self)


def laid_out(payloads: Mapping[str, bytes], start: int) -> dict[str, Section]:
    """Return the sections that have these payloads and follow each other from byte `start` on."""
    sections: dict[str, Section] = {}
    for name, payload in payloads.items():
        sections[name] = Section(name, start, payload)
        start = sections[name].end
    return sections


def varint_size(value: int) -> int:
    """Return how many bytes a varint takes."""
    return max(1, -(-value.bit_length() // 7))


def parameter_faults(parameters: Parameters, vertices: int) -> Iterator[tuple[str, str]]:
    """Yield (field, what is wrong with it) by the rules of SPEC.md 4.1, for reader and writer."""
    p = parameters
    method = METHODS[p.method]
    stepless = method.exact or (method.bare and p.bits == 0)
    if method.anchored == (p.anchor_method is None):
        yield "anchor_method", f"method {p.method} with anchor method {p.anchor_method or 'none'}"
    if p.bits is not None and not 0 <= p.bits <= MAX_BITS:
        yield "bits", f"{p.bits} bits, outside 0..{MAX_BITS}"
    if p.bits is not None and method.exact:
        yield "bits", f"{p.bits} bits in a {method.title} file"
    if not (math.isfinite(p.step) and p.step >= 0 and (p.step == 0) == stepless):
        yield "step", f"a quantization step of {p.step}"
    for axis, value in zip("xyz", p.origin, strict=True):
        if not math.isfinite(value) or (method.exact and value):
            yield f"origin_{axis}", f"an origin of {value}"
    if not (math.isfinite(p.anchor_step) and p.anchor_step >= 0):
        yield "anchor_step", f"an anchor step of {p.anchor_step}"
    for name, count in (("anchor_count", p.anchor_count), ("isolated", p.isolated)):
        if not 0 <= count <= vertices:
            yield name, f"{count} {name.split('_')[0]} vertices among {vertices}"
    if not (1 <= p.coarse < math.inf and (method.coarse or p.coarse == 1)):
        yield "coarse", f"method {p.method} with deltas {p.coarse} times as coarse"
    for name in ("dead_zone", "normal_dead_zone"):
        if not 0 <= getattr(p, name) * ZONE_UNIT < 256:
            yield name, f"a dead zone of {getattr(p, name)}"
    if p.seed and p.anchor_method != RANDOM:
        yield "anchor_method", f"a seed of {p.seed} for anchors that are not random"
    if p.interpolated and (not method.anchored or stepless):
        yield "flags", "interpolated anchors in a file without deltas"
    if not method.anchored and (p.anchor_step or p.anchor_count):
        yield "anchor_count", f"anchors in a {method.title} file"


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
