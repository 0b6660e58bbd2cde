// Values of attributes from the integers that are coded, and which integers stand for none.
import { numberSize } from "./attribute_table.mjs";
import { FormatError } from "./errors.mjs";
import { fromHalfBits, halfOf } from "./halves.mjs";
import { doubled, wordsOf } from "./integers.mjs";
import { MAX_LIMB_BITS } from "./layout.mjs";

const ARRAYS = {
  bool: Uint8Array,
  uint8: Uint8Array,
  uint16: Uint16Array,
  uint32: Uint32Array,
  uint64: BigUint64Array,
  int8: Int8Array,
  int16: Int16Array,
  int32: Int32Array,
  int64: BigInt64Array,
  float16: Float32Array,
  float32: Float32Array,
  float64: Float64Array,
  complex64: Float32Array,
  complex128: Float64Array,
};

/** Refuse integers that are the codes of no value. */
export function checkCodes(entry, codes) {
  if (entry.coding === "exact") return;
  const most = 2 ** (entry.coding === "grid" ? MAX_LIMB_BITS : entry.bits);
  if (doubled(codes).some((code) => code < 0 || code >= most)) {
    throw new FormatError("attribute integer out of range", 0);
  }
  if (entry.coding === "integer") integersOf(entry, codes);
}

/** Return the integers that limbs are cut from, each a BigInt; refuse those of no type. */
function integersOf(entry, codes) {
  const { bits, limbs, type } = entry;
  const size = type === "bool" ? 1 : 8 * numberSize(type);
  const isSigned = type.startsWith("int");
  const [least, most] = isSigned
    ? [-(1n << BigInt(size - 1)), (1n << BigInt(size - 1)) - 1n]
    : [0n, (1n << BigInt(size)) - 1n];
  const count = codes.length / limbs;
  const found = isSigned ? new BigInt64Array(count) : new BigUint64Array(count);
  for (let i = 0; i < count; i++) {
    let number = 0n;
    for (let k = limbs - 1; k >= 0; k--) number = (number << BigInt(bits)) | codes[i * limbs + k];
    if (number >> 64n) throw new FormatError("attribute integer exceeds 64 bits", 0);
    number = BigInt.asUintN(64, number + entry.origin);
    if (isSigned) number = BigInt.asIntN(64, number);
    if (number < least || number > most) {
      throw new FormatError(`attribute value not representable in ${type}`, 0);
    }
    found[i] = number;
  }
  return found;
}

/** Return the numbers of codes, two of each complex one, in a typed array. */
export function fromCodes(entry, codes) {
  const { type, coding, width } = entry;
  const Numbers = ARRAYS[type];
  if (coding === "exact") return fromBits(type, codes);
  if (coding === "grid") {
    const round = type === "float16" ? halfOf : (x) => x;
    const grid = doubled(codes);
    return Numbers.from(grid, (g, i) => round(entry.origin[i % width] + g / entry.density));
  }
  const integers = integersOf(entry, codes);
  return integers.constructor === Numbers ? integers : Numbers.from(integers, Number);
}

function fromBits(type, codes) {
  const size = numberSize(type);
  if (size === 8) return new Float64Array(codes.slice().buffer);
  const words = wordsOf(codes);
  const low = Int32Array.from({ length: codes.length }, (_, i) => words[2 * i]);
  return size === 4 ? new Float32Array(low.buffer) : Float32Array.from(low, fromHalfBits);
}
