// Readers of OBJ and PLY files that are dropped: positions and polygons, with colours of vertices.
import { MAGIC } from "../decoder/layout.mjs";
import { trianglesOf } from "../decoder/triangles.mjs";

/** Return the mesh in a file, by the end of its name; null for `.dmesh` files, and unknown ones. */
export function readMeshFile(name, bytes) {
  if (bytes[0] === MAGIC[0]) return null;
  const end = name.toLowerCase().split(".").pop();
  const readers = { obj: readObj, ply: readPly };
  return readers[end] ? readers[end](bytes) : null;
}

function meshOf(positions, corners, offsets, attributes = []) {
  const count = positions.length / 3;
  if (!count || offsets.length < 2) throw new Error("a file without a face");
  if (corners.some((v) => !(v >= 0 && v < count))) throw new Error("a face of a vertex that is none");
  const wrong = positions.findIndex((x) => !Number.isFinite(x));
  if (wrong >= 0) throw new Error(`vertex ${Math.floor(wrong / 3)} has a position that is no number`);
  const mesh = {
    positions: Float64Array.from(positions),
    corners: Int32Array.from(corners),
    offsets: Int32Array.from(offsets),
  };
  const none = { parts: [], metadata: new Map(), lost: [], anchors: new Int32Array(0) };
  return { ...mesh, attributes, ...none, ...trianglesOf(mesh.positions, mesh.corners, mesh.offsets) };
}

function readObj(bytes) {
  const positions = [];
  const corners = [];
  const offsets = [0];
  for (const line of new TextDecoder().decode(bytes).replaceAll("\\\n", " ").split("\n")) {
    const words = line.trim().split(/\s+/);
    if (words[0] === "v") positions.push(...[1, 2, 3].map((i) => Number(words[i])));
    if (words[0] !== "f" || words.length < 4) continue;
    for (const word of words.slice(1)) {
      const index = parseInt(word, 10);
      corners.push(index < 0 ? positions.length / 3 + index : index - 1);
    }
    offsets.push(corners.length);
  }
  return meshOf(positions, corners, offsets);
}

const SIZES = { int8: 1, uint8: 1, int16: 2, uint16: 2, int32: 4, uint32: 4, float32: 4, float64: 8 };
const ALIASES = {
  char: "int8",
  uchar: "uint8",
  short: "int16",
  ushort: "uint16",
  int: "int32",
  uint: "uint32",
  float: "float32",
  double: "float64",
};
const GETTERS = {
  int8: "getInt8",
  uint8: "getUint8",
  int16: "getInt16",
  uint16: "getUint16",
  int32: "getInt32",
  uint32: "getUint32",
  float32: "getFloat32",
  float64: "getFloat64",
};

function readPly(bytes) {
  const head = new TextDecoder("latin1").decode(bytes.subarray(0, 65536));
  const end = /end_header\r?\n/.exec(head);
  if (!head.startsWith("ply") || !end) throw new Error("not a PLY file");
  const { format, elements } = headerOf(head.slice(0, end.index));
  const next = format === "ascii" ? wordsOf(bytes, end) : binaryOf(bytes, end, format);
  const positions = [];
  const colours = [];
  const corners = [];
  const offsets = [0];
  for (const { name, count, properties } of elements) {
    for (let i = 0; i < count; i++) {
      const row = {};
      for (const property of properties) {
        if (!property.list) row[property.name] = next(property.type);
        else row[property.name] = Array.from({ length: next(property.list) }, () => next(property.type));
      }
      if (name === "vertex") {
        positions.push(row.x, row.y, row.z);
        if ("red" in row) colours.push(row.red, row.green, row.blue);
      }
      const list = row.vertex_indices ?? row.vertex_index;
      if (name === "face" && list?.length > 2) {
        corners.push(...list);
        offsets.push(corners.length);
      }
    }
  }
  return meshOf(positions, corners, offsets, colours.length ? [colourOf(colours)] : []);
}

function colourOf(colours) {
  const type = "uint8";
  const values = Uint8Array.from(colours);
  return { name: "colour", domain: "vertex", role: "colour", type, width: 3, values, has: null };
}

function headerOf(head) {
  const elements = [];
  let format = "ascii";
  for (const line of head.split(/\r?\n/)) {
    const words = line.trim().split(/\s+/);
    const typeOf = (word) => ALIASES[word] ?? word;
    if (words[0] === "format") format = words[1];
    if (words[0] === "element") {
      elements.push({ name: words[1], count: Number(words[2]), properties: [] });
    }
    if (words[0] !== "property") continue;
    const isList = words[1] === "list";
    const [type, name] = words.slice(-2);
    const list = isList ? typeOf(words[2]) : null;
    const unknown = [typeOf(type), list ?? "int8"].find((one) => !(one in SIZES));
    if (unknown) throw new Error(`a property of the type ${unknown}`);
    elements.at(-1).properties.push({ name, type: typeOf(type), list });
  }
  return { format, elements };
}

const cutShort = () => new Error("the file ends before its last row: is it cut short?");

function wordsOf(bytes, end) {
  const text = new TextDecoder().decode(bytes.subarray(end.index + end[0].length));
  const words = text.split(/\s+/).filter((word) => word);
  let i = 0;
  return () => {
    if (i === words.length) throw cutShort();
    return Number(words[i++]);
  };
}

function binaryOf(bytes, end, format) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let at = end.index + end[0].length;
  const isLittle = format === "binary_little_endian";
  return (type) => {
    if (at + SIZES[type] > bytes.length) throw cutShort();
    const value = view[GETTERS[type]](at, isLittle);
    at += SIZES[type];
    return value;
  };
}
