// Polygons cut into triangles that do not fold, as `PolyMesh.triangles` of the library has them.
import { clipEars } from "./ears.mjs";
import { FLAT, leastCorner, planeOf } from "./planes.mjs";

// Diagonals that differ by less, as part of their squares, are equally long; half of quads by less
// than this part of the whole has no area.
const ALIKE = 1e-3;
const SLIVER = 1e-6;
// Along this direction, which no grid is likely to have, equally long diagonals are told apart.
const SLANT = [1, 0.71, 0.37];
const LARGEST = 1 << 16;

/** Return polygons as triangles: their vertices, corners, and the polygon of each. */
export function trianglesOf(positions, corners, offsets) {
  const count = corners.length - 2 * (offsets.length - 1);
  const triangles = new Int32Array(3 * count);
  const triangleCorners = new Int32Array(3 * count);
  const trianglePolygons = new Int32Array(count);
  let t = 0;
  for (let p = 0; p + 1 < offsets.length; p++) {
    const [first, size] = [offsets[p], offsets[p + 1] - offsets[p]];
    const cut = size === 3 ? [0, 1, 2] : cutOf(positions, corners.subarray(first, first + size));
    for (let i = 0; i < cut.length; i += 3, t++) {
      for (let k = 0; k < 3; k++) {
        triangleCorners[3 * t + k] = first + cut[i + k];
        triangles[3 * t + k] = corners[first + cut[i + k]];
      }
      trianglePolygons[t] = p;
    }
  }
  return { triangles, triangleCorners, trianglePolygons };
}

/** Return a polygon as triangles of its corners. */
function cutOf(positions, polygon) {
  const points = [];
  for (const v of polygon) points.push([positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]]);
  if (points.length === 4) return fan(4, diagonalOf(points));
  const start = leastCorner(points);
  const plane = planeOf(points, start);
  if (!plane || plane.isConvex || points.length > LARGEST) return fan(points.length, start);
  const ears = clipEars(plane.x, plane.y);
  return ears ? ears.map((c) => (c + start) % points.length) : fan(points.length, start);
}

function fan(size, around) {
  const cut = [];
  for (let k = 1; k + 1 < size; k++) cut.push(around, (around + k) % size, (around + k + 1) % size);
  return cut;
}

// Four points, from their lowest numbers, and scaled; the normal of the quad.
const AT = new Float64Array(12);
const NORMAL = new Float64Array(3);

/** Return the corner, 0 or 1, of the diagonal at which a quad is cut. */
function diagonalOf(points) {
  scale(points);
  // The diagonals' product.
  const between = (i, j, a) => AT[3 * j + a] - AT[3 * i + a];
  for (let a = 0; a < 3; a++) {
    const [b, c] = [(a + 1) % 3, (a + 2) % 3];
    NORMAL[a] = between(0, 2, b) * between(1, 3, c) - between(0, 2, c) * between(1, 3, b);
  }
  const whole = NORMAL[0] * NORMAL[0] + NORMAL[1] * NORMAL[1] + NORMAL[2] * NORMAL[2];
  const [p, q, r, s] = [turnAt(0), turnAt(1), turnAt(2), turnAt(3)];
  const [acrossEven, acrossOdd] = [Math.min(q, s), Math.min(p, r)];
  const isEither = Math.min(acrossEven, acrossOdd) > SLIVER * whole;
  const even = isEither ? squareOf(0, 2) : -acrossEven;
  const odd = isEither ? squareOf(1, 3) : -acrossOdd;
  const isAlike = isEither ? Math.abs(even - odd) < ALIKE * (even + odd) : !(even !== odd);
  if (!isAlike) return Number(odd < even);
  const along = (i) => SLANT[0] * AT[3 * i] + SLANT[1] * AT[3 * i + 1] + SLANT[2] * AT[3 * i + 2];
  const lowest = [Math.min(along(0), along(2)), Math.min(along(1), along(3))];
  return lowest[0] === lowest[1] ? leastCorner(points) % 2 : Number(lowest[1] < lowest[0]);
}

function scale(points) {
  let most = 0;
  for (let a = 0; a < 3; a++) {
    const low = Math.min(points[0][a], points[1][a], points[2][a], points[3][a]);
    for (let i = 0; i < 4; i++) {
      AT[3 * i + a] = points[i][a] - low;
      if (AT[3 * i + a] > most) most = AT[3 * i + a];
    }
  }
  const factor = 2 ** -(1 + Math.floor(Math.log2(most)));
  if (Number.isFinite(factor)) for (let k = 0; k < 12; k++) AT[k] *= factor;
}

function squareOf(i, j) {
  const [x, y, z] = [AT[3 * j] - AT[3 * i], AT[3 * j + 1] - AT[3 * i + 1], AT[3 * j + 2] - AT[3 * i + 2]];
  return x * x + y * y + z * z;
}

/** Return how a quad turns at a corner, along its normal. */
function turnAt(i) {
  const [h, at, j] = [3 * ((i + 3) % 4), 3 * i, 3 * ((i + 1) % 4)];
  const [ax, ay, az] = [AT[at] - AT[h], AT[at + 1] - AT[h + 1], AT[at + 2] - AT[h + 2]];
  const [bx, by, bz] = [AT[j] - AT[at], AT[j + 1] - AT[at + 1], AT[j + 2] - AT[at + 2]];
  const [x, y, z] = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
  return NORMAL[0] * x + NORMAL[1] * y + NORMAL[2] * z;
}
