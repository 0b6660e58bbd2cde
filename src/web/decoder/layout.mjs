// Constants of the `.dmesh` container, in the order of formats/SPEC.md.

export const MAGIC = [0x89, 0x44, 0x4d, 0x53, 0x0d, 0x0a, 0x1a, 0x0a];
export const VERSION = 4;
export const VARINT_MAX_BYTES = 9;
export const MAX_COUNT = 2 ** 40;
export const ID_SIZE = 4;
export const CRC_SIZE = 4;
export const MAX_SECTIONS = 64;

export const HEADER_FIELDS = [
  ["magic", "bytes8"],
  ["version", "u16"],
  ["reserved", "u16"],
  ["vertices", "varint"],
  ["triangles", "varint"],
  ["crc", "u32"],
];

// Sections that follow CONN, and those that follow the geometry, in this order, where needed.
export const AFTER_CONNECTIVITY = ["STCH", "COPY", "POLY", "STEP"];
export const AFTER_GEOMETRY = ["ATTR", "PART", "ORDR", "POSE", "FILL", "FRAM"];
export const METHODS = [
  {
    name: "highpass",
    title: "high-pass",
    geometry: ["ANCH", "DELT"],
    corrected: true,
    anchored: true,
    bare: true,
  },
  {
    name: "cartesian",
    title: "Cartesian",
    geometry: ["CART"],
    memory: 2 ** 26,
    memoryPerVertex: 300,
  },
  {
    name: "refined",
    title: "refined high-pass",
    geometry: ["ANCH", "DELT", "NORM"],
    corrected: true,
    anchored: true,
    coarse: true,
  },
  {
    name: "lossless",
    title: "lossless",
    geometry: ["EXAC"],
    exact: true,
    memory: 2 ** 26,
    memoryPerVertex: 400,
  },
];
// Memory of decoding, by what positions make of deltas and anchors.
export const INTERPOLATED = { memory: 2 ** 26, memoryPerVertex: 400 };
export const LEAST_SQUARES = { memory: 2 ** 28, memoryPerVertex: 4000 };
export const KNOWN = new Set([
  "PARM",
  "CONN",
  "meta",
  "regs",
  "CHEK",
  "CELL",
  "FIXS",
  ...AFTER_CONNECTIVITY,
  ...AFTER_GEOMETRY,
  ...METHODS.flatMap((method) => method.geometry),
]);

export const PARAMETER_FIELDS = [
  ["method", "u8"],
  ["flags", "u8"],
  ["anchor_method", "u8"],
  ["bits", "u8"],
  ["step", "f64"],
  ["origin_x", "f64"],
  ["origin_y", "f64"],
  ["origin_z", "f64"],
  ["anchor_step", "f64"],
  ["coarse", "f32"],
  ["dead_zone", "u8"],
  ["normal_dead_zone", "u8"],
  ["anchor_count", "varint"],
  ["isolated", "varint"],
];
export const SEED_FIELDS = [["seed", "u64"]];
export const ANCHOR_METHODS = new Map([
  [0, "farthest"],
  [1, "random"],
  [2, "greedy"],
  [255, null],
]);
export const FLAG_SINGLE = 2;
export const FLAG_INTERPOLATED = 4;
export const MAX_BITS = 62;
export const BITS_FROM_STEP = 255;

export const META_FIELDS = [
  ["rms", "f64"],
  ["max", "f64"],
  ["normal", "f32"],
  ["dihedral", "f32"],
  ["diagonal", "f64"],
  ["margin", "u8"],
  ["encoder", "string"],
  ["source", "string"],
];
export const META_LOSS_FIELDS = [
  ["lost", "varint"],
  ["turned", "varint"],
  ["parts", "varint"],
];
export const META_PART_FIELDS = [
  ["part_normal", "f32"],
  ["part_rms", "f64"],
  ["part", "string"],
];

export const MAX_GRID_BITS = 30;
export const POSITION_LARGEST = 1e150;
export const RAW_WIDTHS = [32, 64];
export const MAX_LIMB_BITS = 29;
export const OWN_WEDGES = 0;
export const POLYGON_OWNERS = 1;
export const WEDGES_OF = 2;
export const DOMAINS = ["vertex", "corner", "face"];
export const ROLES = ["normal", "uv", "colour", "other"];
export const CODINGS = ["integer", "exact", "grid", "octahedral"];
export const TYPES = [
  "bool",
  "uint8",
  "uint16",
  "uint32",
  "uint64",
  "int8",
  "int16",
  "int32",
  "int64",
  "float16",
  "float32",
  "float64",
  "complex64",
  "complex128",
];
export const KINDS = ["object", "mesh", "group", "material", "smoothing"];
export const MAX_TEXT = 2 ** 24;
export const MIN_NORMAL_BITS = 2;
export const MAX_NORMAL_BITS = 30;
export const MAX_ELEMENTS_PER_BYTE = 15200;
export const MAX_EXPONENT = 120;
export const PER_OCTAVE = 4;
export const LEAST_UNIT = -32;
export const MOST_UNIT = 32;
export const MOST_OCTAVES = 24;
export const POSE_FIELDS = [
  ["name", "string"],
  ["step", "f64"],
  ["octaves", "u8"],
  ["size", "varint"],
];
export const QUARTERS = [1, 0.8408964152537145, 0.7071067811865476, 0.5946035575013605];
export const SEQUENCE_FIELDS = [
  ["rate", "f64"],
  ["count", "varint"],
];
export const FRAME_FIELDS = [
  ["flags", "u8"],
  ["finer", "u8"],
  ["step", "f64"],
  ["coarse", "f32"],
  ["rms", "f32"],
  ["max", "f32"],
  ["normal", "f32"],
  ["dihedral", "f32"],
  ["digest", "bytes8"],
  ["maps", "varint"],
];
export const MAP_FIELDS = [
  ["rounds", "u8"],
  ["unit", "u8"],
];
export const FRAME_KEY = 1;
export const FRAME_CELLS = 2;
export const FRAME_CORRECTIONS = 4;
export const MAX_FINER = 30;
export const MAX_MAP_UNIT = 30;
export const MAX_RUN = 255;

/** Return the sections that a file of a method begins with, where those `present` are. */
export function required(method, present) {
  const after = AFTER_CONNECTIVITY.filter((id) => id !== "STEP" || !method.exact);
  const cells = method.anchored ? ["CELL"] : [];
  const leftOut = { POSE: !method.anchored, FRAM: method.exact };
  const last = AFTER_GEOMETRY.filter((id) => !leftOut[id]);
  const further = [...cells, ...(method.corrected ? ["FIXS"] : []), ...last];
  const there = (ids) => ids.filter((id) => present.has(id));
  return ["PARM", "CONN", ...there(after), ...method.geometry, ...there(further)];
}
