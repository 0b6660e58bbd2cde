// Normals of a reconstructed surface at its vertices (SPEC.md 5.5).

const FADE = 1e-3;
const MOST_STEP = 1e150;

/** Return the longest side of the bounding box of points. */
export function extentOf(points) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; i++) {
    const a = i % 3;
    if (points[i] < low[a]) low[a] = points[i];
    if (points[i] > high[a]) high[a] = points[i];
  }
  return points.length ? Math.max(...high.map((x, a) => x - low[a])) : 0;
}

/**
 * Return the sums of the area-weighted normals of the triangles around each vertex, normalized.
 *
 * They fade to zero where the triangles all but cancel, or are small beside the steps.
 */
export function vertexNormals(points, faces, steps) {
  const extent = extentOf(points) || 1;
  const sums = new Float64Array(points.length);
  const areas = new Float64Array(points.length / 3);
  const at = (v, a) => (points[3 * v + a] - points[a]) / extent;
  for (let f = 0; f < faces.length; f += 3) {
    const [i, j, k] = [faces[f], faces[f + 1], faces[f + 2]];
    const [ux, uy, uz] = [at(j, 0) - at(i, 0), at(j, 1) - at(i, 1), at(j, 2) - at(i, 2)];
    const [vx, vy, vz] = [at(k, 0) - at(i, 0), at(k, 1) - at(i, 1), at(k, 2) - at(i, 2)];
    const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    const area = Math.sqrt(x * x + y * y + z * z);
    for (const v of [i, j, k]) {
      sums[3 * v] += x;
      sums[3 * v + 1] += y;
      sums[3 * v + 2] += z;
      areas[v] += area;
    }
  }
  for (let v = 0; v < areas.length; v++) {
    const [x, y, z] = sums.subarray(3 * v, 3 * v + 3);
    const step = Math.min(steps[v] / extent, MOST_STEP);
    const length = Math.sqrt(x * x + y * y + z * z) + FADE * (areas[v] + step * step);
    for (let a = 0; a < 3; a++) sums[3 * v + a] /= length;
  }
  return sums;
}
