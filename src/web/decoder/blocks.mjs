// Blocks of bytes: plain, deflated, or in a Zstandard frame (SPEC.md 5.15).
import { readVarint, take } from "./bytes.mjs";
import { FormatError } from "./errors.mjs";
import { inflated, OTHER_SIZE } from "./inflate.mjs";
import { framed } from "./zstandard.mjs";

const UNPACKERS = new Map([
  [1, [inflated, "invalid deflate stream"]],
  [2, [framed, "invalid zstandard frame"]],
]);

/** Return what a block of at most so many bytes holds, and the position after it. */
export function unpacked(bytes, position, most) {
  const [form] = take(bytes, position, 1);
  if (form && !UNPACKERS.has(form)) {
    throw new FormatError(`unknown form ${form} of a block`, position);
  }
  const [size, start] = readVarint(bytes, position + 1);
  if (size > most) {
    throw new FormatError(`a block of ${size} bytes, more than ${most}`, position + 1);
  }
  if (!form) return [take(bytes, start, size), start + size];
  const [length, at] = readVarint(bytes, start);
  if (length >= size) {
    throw new FormatError(`a block of ${size} bytes packed into ${length}`, position);
  }
  const [unpack, fault] = UNPACKERS.get(form);
  const packed = take(bytes, at, length);
  try {
    return [unpack(packed, size), at + length];
  } catch (error) {
    if (!(error instanceof RangeError)) throw error;
    const text =
      error.message === OTHER_SIZE && form === 1
        ? `a deflate stream of another size than ${size} bytes`
        : `${fault}${form === 2 ? ` for a block of ${size} bytes` : ""}: ${error.message}`;
    throw new FormatError(text, at);
  }
}
