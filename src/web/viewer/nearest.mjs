// Nearest points on the surface of a mesh of another structure, by a grid of cells.
import { cross, dot, less, plus, unit } from "./matrices.mjs";
import { boxOf } from "./model.mjs";

/** Return about the nearest point of a surface for each of some positions, and its normal there. */
export function correspondenceOf(positions, mesh) {
  const grid = gridOf(mesh);
  const points = new Float64Array(positions.length);
  const normals = new Float64Array(positions.length);
  for (let v = 0; 3 * v < positions.length; v++) {
    const p = [0, 1, 2].map((a) => positions[3 * v + a]);
    const { point, normal } = grid.nearest(p);
    points.set(point, 3 * v);
    normals.set(normal, 3 * v);
  }
  return { points, normals };
}

/** Return a grid of the vertices of a mesh, and their triangles. */
function gridOf({ positions, triangles }) {
  const { middle, size } = boxOf(positions);
  const side = Math.max(1, Math.min(256, Math.ceil(Math.sqrt(positions.length / 12))));
  const low = middle.map((x) => x - size / 2);
  const cellOf = (p) =>
    p.map((x, a) => Math.min(side - 1, Math.max(0, Math.floor(((x - low[a]) / size) * side))));
  const cells = new Map();
  const key = ([x, y, z]) => (z * side + y) * side + x;
  const at = (v) => [0, 1, 2].map((a) => positions[3 * v + a]);
  const around = Array.from({ length: positions.length / 3 }, () => []);
  triangles.forEach((v, c) => around[v].push(Math.floor(c / 3)));
  around.forEach((own, v) => {
    if (!own.length) return;
    const k = key(cellOf(at(v)));
    if (!cells.has(k)) cells.set(k, []);
    cells.get(k).push(v);
  });
  const nearestVertex = (p) => {
    const cell = cellOf(p);
    let [best, least] = [-1, Infinity];
    for (let reach = 0; reach <= side; reach++) {
      // Whatever is outside of so many rings of cells is that far away.
      if (best >= 0 && ((reach - 1) * size) / side > Math.sqrt(least)) break;
      eachOfShell(cell, reach, side, (place) => {
        for (const v of cells.get(key(place)) ?? []) {
          const off = less(at(v), p);
          if (dot(off, off) < least) [best, least] = [v, dot(off, off)];
        }
      });
    }
    return best;
  };
  const nearest = (p) => {
    let found = { point: p, normal: [0, 0, 0], size: Infinity };
    const vertex = nearestVertex(p);
    for (const t of vertex < 0 ? [] : around[vertex]) {
      const [a, b, c] = [0, 1, 2].map((k) => at(triangles[3 * t + k]));
      const point = onTriangle(p, a, b, c);
      const off = less(point, p);
      if (dot(off, off) < found.size) {
        found = { point, normal: unit(cross(less(b, a), less(c, a))), size: dot(off, off) };
      }
    }
    return found;
  };
  return { nearest };
}

function eachOfShell([x, y, z], reach, side, visit) {
  for (let k = z - reach; k <= z + reach; k++) {
    for (let j = y - reach; j <= y + reach; j++) {
      const isFace = Math.abs(k - z) === reach || Math.abs(j - y) === reach;
      for (let i = x - reach; i <= x + reach; i += isFace || !reach ? 1 : 2 * reach) {
        if (Math.min(i, j, k) >= 0 && Math.max(i, j, k) < side) visit([i, j, k]);
      }
    }
  }
}

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
