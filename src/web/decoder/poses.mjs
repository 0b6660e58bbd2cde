// Poses: motions of the anchors of a file, and the positions that they make (SPEC.md 5.21).
import { readFields, take } from "./bytes.mjs";
import { cellsOf } from "./cells.mjs";
import { out, real, room } from "./core.mjs";
import { FormatError, spelled } from "./errors.mjs";
import { given, graphOf } from "./graph.mjs";
import { inverse } from "./integers.mjs";
import { decodeVectors } from "./labels.mjs";
import { MOST_OCTAVES, POSE_FIELDS, POSITION_LARGEST } from "./layout.mjs";
import { leastSquaresOf } from "./least_squares.mjs";
import { UNPRINTABLE } from "./parameters.mjs";

// Weight of the anchors against the turned deltas.
const WEIGHT = 10;
// The square of a quaternion's length that stands for no rotation.
const NO_LENGTH = 2 ** -40;

/** Return the poses of a file: `name`, `step`, `octaves`, `stream`, its `offset`, and `size`. */
export function posesOf({ sections }) {
  return sections.get("POSE")?.read(readPoses) ?? [];
}

function readPoses(payload) {
  const found = new Map();
  let at = 0;
  while (at < payload.length || !found.size) {
    const [{ name, step, octaves, size }, offsets, offset] = readFields(payload, at, POSE_FIELDS);
    for (const [field, reason] of faultsOf(name, step, octaves)) {
      throw new FormatError(reason, offsets[field]);
    }
    if (found.has(name)) throw new FormatError(`pose '${name}' comes a second time`, at);
    const stream = take(payload, offset, size);
    const end = offset + size;
    found.set(name, { name, step, octaves, stream, offset, size: end - at });
    at = end;
  }
  return [...found.values()];
}

function* faultsOf(name, step, octaves) {
  if (!name) yield ["name", "an empty name of a pose"];
  if (UNPRINTABLE.test(name)) yield ["name", "a name with control characters"];
  if (!(Number.isFinite(step) && step > 0)) yield ["step", `a step of ${spelled(step)}`];
  if (octaves > MOST_OCTAVES) yield ["octaves", `a unit of 2^-${octaves}`];
}

/** Return the poses in a payload, with their `numbers`, six for each anchor. */
export function decodePoses(core, payload, surface, anchors) {
  const tree = treeOf(core, surface, anchors);
  return readPoses(payload).map((pose) => {
    const { name, step, stream, offset } = pose;
    const rows = decodeVectors(core, stream, tree.motions, offset);
    const numbers = new Int32Array(6 * anchors.length);
    let total = 0;
    tree.order.forEach((anchor, i) => {
      for (let a = 0; a < 3; a++) {
        numbers[6 * anchor + a] = rows[3 * i + a];
        numbers[6 * anchor + 3 + a] = rows[3 * (anchors.length + i) + a];
        total += Math.abs(rows[3 * i + a]);
      }
    });
    if (!(total * step <= 100 * POSITION_LARGEST)) {
      throw new FormatError(`pose '${name}': displacements that are too large`, offset);
    }
    return { ...pose, numbers };
  });
}

/** Return the anchors in the order in which they are coded, their parents, and what predicts them. */
function treeOf(core, { graph, labels }, anchors) {
  const k = anchors.length;
  const { of } = cellsOf(core, graph, labels, anchors);
  const lengths = new Map();
  for (let v = 0; v < graph.count; v++) {
    for (let e = graph.indptr[v]; e < graph.indptr[v + 1]; e++) {
      const [low, high] = [of[v], of[graph.indices[e]]];
      if (low < high) lengths.set(low * k + high, (lengths.get(low * k + high) ?? 0) + 1);
    }
  }
  const pairs = [...lengths].sort(([a, m], [b, n]) => n - m || a - b);
  const low = Int32Array.from(pairs, ([pair]) => Math.floor(pair / k));
  const high = Int32Array.from(pairs, ([pair]) => pair % k);
  const kept = new Uint8Array(pairs.length);
  core.call("dm_span", low, high, kept.length, k, out(kept), room(k));
  const isKept = (_, i) => kept[i];
  const forest = graphOf(low.filter(isKept), high.filter(isKept), k);
  const [order, parent] = [new Int32Array(k), new Int32Array(k)];
  core.call("dm_walk_forest", ...given(forest), out(order), out(parent));
  const rank = inverse(order);
  const [a, b] = [low, high].map((ends) => ends.map((anchor) => rank[anchor]));
  const own = Int32Array.from({ length: k }, (_, i) => i);
  const joined = (x, y) => Int32Array.from([...x, ...x.map((i) => i + k), ...y]);
  const motions = graphOf(joined(a, own), joined(b, own.map((i) => i + k)), 2 * k);
  return { order, parent, motions };
}

/**
 * Return the `positions` of points in a pose, three numbers each, and `turns`, matrices of nine.
 *
 * Points that are in no face come last, and stay.
 */
export function posed(core, surface, anchors, pose, points) {
  const { graph, labels, count: n } = surface;
  const { order, parent } = treeOf(core, surface, anchors);
  const rest = new Float64Array(3 * anchors.length);
  anchors.forEach((v, i) => rest.set(points.subarray(3 * v, 3 * v + 3), 3 * i));
  const held = new Float64Array(rest.length);
  const quaternions = new Float64Array(4 * anchors.length);
  const units = [real(pose.step), real(2 ** -pose.octaves), 0];
  const moved = [out(pose.numbers.slice()), out(held), out(quaternions)];
  core.call("dm_carry_motions", order, parent, anchors.length, rest, ...units, ...moved);
  const solver = leastSquaresOf(core, graph, labels, anchors, WEIGHT);
  const turns = new Float64Array(3 * points.length);
  const positions = points.slice();
  try {
    const none = new Float64Array(3 * n);
    // The solver has three columns.
    const [first, last] = [[0, 1, 2], [3, 3, 3]].map((columns) => {
      const taken = Array.from(anchors, (_, i) => columns.map((c) => quaternions[4 * i + c]));
      return solver.solve(none, Float64Array.from(taken.flat()));
    });
    for (let v = 0; v < points.length / 3; v++) {
      const quaternion = v < n ? [...first.subarray(3 * v, 3 * v + 3), last[3 * v]] : [1, 0, 0, 0];
      turns.set(matrixOf(...quaternion), 9 * v);
    }
    const deltas = new Float64Array(3 * n);
    const surfaces = [points.subarray(0, 3 * n), turns.subarray(0, 9 * n)];
    core.call("dm_turned_deltas", ...given(graph), ...surfaces, out(deltas));
    positions.set(solver.solve(deltas, held));
  } finally {
    solver.free();
  }
  return { positions, turns };
}

function matrixOf(w, x, y, z) {
  const length = w * w + x * x + y * y + z * z + NO_LENGTH;
  return [
    w * w + x * x - y * y - z * z + NO_LENGTH,
    2 * (x * y - w * z),
    2 * (x * z + w * y),
    2 * (x * y + w * z),
    w * w - x * x + y * y - z * z + NO_LENGTH,
    2 * (y * z - w * x),
    2 * (x * z - w * y),
    2 * (y * z + w * x),
    w * w - x * x - y * y + z * z + NO_LENGTH,
  ].map((number) => number / length);
}

/** Turn the unit normals among attributes as their vertices do, in place; lengths stay. */
export function turnNormals(mesh, turns) {
  for (const attribute of mesh.attributes) {
    const { role, width, domain, values } = attribute;
    if (role !== "normal" || width !== 3 || !/^float/.test(attribute.type)) continue;
    attribute.values = values.slice();
    for (let i = 0; 3 * i < values.length; i++) {
      const old = values.subarray(3 * i, 3 * i + 3);
      const turn = meanTurn(mesh, turns, domain, i);
      const made = [0, 3, 6].map((r) => turn[r] * old[0] + turn[r + 1] * old[1] + turn[r + 2] * old[2]);
      const [length, was] = [Math.hypot(...made), Math.hypot(...old)];
      if (length > 0) attribute.values.set(made.map((x) => (x * was) / length), 3 * i);
    }
  }
}

/** Return the matrix by which an element turns: the mean of those of its vertices. */
function meanTurn({ corners, offsets }, turns, domain, i) {
  const vertices = {
    vertex: () => [i],
    corner: () => [corners[i]],
    face: () => corners.subarray(offsets[i], offsets[i + 1]),
  }[domain]();
  const sums = new Float64Array(9);
  for (const v of vertices) for (let k = 0; k < 9; k++) sums[k] += turns[9 * v + k];
  return sums.map((sum) => sum / vertices.length);
}
