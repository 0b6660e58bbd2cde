"""Constants of the `.dmesh` container, in the order of SPEC.md.

Readers and writers are mirror images over these tables; a test compares them with the byte tables
of SPEC.md, so none of the three can drift. A number that a file holds is written out here
and never changes; no order of names elsewhere stands for one.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

from deltamesh_formats.container.fields import Field

if TYPE_CHECKING:
    from deltamesh_formats.polymesh.kinds import Kind
    from deltamesh_formats.polymesh.mesh import Domain, Role


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
        Whether the file has anchors, from which positions are solved for; `CELL` and `POSE` may
        follow, then.
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
    def after_connectivity(self) -> tuple[str, ...]:
        """The sections that may follow `CONN`, in this order: an exact method has no steps."""
        return tuple(name for name in AFTER_CONNECTIVITY if name != STEPS or not self.exact)

    @property
    def further(self) -> tuple[str, ...]:
        """The sections that may follow these, in this order: an exact method has one frame."""
        cells, corrections = (
            (CELLS,) if self.anchored else (),
            (CORRECTIONS,) if self.corrected else (),
        )
        left_out = {POSES: not self.anchored, FRAMES: self.exact}
        after = (name for name in AFTER_GEOMETRY if not left_out.get(name, False))
        return (*cells, *corrections, *after)


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
    {META, REGIONS, CHECK, *AFTER_CONNECTIVITY}.union(
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

# SPEC.md#53-anch

# Bits of a coordinate of a grid point: what the entropy coder takes, |value| < 2^31, with a bit to
# spare for diffused errors.
MAX_GRID_BITS: Final = 30

# SPEC.md#57-chek

CHECK_FIELDS: Final = (Field("digest", "bytes8"),)
DIGEST_SIZE: Final = 8

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


def required(method: str, present: Collection[str]) -> tuple[str, ...]:
    """Return the sections that a file of a method begins with, where those `present` are."""
    ids = METHODS[method].required
    after = ids.index(CONNECTIVITY) + 1
    needed = tuple(name for name in METHODS[method].after_connectivity if name in present)
    further = tuple(name for name in METHODS[method].further if name in present)
    return (*ids[:after], *needed, *ids[after:], *further)
