// Nearest points on the surface of a mesh of another structure, by a tree of boxes.
import { dot, faceNormal, length, less, plus, row, unit } from "./matrices.mjs";

// Triangles of a leaf.
const LEAF = 8;

/** Return the nearest point of a surface for each of some positions, and its normal there. */
export function nearestPoints(positions, mesh) {
  const tree = treeOf(mesh);
  const points = new Float64Array(positions.length);
  const normals = new Float64Array(positions.length);
  for (let v = 0; 3 * v < positions.length; v++) {
    const { point, triangle } = nearest(tree, mesh, row(positions, v));
    points.set(point, 3 * v);
    if (triangle >= 0) normals.set(unit(faceNormal(mesh.positions, mesh.triangles, triangle)), 3 * v);
  }
  return { points, normals };
}

/** Return a tree over the triangles: their order, and boxes of halves of halves of it. */
function treeOf({ positions, triangles }) {
  const count = triangles.length / 3;
  const order = Int32Array.from({ length: count }, (_, t) => t);
  const middles = new Float32Array(3 * count);
  for (let t = 0; t < count; t++) {
    for (let c = 3 * t; c < 3 * t + 3; c++) {
      for (let a = 0; a < 3; a++) middles[3 * t + a] += positions[3 * triangles[c] + a];
    }
  }
  const boxes = [];
  const make = (begin, end) => {
    const at = boxes.length;
    const box = { low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity] };
    boxes.push(box);
    for (let i = begin; i < end; i++) {
      for (let c = 3 * order[i]; c < 3 * order[i] + 3; c++) {
        for (let a = 0; a < 3; a++) {
          const x = positions[3 * triangles[c] + a];
          if (x < box.low[a]) box.low[a] = x;
          if (x > box.high[a]) box.high[a] = x;
        }
      }
    }
    if (end - begin <= LEAF) return Object.assign(box, { begin, end });
    const sides = less(box.high, box.low);
    const axis = sides.indexOf(Math.max(...sides));
    const middle = parted(order, begin, end, (t) => middles[3 * t + axis]);
    box.halves = [make(begin, middle), make(middle, end)];
    return box;
  };
  return { root: make(0, count), order };
}

/** Part a range of an order at the mean of what is at its elements; return where, never at an end. */
function parted(order, begin, end, valueOf) {
  let sum = 0;
  for (let i = begin; i < end; i++) sum += valueOf(order[i]);
  const mean = sum / (end - begin);
  let at = begin;
  for (let i = begin; i < end; i++) {
    if (valueOf(order[i]) >= mean) continue;
    [order[i], order[at]] = [order[at], order[i]];
    at++;
  }
  return at > begin && at < end ? at : (begin + end) >> 1;
}

function nearest({ root, order }, { positions, triangles }, p) {
  let found = { point: p, triangle: -1, size: Infinity };
  const waiting = [[root, 0]];
  while (waiting.length) {
    const [box, least] = waiting.pop();
    if (least >= found.size) continue;
    if (box.halves) {
      // The nearer half is looked at first.
      waiting.push(...box.halves.map((half) => [half, farFrom(half, p)]).sort((a, b) => b[1] - a[1]));
      continue;
    }
    for (let i = box.begin; i < box.end; i++) {
      const [a, b, c] = [0, 1, 2].map((k) => row(positions, triangles[3 * order[i] + k]));
      const point = onTriangle(p, a, b, c);
      const size = length(less(point, p));
      if (size < found.size) found = { point, triangle: order[i], size };
    }
  }
  return found;
}

const farFrom = ({ low, high }, p) => length(p.map((x, a) => Math.max(low[a] - x, 0, x - high[a])));

/** Return the point of a triangle that is nearest to p. */
function onTriangle(p, a, b, c) {
  const [ab, ac, ap] = [less(b, a), less(c, a), less(p, a)];
  const [aa, bb, mixed] = [dot(ab, ab), dot(ac, ac), dot(ab, ac)];
  const [u, v] = [dot(ab, ap), dot(ac, ap)];
  const area = aa * bb - mixed * mixed;
  const s = area > 0 ? (bb * u - mixed * v) / area : -1;
  const t = area > 0 ? (aa * v - mixed * u) / area : -1;
  if (s >= 0 && t >= 0 && s + t <= 1) return plus(plus(a, ab, s), ac, t);
  const sides = [
    [a, b],
    [b, c],
    [c, a],
  ].map(([from, to]) => onSegment(p, from, to));
  const far = sides.map((point) => dot(less(point, p), less(point, p)));
  return sides[far.indexOf(Math.min(...far))];
}

function onSegment(p, a, b) {
  const side = less(b, a);
  const share = dot(side, side) > 0 ? dot(less(p, a), side) / dot(side, side) : 0;
  return plus(a, side, Math.min(1, Math.max(0, share)));
}
