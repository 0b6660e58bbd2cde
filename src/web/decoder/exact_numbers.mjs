// Numbers of number formats, and the arithmetic that they went through (SPEC.md 5.12).
import { wordsOf } from "./integers.mjs";

const EXACT = 2 ** 53;
const SAFE = 2 ** 52;
const TENS = Array.from({ length: 23 }, (_, k) => Number(`1e${k}`));
const LONGEST_EXPONENT = 1 << 12;
const [ADD, MULTIPLY] = [0, 1];
const LARGEST_ORDINAL = { single: 0x7f7fffffn, double: 0x7fefffffffffffffn };

/** Put the values of a column into every third of `values`; one beyond its type is infinite. */
export function fromIndices(known, axis, column, single, { raw, negativeZero }) {
  const { choices, indices, deviations, values } = known;
  const words = wordsOf(indices);
  const convert = converterOf(column, single);
  const number = column.formats.map((format) => numberOf(format, single));
  const bits = new DataView(new ArrayBuffer(8));
  for (let i = axis; i < values.length; i += 3) {
    const choice = choices[i];
    if (choice === raw) {
      bits.setInt32(0, words[2 * i], true);
      bits.setInt32(4, words[2 * i + 1], true);
      values[i] = single ? bits.getFloat32(0, true) : bits.getFloat64(0, true);
      continue;
    }
    const found = choice === negativeZero ? -0 : number[choice](words[2 * i], words[2 * i + 1]);
    values[i] = convert(found);
    if (column.deviations) values[i] = deviated(values[i], deviations[i], single);
  }
}

/** Return a function of the words of an index, which returns the number of a format there. */
function numberOf({ base, places, digits }, single) {
  const top = base === 2 ? 2 ** (digits - 1) : TENS[digits - 1];
  const period = (base - 1) * top;
  const bigTop = BigInt(base) ** BigInt(digits - 1);
  const bigPeriod = BigInt(base - 1) * bigTop;
  return (low, high) => {
    const index = high * 4294967296 + (low >>> 0);
    let size = Math.abs(index);
    let e = 0;
    let m = size;
    if (size < SAFE) {
      if (size >= top) {
        e = Math.max(Math.floor((size - top) / period), 0);
        // The quotient of two doubles may have been rounded up.
        while (e * period > size - top) e--;
        m = size - e * period;
      }
    } else {
      const exact = (BigInt(high) << 32n) | BigInt(low >>> 0);
      const wide = exact < 0n ? -exact : exact;
      const over = wide > bigTop ? (wide - bigTop) / bigPeriod : 0n;
      e = Number(over);
      m = Number(wide - over * bigPeriod);
    }
    const sign = index < 0 ? -1 : 1;
    if (base === 2) return sign * scaled(m, Math.min(e, LONGEST_EXPONENT) - places);
    if (e > 18 || !(m < Math.floor(EXACT / TENS[e]))) return sign * Infinity;
    const quotient = (m * TENS[e]) / TENS[places];
    return sign * (single ? Math.fround(quotient) : quotient);
  };
}

/** Return m * 2^e, rounded once. */
function scaled(m, e) {
  if (e > 1000) return m * 2 ** 1000 * 2 ** (e - 1000);
  // A product with a power that is too small would be rounded to no digits.
  return e < -1000 ? m * 2 ** (e + 200) * 2 ** -200 : m * 2 ** e;
}

/** Return a function that applies the operations of a column. */
function converterOf({ operations, deviations, double }, single) {
  if (!operations.length && !deviations) return (x) => x;
  const each = single && !double ? Math.fround : (x) => x;
  const last = single ? Math.fround : (x) => x;
  return (x) => {
    for (const { operator, operand } of operations) {
      if (operator === ADD) x = each(x + operand);
      else x = each(operator === MULTIPLY ? x * operand : x / operand);
    }
    return last(x);
  };
}

const double = new Float64Array(1);
const doubleBits = new BigInt64Array(double.buffer);
const float = new Float32Array(1);
const floatBits = new Int32Array(float.buffer);

/** Return the float that is so many floats above a value, infinity beyond the largest. */
function deviated(value, deviation, single) {
  if (!Number.isFinite(value)) return Infinity;
  let bits;
  if (single) {
    float[0] = value;
    bits = BigInt(floatBits[0]);
  } else {
    double[0] = value;
    bits = doubleBits[0];
  }
  const mask = single ? 0x7fffffffn : 0x7fffffffffffffffn;
  const ordinal = (bits < 0n ? -(bits & mask) - 1n : bits) + BigInt(deviation);
  const size = ordinal < 0n ? -(ordinal + 1n) : ordinal;
  if (size > (single ? LARGEST_ORDINAL.single : LARGEST_ORDINAL.double)) return Infinity;
  if (single) floatBits[0] = Number(size);
  else doubleBits[0] = size;
  const found = single ? float[0] : double[0];
  return ordinal < 0n ? -found : found;
}
