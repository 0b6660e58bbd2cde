// Triangles of polygons, for drawing.

/** Return polygons as fans of triangles: their vertices, corners, and the polygon of each. */
export function fansOf(corners, offsets) {
  const count = corners.length - 2 * (offsets.length - 1);
  const triangles = new Int32Array(3 * count);
  const triangleCorners = new Int32Array(3 * count);
  const trianglePolygons = new Int32Array(count);
  let t = 0;
  for (let p = 0; p + 1 < offsets.length; p++) {
    const first = offsets[p];
    for (let c = first + 1; c + 1 < offsets[p + 1]; c++, t++) {
      triangleCorners.set([first, c, c + 1], 3 * t);
      triangles.set([corners[first], corners[c], corners[c + 1]], 3 * t);
      trianglePolygons[t] = p;
    }
  }
  return { triangles, triangleCorners, trianglePolygons };
}
