// Errors of a mesh against its original, at the corners of its triangles.
import { correspondenceOf } from "./nearest.mjs";
import { cross, dot, less, length } from "./matrices.mjs";

/** Names of the errors, by their keys; `signed` ones lie around zero. */
export const FIELDS = {
  distance: { title: "distance", unit: "of the diagonal" },
  signed: { title: "signed distance", unit: "of the diagonal", signed: true },
  normals: { title: "face normals", unit: "degrees" },
  dihedral: { title: "dihedral angles", unit: "degrees" },
};

const DEGREES = 180 / Math.PI;

/**
 * Return the errors of a mesh, one number for each corner of its triangles.
 *
 * Distances are those of vertices, over the diagonal of the original: to the same vertices where
 * both have the same triangles, else to the surface of the original.
 */
export function fieldOf(kind, mesh, original, diagonal) {
  if (kind === "normals" || kind === "dihedral") {
    if (!isAlike(mesh, original)) return null;
    return kind === "normals" ? normalField(mesh, original) : dihedralField(mesh, original);
  }
  const there = isAlike(mesh, original)
    ? { points: original.positions, normals: vertexNormals(original) }
    : correspondenceOf(mesh.positions, original);
  const count = mesh.positions.length / 3;
  const atVertices = new Float32Array(count);
  for (let v = 0; v < count; v++) {
    const off = less(row(mesh.positions, v), row(there.points, v));
    const signed = dot(off, row(there.normals, v));
    atVertices[v] = (kind === "signed" ? signed : length(off)) / diagonal;
  }
  return Float32Array.from(mesh.triangles, (v) => atVertices[v]);
}

/** Return whether two meshes have the same triangles. */
function isAlike(mesh, other) {
  const [a, b] = [mesh.triangles, other.triangles];
  if (mesh.positions.length !== other.positions.length || a.length !== b.length) return false;
  return a.every((v, i) => v === b[i]);
}

const row = (numbers, v) => [numbers[3 * v], numbers[3 * v + 1], numbers[3 * v + 2]];

function faceNormal({ positions, triangles }, t) {
  const [p, q, r] = [0, 1, 2].map((k) => row(positions, triangles[3 * t + k]));
  return cross(less(q, p), less(r, p));
}

/** Return the normals of the vertices, of length 1 or 0, three numbers each. */
export function vertexNormals(mesh) {
  const sums = new Float64Array(mesh.positions.length);
  for (let t = 0; 3 * t < mesh.triangles.length; t++) {
    const n = faceNormal(mesh, t);
    for (let k = 0; k < 3; k++) {
      for (let a = 0; a < 3; a++) sums[3 * mesh.triangles[3 * t + k] + a] += n[a];
    }
  }
  for (let v = 0; 3 * v < sums.length; v++) {
    const size = length(row(sums, v)) || 1;
    for (let a = 0; a < 3; a++) sums[3 * v + a] /= size;
  }
  return sums;
}

const angleBetween = (a, b) => Math.atan2(length(cross(a, b)), dot(a, b)) * DEGREES;

function normalField(mesh, original) {
  const field = new Float32Array(mesh.triangles.length);
  for (let t = 0; 3 * t < field.length; t++) {
    field.fill(angleBetween(faceNormal(mesh, t), faceNormal(original, t)), 3 * t, 3 * t + 3);
  }
  return field;
}

/** Return the mean change of the dihedral angles at each triangle's three edges. */
function dihedralField(mesh, original) {
  const { triangles } = mesh;
  const field = new Float32Array(triangles.length);
  const first = new Map();
  const count = mesh.positions.length / 3;
  const sums = new Float32Array(triangles.length / 3);
  const edges = new Uint8Array(sums.length);
  for (let h = 0; h < triangles.length; h++) {
    const [a, b] = [triangles[h], triangles[h % 3 === 2 ? h - 2 : h + 1]];
    const key = Math.min(a, b) * count + Math.max(a, b);
    const t = Math.floor(h / 3);
    if (!first.has(key)) {
      first.set(key, t);
      continue;
    }
    const other = first.get(key);
    const change = Math.abs(dihedral(mesh, t, other) - dihedral(original, t, other));
    for (const one of [t, other]) {
      sums[one] += change;
      edges[one]++;
    }
  }
  for (let t = 0; t < sums.length; t++) field.fill(sums[t] / (edges[t] || 1), 3 * t, 3 * t + 3);
  return field;
}

const dihedral = (mesh, t, other) => angleBetween(faceNormal(mesh, t), faceNormal(mesh, other));

/** Return a number at a rank of the sizes of a field, 0 to 1. */
export function quantile(field, rank) {
  const sample = [];
  const step = Math.max(1, Math.floor(field.length / 20000));
  for (let i = 0; i < field.length; i += step) sample.push(Math.abs(field[i]));
  sample.sort((a, b) => a - b);
  return sample[Math.min(sample.length - 1, Math.floor(rank * sample.length))] ?? 0;
}
