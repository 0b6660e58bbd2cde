// Numbers of 16 bits, IEEE 754 binary16, which typed arrays do not have everywhere.

const LEAST_NORMAL = 2 ** -14;
const UNIT = 2 ** -24;

/** Return the nearest number of 16 bits, of two the one with an even last bit. */
export function halfOf(value) {
  const size = Math.abs(value);
  const exponent = Math.floor(Math.log2(Math.max(size, LEAST_NORMAL)));
  // The logarithm may be rounded up to the next whole number.
  const unit = (size < 2 ** exponent ? 2 ** (exponent - 1) : 2 ** exponent) / 1024;
  const scaled = size / Math.max(unit, UNIT);
  const below = Math.floor(scaled);
  const isUp = scaled - below > 0.5 || (scaled - below === 0.5 && below % 2 === 1);
  const rounded = (below + Number(isUp)) * Math.max(unit, UNIT);
  return Math.sign(value) * (rounded > 65504 ? Infinity : rounded);
}

/** Return the bits of a number, null if it is none of 16 bits. */
export function halfBits(value) {
  const sign = value < 0 || Object.is(value, -0) ? 0x8000 : 0;
  const size = Math.abs(value);
  if (size === 0) return sign;
  if (halfOf(size) !== size || size === Infinity) return null;
  if (size < LEAST_NORMAL) return sign | (size / UNIT);
  let exponent = Math.floor(Math.log2(size));
  if (size < 2 ** exponent) exponent--;
  return sign | ((exponent + 15) << 10) | ((size / 2 ** exponent - 1) * 1024);
}

/** Return the number that 16 bits are. */
export function fromHalfBits(bits) {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 31;
  const fraction = bits & 1023;
  if (exponent === 31) return fraction ? NaN : sign * Infinity;
  return sign * (exponent ? (1 + fraction / 1024) * 2 ** (exponent - 15) : fraction * 2 ** -24);
}
