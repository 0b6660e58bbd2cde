// Polygons of a mesh, as rows of corners of its triangles.
//
// `corners` has a corner of a triangle, 3 f + i, for each corner of a polygon; `offsets` where each
// polygon begins there; `ofCorners` the corner of a polygon at which each triangle's corner is.
import { out } from "./core.mjs";
import { counted } from "./integers.mjs";

/** Return the polygons of a file of triangles. */
export function plainPolygons(count) {
  const every = counted(3 * count);
  return { corners: every, offsets: counted(count + 1).map((p) => 3 * p), ofCorners: every };
}

/** Return the polygons of triangles that are merged across half-edges. */
export function mergedPolygons(core, merged) {
  const hidden = merged.reduce((count, h) => count + Number(h >= 0), 0);
  const faces = merged.length / 3;
  if (!hidden) return plainPolygons(faces);
  const count = faces - hidden / 2;
  const corners = new Int32Array(merged.length - hidden);
  const offsets = new Int32Array(count + 1);
  const ofCorners = new Int32Array(merged.length);
  const rows = [out(corners), corners.length, out(offsets), count, out(ofCorners)];
  core.call("dm_walk_outlines", merged, faces, ...rows);
  return { corners, offsets, ofCorners };
}

/** Return the polygon of each corner of polygons. */
export function polygonOfCorners(offsets) {
  const polygon = new Int32Array(offsets[offsets.length - 1]);
  for (let p = 0; p + 1 < offsets.length; p++) polygon.fill(p, offsets[p], offsets[p + 1]);
  return polygon;
}

/** Return the lowest triangle of each polygon. */
export function lowestTriangles({ offsets, ofCorners }) {
  const polygon = polygonOfCorners(offsets);
  const lowest = new Int32Array(offsets.length - 1).fill(-1);
  for (let f = 0; 3 * f < ofCorners.length; f++) {
    const p = polygon[ofCorners[3 * f]];
    if (lowest[p] < 0) lowest[p] = f;
  }
  return lowest;
}
