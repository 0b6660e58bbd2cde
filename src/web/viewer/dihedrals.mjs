// Dihedral angles at the edges of triangles, and what becomes of them.
import { angleBetween, cross, dot, faceNormal, less, row } from "./matrices.mjs";

/**
 * Return the edges of exactly two triangles, as `deltamesh compare` has them: for each edge its ends
 * and its half-edges, four numbers.
 *
 * Vertices at one position are one, or surfaces would end where they are cut for an attribute.
 */
export function interiorEdges({ positions, triangles }) {
  const site = sitesOf(positions);
  const endOf = (h) => triangles[h % 3 === 2 ? h - 2 : h + 1];
  const ends = (h) => [site[triangles[h]], site[endOf(h)]];
  const same = (h, g) => {
    const [[a, b], [c, d]] = [ends(h), ends(g)];
    return (a === c && b === d) || (a === d && b === c);
  };
  // Of each edge its first half-edge, the second, and how many there are.
  const first = firstOf(triangles.length, (h) => edgeHash(...ends(h)), same);
  const second = new Int32Array(triangles.length);
  const counts = new Int32Array(triangles.length);
  for (let h = 0; h < triangles.length; h++) {
    if (++counts[first[h]] === 2) second[first[h]] = h;
  }
  const edges = [];
  for (let h = 0; h < triangles.length; h++) {
    const [a, b] = ends(h);
    if (counts[h] !== 2 || a === b || Math.floor(h / 3) === Math.floor(second[h] / 3)) continue;
    edges.push(triangles[h], endOf(h), h, second[h]);
  }
  return edges;
}

const MIX = 0x9e3779b1;
const edgeHash = (a, b) => Math.imul(Math.min(a, b) ^ Math.imul(Math.max(a, b), MIX), MIX);

/** Return for each vertex the first at its position. */
function sitesOf(positions) {
  const words = new Uint32Array(Float64Array.from(positions, (x) => x + 0).buffer);
  const hash = (v) => {
    let mixed = 0;
    for (let i = 6 * v; i < 6 * v + 6; i++) mixed = Math.imul(mixed ^ (mixed >>> 15) ^ words[i], MIX);
    return mixed;
  };
  const isAt = (v, w) => [0, 1, 2].every((a) => positions[3 * v + a] === positions[3 * w + a]);
  return firstOf(positions.length / 3, hash, isAt);
}

/** Return for each element the first that is the same. */
function firstOf(count, hashOf, isSame) {
  const mask = 2 ** Math.ceil(Math.log2(2 * count + 1)) - 1;
  const table = new Int32Array(mask + 1).fill(-1);
  const first = new Int32Array(count);
  for (let i = 0; i < count; i++) {
    const hash = hashOf(i);
    let place = (hash ^ (hash >>> 15)) & mask;
    while (table[place] >= 0 && !isSame(table[place], i)) place = (place + 1) & mask;
    if (table[place] < 0) table[place] = i;
    first[i] = table[place];
  }
  return first;
}

/** Return the sizes of the changes of the dihedral angles at edges, in degrees, at most 180. */
export function changesOfDihedrals(edges, mesh, original) {
  const changes = new Float64Array(edges.length / 4);
  for (let e = 0; e < changes.length; e++) {
    const change = Math.abs(dihedral(mesh, 4 * e) - dihedral(original, 4 * e));
    changes[e] = Math.min(change, 360 - change);
  }
  return changes;

  // From the normal of one triangle to that of the other, positive where the surface is convex.
  function dihedral({ positions }, at) {
    const { triangles } = original;
    const [a, b, h, other] = [edges[at], edges[at + 1], edges[at + 2], edges[at + 3]];
    const normal = faceNormal(positions, triangles, Math.floor(h / 3));
    let beside = faceNormal(positions, triangles, Math.floor(other / 3));
    // Both triangles run through the edge in one direction where one of them is turned over.
    const isSame = isAt(triangles[other], a);
    if (isSame) beside = beside.map((x) => -x);
    const axis = cross(normal, beside);
    const angle = angleBetween(normal, beside);
    return dot(axis, less(row(positions, b), row(positions, a))) < 0 ? -angle : angle;
  }

  function isAt(v, w) {
    return [0, 1, 2].every((i) => original.positions[3 * v + i] === original.positions[3 * w + i]);
  }
}
