// Section CONN: the faces of an oriented manifold.
import { readVarint } from "./bytes.mjs";
import { at, room } from "./core.mjs";
import { FormatError } from "./errors.mjs";

// Bytes of `dm_front` and of one of its nodes, and where the former counts its joins.
const FRONT = 1104;
const JOINS = 40;
const NODE = 72;
// Numbers of a vertex: its valence, its index before, whether it closes a boundary loop.
const VERTEX = 3;

/** Return the faces, over vertices in coding order; the counts are those of the manifold. */
export function decodeConnectivity(core, payload, { vertices, faces: count }) {
  let [loops, position] = readVarint(payload, 0);
  let border, joins;
  [border, position] = readVarint(payload, position);
  [joins, position] = readVarint(payload, position);
  if (loops > border || border > 3 * count || joins > count + border) {
    throw new FormatError("the counts of the connectivity contradict each other", 0);
  }
  const sizes = { vertices: vertices + loops, faces: count + border, loops, joins, position };
  const run = (coder) => grow(core, coder, sizes);
  const grown = core.decode(core.model("valence"), payload.subarray(position), run, position);
  const faces = openFaces(grown.faces, grown.isLoop);
  if (faces.length !== 3 * count) {
    const reason = "the connectivity has another number of faces than the header";
    throw new FormatError(reason, position);
  }
  const used = new Uint8Array(vertices);
  faces.forEach((v) => (used[v] = 1));
  if (used.includes(0)) {
    throw new FormatError("a vertex of the connectivity is in no face", position);
  }
  return faces;
}

/** Return the faces of the closed mesh, and which vertices close a loop. */
function grow(core, coder, { vertices, faces, loops, joins, position }) {
  const capacity = vertices + joins;
  const rows = new Int32Array(3 * faces);
  return core.withMemory((allocate) => {
    const front = allocate(FRONT);
    const nodes = allocate(NODE * capacity);
    const live = allocate(8 * capacity);
    const facesAt = allocate(24 * faces);
    const verticesAt = allocate(8 * VERTEX * vertices);
    core.bytes(verticesAt, 8 * VERTEX * vertices).fill(0);
    core.exports.dm_start_front(front, nodes, live, BigInt(capacity));
    const old = [room(0), 0, room(0), 0];
    const made = [at(facesAt), faces, at(verticesAt), vertices, room(0)];
    const loopStart = vertices - loops;
    const sound = core.good("dm_grow", coder, at(front), ...old, ...made, loops, loopStart);
    const found = new DataView(core.exports.memory.buffer, front, FRONT);
    if (!sound || Number(found.getBigInt64(JOINS, true)) !== joins) {
      throw new FormatError("the connectivity is corrupt", position);
    }
    const { buffer } = core.exports.memory;
    const words = new Int32Array(buffer, facesAt, 2 * rows.length);
    for (let i = 0; i < rows.length; i++) rows[i] = words[2 * i];
    const rest = new Int32Array(buffer, verticesAt, 2 * VERTEX * vertices);
    const isLoop = new Uint8Array(vertices);
    for (let v = 0; v < vertices; v++) isLoop[v] = rest[2 * (VERTEX * v + 2)];
    return { faces: rows, isLoop };
  });
}

/** Return the faces without those that close boundary loops. */
function openFaces(faces, isLoop) {
  const index = new Int32Array(isLoop.length);
  for (let v = 0, next = 0; v < isLoop.length; v++) index[v] = isLoop[v] ? -1 : next++;
  const open = new Int32Array(faces.length);
  let kept = 0;
  for (let f = 0; f < faces.length; f += 3) {
    const [a, b, c] = [index[faces[f]], index[faces[f + 1]], index[faces[f + 2]]];
    if (a < 0 || b < 0 || c < 0) continue;
    open[kept++] = a;
    open[kept++] = b;
    open[kept++] = c;
  }
  return open.slice(0, kept);
}
