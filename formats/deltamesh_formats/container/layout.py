"""Every constant of the `.dmesh` container, in the order of SPEC.md, and the plain data it holds.

`reader` and `writer` are mirror images over these tables; a test compares them with the byte
tables of SPEC.md, so none of the three can drift.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final, NamedTuple


class Field(NamedTuple):
    """One field of a byte table: its name and a type of `STRUCT_CODES`, `varint` or `string`."""

    name: str
    type: str


# SPEC.md#1-conventions

# Everything is little-endian and unaligned: "<" turns the padding of `struct` off.
STRUCT_CODES: Final[Mapping[str, struct.Struct]] = {
    "u8": struct.Struct("<B"),
    "u16": struct.Struct("<H"),
    "u32": struct.Struct("<I"),
    "u64": struct.Struct("<Q"),
    "f32": struct.Struct("<f"),
    "f64": struct.Struct("<d"),
    "bytes8": struct.Struct("8s"),
}

# Nine bytes hold 63 bits: a value always fits a signed 64-bit integer.
VARINT_MAX_BYTES: Final = 9
VARINT_MAX: Final = 2 ** (7 * VARINT_MAX_BYTES) - 1

# A `string` has a length byte.
STRING_MAX_BYTES: Final = 255

# SPEC.md#2-header

# In the manner of PNG: a byte above 127 shows a seven-bit channel, CR LF and LF show a translation
# of line ends, 1A stops `type` on Windows.
MAGIC: Final = b"\x89DMS\r\n\x1a\n"
VERSION: Final = 2
HEADER_FIELDS: Final = (
    Field("magic", "bytes8"),
    Field("version", "u16"),
    Field("reserved", "u16"),
    Field("vertices", "varint"),
    Field("faces", "varint"),
    Field("crc", "u32"),
)
# Far above any mesh, and far below where 3 * count * 8 bytes would overflow 64 bits.
MAX_COUNT: Final = 2**40

# SPEC.md#3-sections

ID_SIZE: Final = 4
CRC_SIZE: Final = 4
MAX_SECTIONS: Final = 64
PARAMETERS: Final = "PARM"
CONNECTIVITY: Final = "CONN"
STITCHES: Final = "STCH"
COPIES: Final = "COPY"
POLYGONS: Final = "POLY"
ANCHORS: Final = "ANCH"
DELTAS: Final = "DELT"
NORMALS: Final = "NORM"
CARTESIAN: Final = "CART"
ATTRIBUTES: Final = "ATTR"
PARTS: Final = "PART"
ORDER: Final = "ORDR"
EXACT: Final = "EXAC"
CORRECTIONS: Final = "FIXS"
META: Final = "meta"
CHECK: Final = "CHEK"
# Sections that follow `CONN`, and those that follow the geometry, in this order, where needed.
AFTER_CONNECTIVITY: Final = (STITCHES, COPIES, POLYGONS)
AFTER_GEOMETRY: Final = (ATTRIBUTES, PARTS, ORDER)


@dataclass(frozen=True)
class MethodLayout:
    """A geometry method as the container knows it: its sections, and its rules for `PARM`.

    Attributes
    ----------
    name : str
    id : int
        The byte in `PARM`; it never changes.
    title : str
        The name for people.
    geometry : tuple of str
        The sections of the geometry, in their order; isolated vertices are in the first.
    corrected : bool
        Whether `FIXS` may follow them.
    anchored : bool
        Whether the file has anchors, from which positions are solved for.
    exact : bool
        Whether positions are stored to the last bit: without bits, a step, or an origin.
    bare : bool
        Whether 0 bits leave the anchors alone, without a step.
    coarse : bool
        Whether the deltas may have a coarser step than `step`.
    """

    name: str
    id: int
    title: str
    geometry: tuple[str, ...]
    corrected: bool = False
    anchored: bool = False
    exact: bool = False
    bare: bool = False
    coarse: bool = False

    @property
    def required(self) -> tuple[str, ...]:
        """The sections that a file begins with, in this order; `CHEK` ends it."""
        return (PARAMETERS, CONNECTIVITY, *self.geometry)

    @property
    def further(self) -> tuple[str, ...]:
        """The sections that may follow these, in this order."""
        return (*((CORRECTIONS,) if self.corrected else ()), *AFTER_GEOMETRY)


METHODS: Final[Mapping[str, MethodLayout]] = {
    method.name: method
    for method in (
        MethodLayout(
            "highpass", 0, "high-pass", (ANCHORS, DELTAS), corrected=True, anchored=True, bare=True
        ),
        MethodLayout("cartesian", 1, "Cartesian", (CARTESIAN,)),
        MethodLayout(
            "refined",
            2,
            "refined high-pass",
            (ANCHORS, DELTAS, NORMALS),
            corrected=True,
            anchored=True,
            coarse=True,
        ),
        MethodLayout("lossless", 3, "lossless", (EXACT,), exact=True),
    )
}
KNOWN: Final = frozenset(
    {META, CHECK, *AFTER_CONNECTIVITY}.union(
        *({*method.required, *method.further} for method in METHODS.values())
    )
)

# SPEC.md#41-parm

PARAMETER_FIELDS: Final = (
    Field("method", "u8"),
    Field("flags", "u8"),
    Field("anchor_method", "u8"),
    Field("bits", "u8"),
    Field("step", "f64"),
    Field("origin_x", "f64"),
    Field("origin_y", "f64"),
    Field("origin_z", "f64"),
    Field("anchor_step", "f64"),
    Field("seed", "u64"),
    Field("coarse", "f32"),
    Field("dead_zone", "u8"),
    Field("normal_dead_zone", "u8"),
    Field("anchor_count", "varint"),
    Field("isolated", "varint"),
)
FLAG_DIFFUSION: Final = 1
FLAG_SINGLE: Final = 2
ANCHOR_METHODS: Final[Mapping[str | None, int]] = {
    "farthest": 0,
    "random": 1,
    "greedy": 2,
    None: 255,
}
# Dead zones are stored in hundredths of a step.
ZONE_UNIT: Final = 100
MAX_BITS: Final = 62
BITS_FROM_STEP: Final = 255

# SPEC.md#42-meta

META_FIELDS: Final = (
    Field("rms", "f64"),
    Field("max", "f64"),
    Field("normal", "f32"),
    Field("dihedral", "f32"),
    Field("diagonal", "f64"),
    Field("encoder", "string"),
    Field("source", "string"),
)

# SPEC.md#57-chek

CHECK_FIELDS: Final = (Field("digest", "bytes8"),)
DIGEST_SIZE: Final = 8

# SPEC.md#515-part

# Bytes of all the text of a file, before it is packed: bounds what a small file can grow to.
MAX_TEXT: Final = 2**24


def required(method: str, present: Collection[str]) -> tuple[str, ...]:
    """Return the sections that a file of a method begins with, where those `present` are."""
    ids = METHODS[method].required
    after = ids.index(CONNECTIVITY) + 1
    needed = tuple(name for name in AFTER_CONNECTIVITY if name in present)
    further = tuple(name for name in METHODS[method].further if name in present)
    return (*ids[:after], *needed, *ids[after:], *further)


@dataclass(frozen=True)
class Parameters:
    """How the geometry was coded; the payload of `PARM`.

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
        Seed of the random choice of anchors.
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


@dataclass(frozen=True)
class Meta:
    """What the encoder achieved and what it read; the payload of `meta`.

    Attributes
    ----------
    rms, max : float
        Distances between input and decoded vertices, in the unit of the mesh.
    normal, dihedral : float
        Mean deviation of the face normals and of the dihedral angles, in degrees.
    diagonal : float
        Diagonal of the bounding box of the input, in the unit of the mesh.
    encoder : str
        Name and version of the program.
    source : str
        Format of the input file, empty for arrays.
    """

    rms: float
    max: float
    normal: float
    dihedral: float
    diagonal: float
    encoder: str
    source: str


@dataclass(frozen=True)
class Section:
    """One section: where it begins in the file, its payload, and all the bytes it takes."""

    id: str
    offset: int
    payload: bytes | memoryview = field(repr=False)
    size: int

    def __reduce__(self) -> tuple[type[Section], tuple[str, int, bytes, int]]:
        """Copy the payload: a view of a file cannot go to another process."""
        return Section, (self.id, self.offset, bytes(self.payload), self.size)


@dataclass(frozen=True)
class Container:
    """A whole file, read and checked but not decoded; `sections` are in the order of the file."""

    version: int
    vertices: int
    faces: int
    parameters: Parameters
    meta: Meta | None
    sections: dict[str, Section]
    digest: bytes
    size: int

    def __str__(self) -> str:
        from deltamesh_formats.container.summary import container_text

        return container_text(self)

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        from deltamesh_formats.container.summary import container_html

        return container_html(self)


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
    if not method.anchored and (p.anchor_step or p.anchor_count):
        yield "anchor_count", f"anchors in a {method.title} file"


def meta_faults(meta: Meta) -> Iterator[tuple[str, str]]:
    """Yield (field, what is wrong with it) by the rules of SPEC.md 4.2, for reader and writer."""
    for name in ("rms", "max", "normal", "dihedral", "diagonal"):
        value = getattr(meta, name)
        if not (math.isfinite(value) and value >= 0):
            yield name, f"{name} is {value}"
    for name in ("encoder", "source"):
        # It will be printed on a terminal: no escape sequences, no line ends.
        if not getattr(meta, name).isprintable():
            yield name, f"the {name} name holds control characters"
