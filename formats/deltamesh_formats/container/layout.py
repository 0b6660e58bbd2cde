"""Constants of the `.dmesh` container, in the order of SPEC.md, sections 2 to 4.

Those of the payloads are in `payload_layout`, the sections of each method in `method_layouts`.

Readers and writers are mirror images over these tables; a test compares them with the byte tables
of SPEC.md, so none of the three can drift. A number that a file holds is written out here
and never changes; no order of names elsewhere stands for one.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

from deltamesh_formats.container.fields import Field

if TYPE_CHECKING:
    pass


# SPEC.md#2-header

# In the manner of PNG: a byte above 127 shows a seven-bit channel, CR LF and LF show a translation
# of line ends, 1A stops `type` on Windows.
MAGIC: Final = b"\x89DMS\r\n\x1a\n"
VERSION: Final = 4
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
MAX_SECTIONS: Final = 64
PARAMETERS: Final = "PARM"
CONNECTIVITY: Final = "CONN"
STITCHES: Final = "STCH"
SPLIT_VERTICES: Final = "COPY"
POLYGONS: Final = "POLY"
STEPS: Final = "STEP"
ANCHORS: Final = "ANCH"
CELLS: Final = "CELL"
DELTAS: Final = "DELT"
NORMALS: Final = "NORM"
CARTESIAN: Final = "CART"
ATTRIBUTES: Final = "ATTR"
PARTS: Final = "PART"
ORDER: Final = "ORDR"
POSES: Final = "POSE"
FILLING: Final = "FILL"
FRAMES: Final = "FRAM"
EXACT: Final = "EXAC"
CORRECTIONS: Final = "FIXS"
META: Final = "meta"
REGIONS: Final = "regs"
CHECK: Final = "CHEK"
# Sections that follow `CONN`, and those that follow the geometry, in this order, where needed.
AFTER_CONNECTIVITY: Final = (STITCHES, SPLIT_VERTICES, POLYGONS, STEPS)
AFTER_GEOMETRY: Final = (ATTRIBUTES, PARTS, ORDER, POSES, FILLING, FRAMES)


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
    Field("coarse", "f32"),
    Field("dead_zone", "u8"),
    Field("normal_dead_zone", "u8"),
    Field("anchor_count", "varint"),
    Field("isolated", "varint"),
)
# Where the anchors are random.
SEED_FIELDS: Final = (Field("seed", "u64"),)
FLAG_DIFFUSION: Final = 1
FLAG_SINGLE: Final = 2
FLAG_INTERPOLATED: Final = 4
# What positions make of deltas and anchors: they go through the anchors, or come near to both.
INTERPOLATED: Final = "interpolated"
LEAST_SQUARES: Final = "least-squares"
FARTHEST: Final = "farthest"
RANDOM: Final = "random"
GREEDY: Final = "greedy"
ANCHOR_METHODS: Final[Mapping[str | None, int]] = {
    FARTHEST: 0,
    RANDOM: 1,
    GREEDY: 2,
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
    Field("margin", "u8"),
    Field("encoder", "string"),
    Field("source", "string"),
)
# Where anything is lost or turned, or there are several parts; and where there are several.
META_LOSS_FIELDS: Final = (
    Field("lost", "varint"),
    Field("turned", "varint"),
    Field("parts", "varint"),
)
META_PART_FIELDS: Final = (
    Field("part_normal", "f32"),
    Field("part_rms", "f64"),
    Field("part", "string"),
)

# SPEC.md#43-regs

REGION_FIELDS: Final = (
    Field("full", "varint"),
    Field("reduced", "varint"),
    Field("none", "varint"),
    Field("rms_full", "f64"),
    Field("max_full", "f64"),
    Field("normal_full", "f32"),
    Field("dihedral_full", "f32"),
    Field("rms_reduced", "f64"),
    Field("max_reduced", "f64"),
    Field("normal_reduced", "f32"),
    Field("dihedral_reduced", "f32"),
)

# SPEC.md#57-chek

CHECK_FIELDS: Final = (Field("digest", "bytes8"),)
DIGEST_SIZE: Final = 8
