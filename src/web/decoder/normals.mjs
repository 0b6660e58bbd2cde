// Normals of a reconstructed surface at its vertices (SPEC.md 5.5).
import { out, real, room } from "./core.mjs";

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
export function vertexNormals(core, points, faces, steps) {
  const [normals, count] = [new Float64Array(points.length), steps.length];
  const surface = [points, count, faces, faces.length / 3];
  const fading = [steps, count, real(MOST_STEP), real(FADE)];
  core.call("dm_vertex_normals", ...surface, ...fading, out(normals), room(count));
  return normals;
}
