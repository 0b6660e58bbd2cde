// Errors of a mesh against its original, at the corners of its triangles: the measures of `compare`.
import { changesOfDihedrals, interiorEdges } from "./dihedrals.mjs";
import { angleBetween, dot, faceNormal, length, less, row } from "./matrices.mjs";
import { nearestPoints } from "./nearest.mjs";

/** Names of the errors, by their keys; `signed` ones lie around zero. */
export const FIELDS = {
  distance: { title: "distance", unit: "of the diagonal" },
  signed: { title: "signed distance", unit: "of the diagonal", signed: true },
  normals: { title: "face normals", unit: "degrees" },
  dihedral: { title: "dihedral angles", unit: "degrees" },
};

/**
 * Return the errors of a mesh, one number for each corner of its triangles; null where there are
 * none, as of angles where the triangles of both differ.
 *
 * Distances are those of vertices, over the diagonal of the original: to the same vertices where
 * both have the same triangles, else to the surface of the original. Signed ones are along its
 * normals.
 */
export function fieldOf(kind, mesh, original, diagonal) {
  const alike = isAlike(mesh, original);
  if (kind === "normals") return alike ? normalField(mesh, original) : null;
  if (kind === "dihedral") return alike ? dihedralField(mesh, original) : null;
  const there = alike
    ? { points: original.positions, normals: vertexNormals(original) }
    : nearestPoints(mesh.positions, original);
  const atVertices = new Float32Array(mesh.positions.length / 3);
  for (let v = 0; v < atVertices.length; v++) {
    const off = less(row(mesh.positions, v), row(there.points, v));
    const size = kind === "signed" ? dot(off, row(there.normals, v)) : length(off);
    atVertices[v] = size / diagonal;
  }
  return Float32Array.from(mesh.triangles, (v) => atVertices[v]);
}

/** Let a mesh be cut into the triangles of another of the same polygons. */
export function cutLike(mesh, other) {
  if (!isSame(mesh.corners, other.corners) || !isSame(mesh.offsets, other.offsets)) return;
  const { triangles, triangleCorners, trianglePolygons } = other;
  Object.assign(mesh, { triangles, triangleCorners, trianglePolygons });
}

const isSame = (a, b) => a === b || (a.length === b.length && a.every((x, i) => x === b[i]));

/** Return whether two meshes have the same triangles. */
function isAlike(mesh, other) {
  return mesh.positions.length === other.positions.length && isSame(mesh.triangles, other.triangles);
}

/** Return the normals of the vertices, of length 1 or 0, three numbers each. */
export function vertexNormals(mesh) {
  const sums = new Float64Array(mesh.positions.length);
  for (let t = 0; 3 * t < mesh.triangles.length; t++) {
    const n = faceNormal(mesh.positions, mesh.triangles, t);
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

/** Return the angle by which each triangle has turned, 90 where it has become a line or a point. */
function normalField(mesh, original) {
  const field = new Float32Array(mesh.triangles.length);
  for (let t = 0; 3 * t < field.length; t++) {
    const own = faceNormal(mesh.positions, mesh.triangles, t);
    const before = faceNormal(original.positions, mesh.triangles, t);
    field.fill(own.some(Boolean) ? angleBetween(own, before) : 90, 3 * t, 3 * t + 3);
  }
  return field;
}

/** Return the mean change of the dihedral angles at the interior edges of each triangle. */
function dihedralField(mesh, original) {
  const edges = interiorEdges(original);
  const changes = changesOfDihedrals(edges, mesh, original);
  const field = new Float32Array(mesh.triangles.length);
  const sums = new Float64Array(field.length / 3);
  const counts = new Uint8Array(sums.length);
  for (let e = 0; e < changes.length; e++) {
    for (const t of [edges[4 * e + 2], edges[4 * e + 3]].map((h) => Math.floor(h / 3))) {
      sums[t] += changes[e];
      counts[t]++;
    }
  }
  for (let t = 0; t < sums.length; t++) field.fill(sums[t] / (counts[t] || 1), 3 * t, 3 * t + 3);
  return field;
}

/** Return a number at a rank of the sizes of a field, 0 to 1. */
export function quantile(field, rank) {
  const sample = [];
  const step = Math.max(1, Math.floor(field.length / 20000));
  for (let i = 0; i < field.length; i += step) sample.push(Math.abs(field[i]));
  sample.sort((a, b) => a - b);
  return sample[Math.min(sample.length - 1, Math.floor(rank * sample.length))] ?? 0;
}
