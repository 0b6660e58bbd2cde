// Unit normals as pairs of small integers, relative to the decoded surface (SPEC.md 5.17).
import { FormatError, located } from "./errors.mjs";
import { halfOf } from "./halves.mjs";
import { doubled, widened } from "./integers.mjs";
import { codeThree, codeVectors } from "./labels.mjs";
import { MAX_NORMAL_BITS, MIN_NORMAL_BITS } from "./layout.mjs";
import { extentOf } from "./normals.mjs";

const [RELATIVE, ABSOLUTE, ZERO] = [0, 1, 2];
const [AREA, ANGLE, , NONE] = [0, 1, 2, 3];
const DELTAS = 0;
const POLE = [2 / 7, 3 / 7, 6 / 7];

const half = (bits) => 2 ** (bits - 1) - 1;

/** Return the states and grid points of normals, and the weights of their prediction. */
export function decodeNormals(core, payload, begin, bitsOfEntry, elements) {
  const found = located(begin, "", () => decode(core, payload, elements));
  if (found.bits !== bitsOfEntry) {
    const reason = `normals of ${found.bits} bits, where the table has ${bitsOfEntry}`;
    throw new FormatError(reason, begin);
  }
  return found;
}

function decode(core, payload, elements) {
  if (payload.length < 2) {
    throw new FormatError("truncated: the header of the normals", payload.length);
  }
  const [bits, plan] = payload;
  if (bits < MIN_NORMAL_BITS || bits > MAX_NORMAL_BITS) {
    const limits = `${MIN_NORMAL_BITS}..${MAX_NORMAL_BITS}`;
    throw new FormatError(`normals of ${bits} bits, outside ${limits}`, 0);
  }
  if (plan > 7) throw new FormatError(`unknown prediction or coding of normals: ${plan}`, 1);
  const isDeltas = plan >> 2 === DELTAS;
  const weights = plan & 3;
  let codes = isDeltas ? new Int32Array(3 * elements.count) : new BigInt64Array(3 * elements.count);
  const code = isDeltas ? codeVectors : codeThree;
  const model = core.model(isDeltas ? "vectors" : "positions");
  core.decode(model, payload.subarray(2), (coder) => code(core, coder, elements, codes), 2);
  if (isDeltas) codes = widened(codes);
  const numbers = doubled(codes);
  const h = half(bits);
  for (let i = 0; i < numbers.length; i += 3) {
    const [state, a, b] = numbers.subarray(i, i + 3);
    const isOff = Math.abs(a) > h || Math.abs(b) > h || (state === ZERO && (a !== 0 || b !== 0));
    if (state < (weights === NONE ? ABSOLUTE : RELATIVE) || state > ZERO || isOff) {
      throw new FormatError(`normal ${i / 3} is outside its grid`, 2);
    }
  }
  return { bits, weights, codes };
}

/** Return the vectors of normals, of length 1 or 0, three numbers each of the type of the entry. */
export function normalVectors(codes, entry, weights, owners, domains, positions) {
  const numbers = doubled(codes);
  const count = owners.has.length;
  const sums =
    weights === NONE
      ? new Float64Array(3 * count)
      : surfaceNormals(domains, owners, entry.domain, positions, weights);
  const h = half(entry.bits);
  const Numbers = entry.type === "float64" ? Float64Array : Float32Array;
  const round = entry.type === "float16" ? halfOf : (x) => x;
  const vectors = new Numbers(3 * count);
  for (let i = 0; i < 3 * count; i += 3) {
    const [state, a, b] = numbers.subarray(i, i + 3);
    if (state === ZERO) continue;
    const direction = fromOctahedral(a, b, h);
    const isRelative = state === RELATIVE;
    const own = isRelative ? normalized(turned(direction, sums.subarray(i, i + 3))) : direction;
    vectors.set(own.map(round), i);
  }
  return vectors;
}

function fromOctahedral(a, b, h) {
  const z = h - Math.abs(a) - Math.abs(b);
  const sign = (t) => (t < 0 ? -1 : 1);
  const folded = [(h - Math.abs(b)) * sign(a), (h - Math.abs(a)) * sign(b), z];
  return normalized(z < 0 ? folded : [a, b, z]);
}

/** Return a direction of the frame of the pole in that of a prediction. */
function turned([x, y, z], prediction) {
  const w = [(6 * x - 3 * y + 2 * z) / 7, (2 * x + 6 * y + 3 * z) / 7, (-3 * x - 2 * y + 6 * z) / 7];
  let p = normalized(prediction);
  if (p.every((one) => one === 0)) p = POLE;
  const axis = normalized(p.map((one, i) => one + POLE[i]));
  const along = axis[0] * w[0] + axis[1] * w[1] + axis[2] * w[2];
  return w.map((one, i) => 2 * along * axis[i] - one);
}

function normalized(v) {
  const scale = Math.max(Math.abs(v[0]), Math.abs(v[1]), Math.abs(v[2]));
  if (!(scale > 0 && Number.isFinite(scale))) return [0, 0, 0];
  const [x, y, z] = [v[0] / scale, v[1] / scale, v[2] / scale];
  const length = Math.sqrt(x * x + y * y + z * z);
  return [x / length, y / length, z / length];
}

/** Return the sums of normals of polygons around owners, by their weights. */
function surfaceNormals({ vertexOfCorners: vertices, polygons }, owners, domain, positions, weights) {
  const { offsets } = polygons;
  const extent = extentOf(positions) || 1;
  const sums = new Float64Array(3 * owners.has.length);
  const at = (c) => [0, 1, 2].map((a) => (positions[3 * vertices[c] + a] - positions[a]) / extent);
  const ownerOf = { vertex: (c) => vertices[c], corner: (c) => owners.ofElements[c], face: (c, p) => p }; // prettier-ignore
  for (let p = 0; p + 1 < offsets.length; p++) {
    const [begin, end] = [offsets[p], offsets[p + 1]];
    const origin = at(begin);
    const row = [];
    for (let c = begin; c < end; c++) row.push(less(at(c), origin));
    const size = row.length;
    const area = [0, 0, 0];
    row.forEach((v, k) => add(area, cross(v, row[(k + 1) % size])));
    const length = Math.sqrt(dot(area, area));
    for (let k = 0; k < size; k++) {
      let scale = 1;
      if (weights !== AREA) scale = length > 0 ? 1 / length : 1;
      if (weights === ANGLE) scale *= angleAt(row, k);
      const owner = ownerOf[domain](begin + k, p);
      for (let a = 0; a < 3; a++) sums[3 * owner + a] += area[a] * scale;
    }
  }
  return sums;
}

function angleAt(row, k) {
  const size = row.length;
  const a = less(row[(k + 1) % size], row[k]);
  const b = less(row[(k + size - 1) % size], row[k]);
  const c = cross(a, b);
  return Math.atan2(Math.sqrt(dot(c, c)), dot(a, b));
}

const less = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const add = (sum, v) => v.forEach((x, i) => (sum[i] += x));
