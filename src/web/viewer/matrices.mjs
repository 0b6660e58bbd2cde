// Matrices of four rows and columns, column by column, and vectors of three numbers.

export const less = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const plus = (a, b, times = 1) => [0, 1, 2].map((i) => a[i] + times * b[i]);
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);

/** Return the direction of a vector, zero for zero. */
export function unit(a) {
  const size = length(a) || 1;
  return [a[0] / size, a[1] / size, a[2] / size];
}

/** Return a vector turned about an axis of length 1. */
export function turned(v, axis, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const around = cross(axis, v);
  const along = dot(axis, v) * (1 - c);
  return [0, 1, 2].map((i) => v[i] * c + around[i] * s + axis[i] * along);
}

/** Return the product of two matrices. */
export function product(a, b) {
  const made = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
      made[4 * column + row] = sum;
    }
  }
  return made;
}

/** Return the matrix of a perspective of a vertical angle. */
export function perspective(angle, aspect, near, far) {
  const f = 1 / Math.tan(angle / 2);
  const depth = near - far;
  return Float32Array.of(
    ...[f / aspect, 0, 0, 0],
    ...[0, f, 0, 0],
    ...[0, 0, (near + far) / depth, -1],
    ...[0, 0, (2 * near * far) / depth, 0],
  );
}

/** Return the matrix that leads from a world to what an eye sees, with these axes. */
export function view(eye, right, up, back) {
  return Float32Array.of(
    ...[right[0], up[0], back[0], 0],
    ...[right[1], up[1], back[1], 0],
    ...[right[2], up[2], back[2], 0],
    ...[-dot(right, eye), -dot(up, eye), -dot(back, eye), 1],
  );
}

/** Return three numbers of many. */
export const row = (numbers, v) => [numbers[3 * v], numbers[3 * v + 1], numbers[3 * v + 2]];

/** Return the normal of a triangle, twice its area long. */
export function faceNormal(positions, triangles, t) {
  const a = row(positions, triangles[3 * t]);
  const b = row(positions, triangles[3 * t + 1]);
  const c = row(positions, triangles[3 * t + 2]);
  return cross(less(b, a), less(c, a));
}

/** Return the angle between vectors of any length, in degrees, 0 for zero vectors. */
export const angleBetween = (a, b) => (Math.atan2(length(cross(a, b)), dot(a, b)) * 180) / Math.PI;
