"""Constants of the `.dmesh` container, in the order of SPEC.md.

`reader` and `writer` are mirror images over these tables; a test compares them with the byte
tables of SPEC.md, so none of the three can drift. A number that a file holds is written out here
and never changes; no order of names elsewhere stands for one.
"""

from __future__ import annotations

import struct
from collections.abc import Collection, Mapping
from dataclasses import dataclass
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
    Field("triangles", "varint"),
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
