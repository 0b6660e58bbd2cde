// What is drawn of a mesh: numbers for each corner of its triangles.

// Cosine of the angle above which two triangles do not belong to one smooth surface.
const CREASE = 0.6;
const MOST_AROUND = 64;

/** Return the box of positions: its middle, and its longest side. */
export function boxOf(positions) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i++) {
    const a = i % 3;
    if (positions[i] < low[a]) low[a] = positions[i];
    if (positions[i] > high[a]) high[a] = positions[i];
  }
  const sides = high.map((x, a) => x - low[a]);
  return {
    middle: low.map((x, a) => x + sides[a] / 2),
    size: Math.max(...sides) || 1,
    diagonal: Math.hypot(...sides),
  };
}

/** Return the corners of a mesh in the frame of a box, ready for a graphics card. */
export function modelOf(mesh, box) {
  const { triangles, positions } = mesh;
  const corners = new Float32Array(3 * triangles.length);
  for (let c = 0; c < triangles.length; c++) {
    for (let a = 0; a < 3; a++) {
      corners[3 * c + a] = (positions[3 * triangles[c] + a] - box.middle[a]) / box.size;
    }
  }
  return { corners, normals: packedNormals(mesh, corners), edges: edgesOf(mesh) };
}

/** Return normals of the corners, in bytes: those of the file, else of the surface. */
function packedNormals(mesh, corners) {
  const { triangles } = mesh;
  const packed = new Int8Array(4 * triangles.length);
  const given = mesh.attributes.find(({ role, width, has }) => role === "normal" && width === 3 && !has);
  const values = given ? cornerValues(mesh, given) : creasedNormals(mesh, corners);
  for (let c = 0; c < triangles.length; c++) {
    const size = Math.hypot(values[3 * c], values[3 * c + 1], values[3 * c + 2]) || 1;
    for (let a = 0; a < 3; a++) packed[4 * c + a] = Math.round((127 * values[3 * c + a]) / size);
  }
  return packed;
}

/** Return sums of the normals of the triangles around each corner that do not bend away from its. */
function creasedNormals({ triangles, positions }, corners) {
  const count = triangles.length;
  const faces = new Float32Array(count);
  const sizes = new Float32Array(count / 3);
  for (let t = 0; t < count; t += 3) {
    const normal = triangleNormal(corners, t);
    faces.set(normal, t);
    sizes[t / 3] = Math.hypot(...normal);
  }
  const first = new Int32Array(positions.length / 3).fill(-1);
  const next = new Int32Array(count);
  for (let c = count - 1; c >= 0; c--) {
    next[c] = first[triangles[c]];
    first[triangles[c]] = c;
  }
  const sums = new Float32Array(3 * count);
  for (let c = 0; c < count; c++) {
    const own = c - (c % 3);
    let seen = 0;
    // A vertex of very many triangles would take too long.
    for (let d = first[triangles[c]]; d >= 0 && seen < MOST_AROUND; d = next[d], seen++) {
      const t = d - (d % 3);
      const along = faces[own] * faces[t] + faces[own + 1] * faces[t + 1] + faces[own + 2] * faces[t + 2];
      if (along < CREASE * sizes[own / 3] * sizes[t / 3]) continue;
      for (let a = 0; a < 3; a++) sums[3 * c + a] += faces[t + a];
    }
  }
  return sums;
}

/** Return the normal of the triangle that begins with corner c, twice its area long. */
function triangleNormal(corners, c) {
  const [p, q, r] = [3 * c, 3 * c + 3, 3 * c + 6];
  const [ux, uy, uz] = [0, 1, 2].map((a) => corners[q + a] - corners[p + a]);
  const [vx, vy, vz] = [0, 1, 2].map((a) => corners[r + a] - corners[p + a]);
  return [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
}

/** Return for each corner which sides of its triangle are edges of polygons: bit i, across from i. */
function edgesOf({ triangles, triangleCorners, trianglePolygons, offsets }) {
  const edges = new Uint8Array(triangles.length);
  for (let t = 0; t < trianglePolygons.length; t++) {
    const size = offsets[trianglePolygons[t] + 1] - offsets[trianglePolygons[t]];
    let bits = 0;
    for (let k = 0; k < 3; k++) {
      const from = triangleCorners[3 * t + ((k + 1) % 3)];
      const to = triangleCorners[3 * t + ((k + 2) % 3)];
      const apart = Math.abs(from - to);
      if (apart === 1 || apart === size - 1) bits |= 1 << k;
    }
    edges.fill(bits, 3 * t, 3 * t + 3);
  }
  return edges;
}

/** Return the values of an attribute at the corners of the triangles. */
export function cornerValues(mesh, { domain, values }) {
  const { triangles, triangleCorners, trianglePolygons } = mesh;
  const counts = { vertex: mesh.positions.length / 3, corner: mesh.corners.length };
  const width = values.length / (counts[domain] ?? mesh.offsets.length - 1) || 0;
  const rowOf = {
    vertex: (c) => triangles[c],
    corner: (c) => triangleCorners[c],
    face: (c) => trianglePolygons[Math.floor(c / 3)],
  }[domain];
  const found = new Float32Array(width * triangles.length);
  for (let c = 0; c < triangles.length; c++) {
    const row = rowOf(c) * width;
    for (let k = 0; k < width; k++) found[width * c + k] = Number(values[row + k]);
  }
  return found;
}

/** Return the indices of the corners of the triangles whose polygons are shown. */
export function shownCorners({ trianglePolygons }, isShown) {
  const shown = new Uint32Array(3 * trianglePolygons.length);
  let count = 0;
  for (let t = 0; t < trianglePolygons.length; t++) {
    if (!isShown(trianglePolygons[t])) continue;
    shown.set([3 * t, 3 * t + 1, 3 * t + 2], count);
    count += 3;
  }
  return shown.subarray(0, count);
}
