// Section ORDR: the order of vertices and polygons (SPEC.md 5.11).
import { readVarint, take } from "./bytes.mjs";
import { out, room } from "./core.mjs";
import { FormatError } from "./errors.mjs";
import { given, graphOf } from "./graph.mjs";
import { inverse, sorted } from "./integers.mjs";
import { lowestTriangles } from "./outlines.mjs";

const [ANCHOR, NEWEST, POLYGONS_FIRST] = [3, 4, 8];

/** Return the vertex and the polygon at each place, and the corner at which the latter begins. */
export function decodeOrder(core, payload, { faces, polygons, points }) {
  const [plan] = take(payload, 0, 1);
  if (plan >= 2 * POLYGONS_FIRST || (plan & ANCHOR) === ANCHOR) {
    throw new FormatError(`unknown order plan: ${plan}`, 0);
  }
  const [size, at] = readVarint(payload, 1);
  if (size > payload.length - at) {
    throw new FormatError("the vertex order is longer than its section", 1);
  }
  const rows = rowsOf(faces, polygons);
  const n = points.length;
  const [ofVertices, ofPolygons] = [payload.subarray(at, at + size), payload.subarray(at + size)];
  const readVertices = (named) => codeVertices(core, ofVertices, at, named, plan, n);
  const readPolygons = (rank) => codePolygons(core, ofPolygons, at + size, rows, plan, rank);
  if (plan & POLYGONS_FIRST) {
    const rank = new Int32Array(n).fill(-1);
    const found = readPolygons(rank);
    let next = rank.reduce((count, r) => count + Number(r >= 0), 0);
    const names = rank.map((r) => (r < 0 ? next++ : r));
    const corners = rows.corners.map((v) => names[v]);
    const vertices = readVertices({ ...rows, corners });
    const vertexOf = inverse(names);
    return { ...found, vertices: vertices.map((v) => vertexOf[v]) };
  }
  const vertices = readVertices(rows);
  return { ...readPolygons(inverse(vertices)), vertices };
}

/** Return polygons, each represented by one of its triangles. */
function rowsOf(faces, polygons) {
  const { corners, offsets, ofCorners } = polygons;
  const count = offsets.length - 1;
  const lowest = lowestTriangles(polygons);
  const [own, within] = [0, 0].map(() => new Int32Array(3 * count));
  lowest.forEach((f, p) => {
    for (let i = 0; i < 3; i++) {
      own[3 * p + i] = faces[3 * f + i];
      within[3 * p + i] = ofCorners[3 * f + i] - offsets[p];
    }
  });
  return { faces: own, corners: corners.map((c) => faces[c]), offsets, within };
}

function codeVertices(core, stream, at, { corners, offsets }, plan, n) {
  const following = new Int32Array(corners.length);
  for (let p = 0; p + 1 < offsets.length; p++) {
    for (let c = offsets[p]; c < offsets[p + 1]; c++) {
      following[c] = corners[c + 1 < offsets[p + 1] ? c + 1 : offsets[p]];
    }
  }
  const graph = graphOf(corners, following, n);
  const entries = graph.indices.length;
  // By columns, the entries of a symmetric matrix are those by rows, mirrored.
  const mirror = inverse(sorted(entries, [graph.indices, n]));
  const vertices = new Int32Array(n);
  const run = (coder) => {
    const rest = [mirror, plan & NEWEST ? 1 : 0, out(vertices), 0, n];
    const memory = [n + 1, n + 1, entries, entries, n, 3 * n].map(room);
    if (!core.good("dm_code_vertices", coder, ...given(graph), ...rest, ...memory)) {
      throw new FormatError("the vertex order is corrupt", at);
    }
  };
  core.decode(core.model("steps"), stream, run, at);
  return vertices;
}

function codePolygons(core, stream, at, { faces, corners, offsets, within }, plan, rank) {
  const [m, n] = [offsets.length - 1, rank.length];
  const [polygons, rotations] = [0, 0].map(() => new Int32Array(m));
  const ranked = rank.reduce((count, r) => count + Number(r >= 0), 0);
  const run = (coder) => {
    const rows = [faces, m, corners, corners.length, offsets, within, out(rank), n, ranked];
    const rest = [plan & ANCHOR, out(polygons), out(rotations), 0, m];
    const memory = [n, m + 1, m + 1, 3 * m, 3 * m, n].map(room);
    if (!core.good("dm_code_faces", coder, ...rows, ...rest, ...memory)) {
      throw new FormatError("the polygon order is corrupt", at);
    }
  };
  core.decode(core.model("steps"), stream, run, at);
  return { polygons, rotations };
}

/** Return the corners of polygons in another order, and where each polygon begins there. */
export function permutedCorners(offsets, { polygons, rotations }) {
  const ends = new Int32Array(polygons.length + 1);
  const corners = new Int32Array(offsets[offsets.length - 1]);
  polygons.forEach((p, i) => {
    const size = offsets[p + 1] - offsets[p];
    for (let k = 0; k < size; k++) corners[ends[i] + k] = offsets[p] + ((k + rotations[i]) % size);
    ends[i + 1] = ends[i] + size;
  });
  return [corners, ends];
}
