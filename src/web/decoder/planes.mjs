// Polygons in their planes, each from a corner that its positions decide.

// What a product of coordinates up to 2 may be off by, after they were rounded a few times.
export const TINY = 2 ** -48;
/** Sine of the angle below which a corner is taken as flat. */
export const FLAT = 1e-5;

/** Return the corner from which on the positions of a polygon come first in their order, the last of equals. */
export function leastCorner(points) {
  let best = 0;
  for (let c = 1; c < points.length; c++) {
    if (!isBefore(points, best, c)) best = c;
  }
  return best;
}

function isBefore(points, c, d) {
  const size = points.length;
  for (let k = 0; k < size; k++) {
    const [p, q] = [points[(c + k) % size], points[(d + k) % size]];
    for (let a = 0; a < 3; a++) {
      if (p[a] !== q[a]) return p[a] < q[a];
    }
  }
  return false;
}

/**
 * Return coordinates x and y in which a polygon turns to the left, from a corner on, and whether it
 * is convex; null where it has no plane.
 */
export function planeOf(points, start) {
  const size = points.length;
  let near = points.map((_, k) => [0, 1, 2].map((a) => points[(start + k) % size][a] - points[start][a]));
  const scale = 2 ** -(1 + Math.floor(Math.log2(Math.max(...near.map((p) => Math.max(...p.map(Math.abs)))))));
  if (!Number.isFinite(scale)) return null;
  near = near.map((p) => p.map((x) => x * scale));
  const normal = [0, 0, 0];
  near.forEach((p, k) => {
    const q = near[(k + 1) % size];
    for (let a = 0; a < 3; a++) {
      const [b, c] = [(a + 1) % 3, (a + 2) % 3];
      normal[a] += p[b] * q[c] - p[c] * q[b];
    }
  });
  const sizes = normal.map(Math.abs);
  const w = sizes.indexOf(Math.max(...sizes));
  if (!(sizes[w] > TINY)) return null;
  // One steps along the normal until the coordinate w is 0.
  const axes = normal[w] < 0 ? [(w + 2) % 3, (w + 1) % 3] : [(w + 1) % 3, (w + 2) % 3];
  const [x, y] = axes.map((u) => near.map((p) => p[u] - (normal[u] / normal[w]) * p[w]));
  return { x, y, isConvex: isConvex(x, y) };
}

/** Return whether a polygon turns to the left at every corner, and once in all. */
function isConvex(x, y) {
  const size = x.length;
  for (let k = 0; k < size; k++) {
    const [i, j] = [(k + 1) % size, (k + 2) % size];
    const [ax, ay, bx, by] = [x[i] - x[k], y[i] - y[k], x[j] - x[i], y[j] - y[i]];
    const least = FLAT * Math.sqrt((ax * ax + ay * ay) * (bx * bx + by * by));
    if (!(ax * by - ay * bx > least)) return false;
    // The fan around corner 0, where x and y are 0.
    if (k > 0 && k < size - 1 && !(x[k] * y[i] - y[k] * x[i] > 0)) return false;
  }
  return true;
}
