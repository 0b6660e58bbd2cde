// Section ANCH: the anchors, their grid points, and those of the isolated vertices.
import { out, room } from "./core.mjs";
import { FormatError } from "./errors.mjs";
import { given, lowestOf } from "./graph.mjs";
import { counted, largest } from "./integers.mjs";
import { extraBits, readGridBits } from "./steps.mjs";

const MASK = (1n << 64n) - 1n;

/** Return the anchors, their grid points, and those of the isolated vertices. */
export function decodeAnchors(core, payload, parameters, surface, exponents) {
  const bits = readGridBits(payload);
  const { anchorCount: k, anchorMethod } = parameters;
  const { count: n, graph, labels, isolated: i } = surface;
  const positions = new BigInt64Array(3 * k);
  const isolated = new Int32Array(3 * i);
  let anchors = new Int32Array(k);
  const run = (coder) => {
    if (anchorMethod === "greedy") {
      if (!core.good("dm_code_gaps", coder, out(anchors), k, n)) {
        throw new FormatError("an anchor beyond the last vertex", 3);
      }
    } else if (anchorMethod === "random") {
      anchors = randomAnchors(labels, k, parameters.seed);
    } else {
      anchors = farthestAnchors(core, graph, labels, k);
    }
    const anchored = new Set(anchors.map((v) => labels[v]));
    if (anchored.size <= largest(labels) || anchors.length !== k) {
      throw new FormatError("a component without an anchor", 3);
    }
    const extra = anchors.map((v) => extraBits(exponents[v] ?? 0));
    core.call("dm_code_points", coder, out(positions), k, bits, extra);
    if (i && !core.good("dm_code_sorted_points", coder, out(isolated), i, bits)) {
      throw new FormatError("an isolated vertex outside the grid", 3);
    }
  };
  core.decode(core.model("points"), payload.subarray(3), run, 3);
  return { anchors, positions, isolated };
}

const clipped = (k, labels) => Math.min(Math.max(k, largest(labels) + 1), labels.length);

/** Return so many vertices that are far apart, the lowest of each component first. */
export function farthestAnchors(core, graph, labels, k) {
  const first = lowestOf(labels);
  const anchors = new Int32Array(clipped(k, labels));
  const rest = [first, first.length, out(anchors), anchors.length];
  const memory = [room(graph.count), room(graph.count)];
  core.call("dm_farthest_points", ...given(graph), ...rest, ...memory);
  return anchors;
}

/** Return random anchors, by the keys of SplitMix64, the lowest of each component first. */
function randomAnchors(labels, k, seed) {
  const keys = BigUint64Array.from(labels, (_, i) => {
    let z = (seed + BigInt(i + 1) * 0x9e3779b97f4a7c15n) & MASK;
    z = ((z ^ (z >> 30n)) * 0xbf58476d1ce4e5b9n) & MASK;
    z = ((z ^ (z >> 27n)) * 0x94d049bb133111ebn) & MASK;
    return z ^ (z >> 31n);
  });
  const order = [...counted(labels.length)].sort((a, b) => {
    return keys[a] < keys[b] ? -1 : keys[a] > keys[b] ? 1 : a - b;
  });
  const first = new Map();
  for (const v of order) if (!first.has(labels[v])) first.set(labels[v], v);
  const taken = new Set(first.values());
  const roots = [...first.keys()].sort((a, b) => a - b).map((label) => first.get(label));
  const rest = order.filter((v) => !taken.has(v));
  return Int32Array.from([...roots, ...rest].slice(0, clipped(k, labels)));
}
