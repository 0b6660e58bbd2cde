// Section POLY: the triangles that are merged into polygons.
import { readVarint } from "./bytes.mjs";
import { out, room } from "./core.mjs";
import { FormatError } from "./errors.mjs";
import { endsOf } from "./graph.mjs";
import { counted, largest, sorted } from "./integers.mjs";
import { structureOf } from "./structure.mjs";

/** Return the structure with its polygons. */
export function decodePolygons(core, payload, { complex, faces, points, candidates }) {
  const merged = decode(core, payload, faces, candidates);
  return structureOf(core, complex, faces, points, merged);
}

/** Return the half-edge that each half-edge is merged with, -1 for none. */
function decode(core, payload, faces, candidates) {
  const numbers = [];
  let position = 0;
  for (let i = 0; i < 4; i++) [numbers[i], position] = readVarint(payload, position);
  const [count, least, most, total] = numbers;
  const m = faces.length / 3;
  const bounded = 3 <= least && least <= most && most <= m + 2;
  if (!(0 < count && count < m) || !bounded || total > m - count) {
    throw new FormatError("the counts of the polygons contradict those of the header", 0);
  }
  const merged = new Int32Array(3 * m).fill(-1);
  const parent = counted(m);
  const size = new Int32Array(m).fill(3);
  const forest = [out(merged), out(parent), out(size)];
  const run = (coder) => {
    const vertices = largest(faces) + 1;
    const rest = [least, most, total > 0 ? 1 : 0, room(3 * m), room(m), room(3 * vertices)];
    const corners = [faces, m, vertices, candidates];
    core.call("dm_code_hidden", coder, ...corners, ...forest, ...rest);
    if (total && !codeExplicit(core, coder, faces, candidates, forest, most, total)) {
      const reason = "explicit pairs: a half-edge that cannot be merged, or too few";
      throw new FormatError(reason, position);
    }
  };
  core.decode(core.model("hidden_edges"), payload.subarray(position), run, position);
  const sizes = size.filter((_, f) => parent[f] === f);
  const found = [sizes.length, sizes.reduce((a, b) => Math.min(a, b)), largest(sizes)];
  if (found[0] !== count || found[1] !== least || found[2] !== most) {
    const reason = "the polygons have other numbers of corners than announced";
    throw new FormatError(reason, position);
  }
  return merged;
}

/** Read the pairs of half-edges that are no candidates; return whether so many were found. */
function codeExplicit(core, coder, faces, candidates, forest, most, total) {
  const h = faces.length;
  const { order, group, across, bounds } = groupsOf(faces);
  const groups = [order, group, across, bounds, across.length];
  const pairs = [candidates, h / 3, new Int32Array(0), ...forest, most, total];
  const memory = [across.length, h, h].map(room);
  return core.good("dm_code_explicit_pairs", coder, ...pairs, ...groups, ...memory);
}

/** Return half-edges grouped by their two ends, and the group that runs back of each, -1: none. */
function groupsOf(faces) {
  const h = faces.length;
  const n = largest(faces) + 1;
  const ends = endsOf(faces);
  const order = sorted(h, [faces, n], [ends, n]);
  const group = new Int32Array(h);
  const bounds = [];
  const number = new Map();
  const key = (a, b) => a * n + b;
  order.forEach((edge, i) => {
    const own = key(faces[edge], ends[edge]);
    if (!number.has(own)) {
      number.set(own, bounds.length);
      bounds.push(i);
    }
    group[edge] = bounds.length - 1;
  });
  const across = Int32Array.from(bounds, (i) => {
    return number.get(key(ends[order[i]], faces[order[i]])) ?? -1;
  });
  return { order, group, across, bounds: Int32Array.from([...bounds, h]) };
}
