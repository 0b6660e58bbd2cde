"""Constants of the payloads of sections, in the order of SPEC.md, section 5.

A test compares them with SPEC.md. A number that a file holds is written out here and never changes;
no order of names elsewhere stands for one.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

from deltamesh_formats.container.fields import Field

if TYPE_CHECKING:
    from deltamesh_formats.polymesh.kinds import Kind
    from deltamesh_formats.polymesh.mesh import Domain, Role


# SPEC.md#53-anch

# Bits of a coordinate of a grid point: what the entropy coder takes, |value| < 2^31, with a bit to
# spare for diffused errors.
MAX_GRID_BITS: Final = 30

# SPEC.md#511-ordr

# `plan`: bits 0 and 1, the anchor of a polygon; the newest neighbour is the anchor of a vertex, not
# the oldest; polygons come first.
PLAN_ANCHOR: Final = 3
PLAN_NEWEST: Final = 4
PLAN_POLYGONS_FIRST: Final = 8
POLYGON_ANCHORS: Final[Mapping[str, int]] = {"first": 0, "oldest": 1, "newest": 2}

# SPEC.md#512-exac

# Bits of a raw number, which the first byte has.
RAW_WIDTHS: Final[Mapping[str, int]] = {"binary32": 32, "binary64": 64}
# Fields of a column, and of each of its number formats; `flags`: bits 0 and 1, how many formats.
COLUMN_FIELDS: Final = (Field("flags", "u8"), Field("grid", "i16"))
FORMAT_FIELDS: Final = (
    Field("base", "u8"),
    Field("places", "i16"),
    Field("digits", "u8"),
    Field("usual", "u8"),
)
COLUMN_FORMATS: Final = 3
COLUMN_RAW: Final = 4
COLUMN_ZEROS: Final = 8
COLUMN_OPERATIONS: Final = 0x30
COLUMN_DOUBLE: Final = 0x40
COLUMN_DEVIATIONS: Final = 0x80
# Fields of an operation, and how it combines a number with its operand.
OPERATION_FIELDS: Final = (Field("operator", "u8"), Field("operand", "f64"))
OPERATORS: Final[Mapping[str, int]] = {"add": 0, "multiply": 1, "divide": 2}

# SPEC.md#514-attr

# `what`: bits 0 and 1, the domain; bits 2 and 3, the role; bits 4 to 7, the type.
DOMAINS: Final[Mapping[Domain, int]] = {"vertex": 0, "corner": 1, "face": 2}
ROLES: Final[Mapping[Role, int]] = {"normal": 0, "uv": 1, "colour": 2, "other": 3}
TYPES: Final[Mapping[str, int]] = {
    "bool": 0,
    "uint8": 1,
    "uint16": 2,
    "uint32": 3,
    "uint64": 4,
    "int8": 5,
    "int16": 6,
    "int32": 7,
    "int64": 8,
    "float16": 9,
    "float32": 10,
    "float64": 11,
    "complex64": 12,
    "complex128": 13,
}
ROLE_AT: Final = 2
TYPE_AT: Final = 4
# Bits of `flags`; bits 4 and 5, the coding.
NORMALIZED: Final = 1
PARTLY: Final = 2
PALETTE: Final = 4
MIXED: Final = 8
CODING_AT: Final = 4
FIRST_NONE: Final = 64
Coding: TypeAlias = Literal["integer", "exact", "grid", "octahedral"]
CODINGS: Final[Mapping[Coding, int]] = {"integer": 0, "exact": 1, "grid": 2, "octahedral": 3}
# Fields after the common ones, where numbers are integers.
INTEGER_FIELDS: Final = (Field("origin", "u64"), Field("bits", "u8"), Field("limbs", "u8"))
# `wedges`: those of the attribute itself; none, values belong to polygons; from there on, those of
# attribute 0, 1, ...
OWN_WEDGES: Final = 0
POLYGON_OWNERS: Final = 1
WEDGES_OF: Final = 2
# A residual of such numbers is below 2^30: its length ends with a bit of zero, so that no number of
# elements takes no bytes.
MAX_LIMB_BITS: Final = 29

# SPEC.md#515-part

# Encodings of a block.
BLOCK_PLAIN: Final = 0
BLOCK_DEFLATED: Final = 1
BLOCK_ZSTD: Final = 2
# A byte for each division: bits 0 to 2, its kind.
KINDS: Final[Mapping[Kind, int]] = {
    "object": 0,
    "mesh": 1,
    "group": 2,
    "material": 3,
    "smoothing": 4,
}
DIVISION_KIND: Final = 7
DIVISION_PARTLY: Final = 8
DIVISION_MOVED: Final = 16
# Bytes of all the text of a file, before it is packed: bounds what a small file can grow to.
MAX_TEXT: Final = 2**24

# SPEC.md#517-octahedral-normals

MIN_NORMAL_BITS: Final = 2
MAX_NORMAL_BITS: Final = 30
# `plan`: bits 0 and 1, the weights; bit 2, the coding.
NORMAL_WEIGHTS: Final[Mapping[str, int]] = {"area": 0, "angle": 1, "equal": 2, "none": 3}
NORMAL_CODINGS: Final[Mapping[str, int]] = {"deltas": 0, "numbers": 1}
NORMAL_CODING_AT: Final = 2
NORMAL_STATES: Final[Mapping[str, int]] = {"relative": 0, "absolute": 1, "zero": 2}

# SPEC.md#518-fill

# Elements that a byte stands for at most. A predicted bit takes log2(65536 / 65512) bits of a byte
# where most bits are alike, so that few meshes have more.
MAX_ELEMENTS_PER_BYTE: Final = 15200

# SPEC.md#519-step

# Exponents of steps, in quarters of an octave, and the ratios of those below an octave: the doubles
# nearest to 1, 2^-1/4, 2^-1/2 and 2^-3/4.
MAX_EXPONENT: Final = 120
PER_OCTAVE: Final = 4
QUARTERS: Final = (1.0, 0.8408964152537145, 0.7071067811865476, 0.5946035575013605)

# SPEC.md#520-cell

# Octaves of a unit above the step; a byte of 0 stands for the least.
LEAST_UNIT: Final = -32
MOST_UNIT: Final = 32

# SPEC.md#521-pose

# Fields of a pose, before its stream. The unit of rotations is 2^-octaves.
POSE_FIELDS: Final = (
    Field("name", "string"),
    Field("step", "f64"),
    Field("octaves", "u8"),
    Field("size", "varint"),
)
MOST_OCTAVES: Final = 24

# SPEC.md#522-fram

SEQUENCE_FIELDS: Final = (Field("rate", "f64"), Field("count", "varint"))
FRAME_FIELDS: Final = (
    Field("flags", "u8"),
    Field("finer", "u8"),
    Field("step", "f64"),
    Field("coarse", "f32"),
    Field("rms", "f32"),
    Field("max", "f32"),
    Field("normal", "f32"),
    Field("dihedral", "f32"),
    Field("digest", "bytes8"),
    Field("maps", "varint"),
)
# Where there are maps.
MAP_FIELDS: Final = (Field("rounds", "u8"), Field("unit", "u8"))
# Bits of `flags`: a key frame; vectors of cells; corrections.
FRAME_KEY: Final = 1
FRAME_CELLS: Final = 2
FRAME_CORRECTIONS: Final = 4
# The stream of the maps, beside those that are named as the sections of frame 0 are.
MAPS: Final = "MAPS"
# How often the grid of a frame may halve that of frame 0.
MAX_FINER: Final = 30
# The finest unit of the numbers of a map, 2^-unit, and the largest of them, in units of 1.
MAX_MAP_UNIT: Final = 30
# Frames in a row that are predicted from the frame before.
MAX_RUN: Final = 255
