// Decompression of a Zstandard frame (RFC 8878); whatever is wrong throws a RangeError.
import { BackwardBits, readDistribution, readHuffman, tableOfDistribution } from "./zstandard_codes.mjs"; // prettier-ignore

const MAGIC = [0x28, 0xb5, 0x2f, 0xfd];
const LARGEST_WINDOW = 0x68;
const LARGEST_BLOCK = 1 << 17;

const LITERAL_CODES = codesOf(16, [1, 1, 1, 1, 2, 2, 3, 3, 4, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16], 0); // prettier-ignore
const MATCH_CODES = codesOf(32, [1, 1, 1, 1, 2, 2, 3, 3, 4, 4, 5, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16], 3); // prettier-ignore
const KINDS = [
  // Literal lengths, offsets and match lengths: most accuracy, most symbols, usual distribution.
  [9, 35, 6, [4, 3, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2, 2, 3, 2, 1, 1, 1, 1, 1, -1, -1, -1, -1]], // prettier-ignore
  [8, 31, 5, [1, 1, 1, 1, 1, 1, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, -1, -1, -1, -1, -1]], // prettier-ignore
  [9, 52, 6, [1, 4, 3, 2, 2, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, -1, -1, -1, -1, -1, -1, -1]], // prettier-ignore
];

/** Return base and bits of each code: `plain` ones of one value, then those with so many bits. */
function codesOf(plain, bits, first) {
  const codes = Array.from({ length: plain }, (_, i) => [first + i, 0]);
  let base = first + plain;
  for (const count of bits) {
    codes.push([base, count]);
    base += 1 << count;
  }
  return codes;
}

/** Return the bytes, so many and no others, of one frame, which ends with its bytes. */
export function framed(data, size) {
  let at = readHeader(data, size);
  const frame = {
    bytes: new Uint8Array(size),
    length: 0,
    repeated: [1, 4, 8],
    huffman: null,
    tables: [null, null, null],
  };
  for (let last = 0; !last; ) {
    const header = little(data, at, 3);
    at += 3;
    last = header & 1;
    const [kind, length] = [(header >> 1) & 3, header >> 3];
    if (kind === 3 || length > LARGEST_BLOCK) throw new RangeError("invalid block");
    const stored = piece(data, at, kind === 1 ? 1 : length);
    if (kind === 0) append(frame, stored);
    else if (kind === 1) append(frame, new Uint8Array(length).fill(stored[0]));
    else readBlock(stored, frame);
    at += stored.length;
  }
  if (at !== data.length) throw new RangeError("the frame does not end with its bytes");
  if (frame.length !== size) throw new RangeError(`${frame.length} bytes`);
  return frame.bytes;
}

function readHeader(data, size) {
  if (!MAGIC.every((byte, i) => data[i] === byte)) {
    throw new RangeError("no magic number of a frame");
  }
  const descriptor = data[4] ?? 0;
  if (descriptor & 0x1f) throw new RangeError(`descriptor ${descriptor}, with more than a size`);
  const single = (descriptor >> 5) & 1;
  const width = [single, 2, 4, 8][descriptor >> 6];
  const at = single ? 5 : 6;
  if (!width || data.length < at + width) throw new RangeError("a frame without its size");
  if (!single && data[5] > LARGEST_WINDOW) throw new RangeError("a window of more than 8 MiB");
  const held = little(data, at, width) + (width === 2 ? 256 : 0);
  if (held !== size) throw new RangeError(`a frame of ${held} bytes`);
  return at + width;
}

function piece(data, at, size) {
  if (size > data.length - at) throw new RangeError("truncated");
  return data.subarray(at, at + size);
}

function little(data, at, width) {
  return piece(data, at, width).reduceRight((number, byte) => number * 256 + byte, 0);
}

function append(frame, bytes) {
  if (bytes.length > frame.bytes.length - frame.length) throw new RangeError("too many bytes");
  frame.bytes.set(bytes, frame.length);
  frame.length += bytes.length;
}

function readBlock(block, frame) {
  const [literals, at] = readLiterals(block, frame);
  const rest = block.subarray(at);
  const begin = frame.length;
  readSequences(rest, literals, frame);
  if (frame.length - begin > LARGEST_BLOCK) throw new RangeError("invalid block");
}

/** Return the literals of a block, and the position after them. */
function readLiterals(block, frame) {
  const [first] = piece(block, 0, 1);
  const [kind, format] = [first & 3, (first >> 2) & 3];
  if (kind < 2) {
    const width = format === 1 ? 2 : format === 3 ? 3 : 1;
    const size = little(block, 0, width) >> (width === 1 ? 3 : 4);
    if (size > LARGEST_BLOCK) throw new RangeError("too many literals");
    const stored = piece(block, width, kind ? 1 : size);
    const literals = kind ? new Uint8Array(size).fill(stored[0]) : stored;
    return [literals, width + stored.length];
  }
  const width = 3 + Math.max(format - 1, 0);
  const bits = [10, 10, 14, 18][format];
  const header = Math.floor(little(block, 0, width) / 16);
  const size = header % 2 ** bits;
  const packedSize = Math.floor(header / 2 ** bits);
  if (size > LARGEST_BLOCK) throw new RangeError("too many literals");
  let stored = piece(block, width, packedSize);
  if (kind === 2) {
    let used;
    [frame.huffman, used] = readHuffman(stored);
    stored = stored.subarray(used);
  }
  if (!frame.huffman) throw new RangeError("no table of literals");
  return [readHuffmanStreams(stored, size, format ? 4 : 1, frame.huffman), width + packedSize];
}

function readHuffmanStreams(stored, size, streams, table) {
  const literals = new Uint8Array(size);
  if (streams === 1) {
    readHuffmanStream(stored, literals, table);
    return literals;
  }
  const each = Math.floor((size + 3) / 4);
  if (3 * each > size) throw new RangeError("too few literals");
  let at = 6;
  for (let s = 0; s < 4; s++) {
    const length = s < 3 ? little(stored, 2 * s, 2) : stored.length - at;
    const part = literals.subarray(s * each, s < 3 ? (s + 1) * each : size);
    readHuffmanStream(piece(stored, at, length), part, table);
    at += length;
  }
  return literals;
}

function readHuffmanStream(stored, literals, { symbols, lengths, longest }) {
  const bits = new BackwardBits(stored);
  for (let i = 0; i < literals.length; i++) {
    const code = bits.look(longest);
    literals[i] = symbols[code];
    bits.skip(lengths[code]);
  }
  if (bits.left !== 0) throw new RangeError("a stream of literals of another length");
}

function readSequences(data, literals, frame) {
  let [count] = piece(data, 0, 1);
  let at = 1;
  if (count === 255) [count, at] = [little(data, 1, 2) + 0x7f00, 3];
  else if (count > 127) [count, at] = [((count - 128) << 8) + little(data, 1, 1), 2];
  if (!count) {
    if (at !== data.length) throw new RangeError("bytes after no sequences");
    append(frame, literals);
    return;
  }
  const modes = little(data, at, 1);
  if (modes & 3) throw new RangeError("reserved modes");
  at += 1;
  for (let k = 0; k < 3; k++) {
    const [most, symbols, accuracy, usual] = KINDS[k];
    const mode = (modes >> (6 - 2 * k)) & 3;
    if (mode === 0) frame.tables[k] = tableOfDistribution(usual, accuracy);
    else if (mode === 1) {
      const symbol = little(data, at, 1);
      if (symbol > symbols) throw new RangeError("invalid symbol");
      frame.tables[k] = { accuracy: 0, symbols: [symbol], bits: [0], bases: [0] };
      at += 1;
    } else if (mode === 2) {
      const [distribution, own, used] = readDistribution(data.subarray(at), most, symbols);
      frame.tables[k] = tableOfDistribution(distribution, own);
      at += used;
    } else if (!frame.tables[k]) throw new RangeError("no table to repeat");
  }
  runSequences(new BackwardBits(data.subarray(at)), count, literals, frame);
}

function runSequences(bits, count, literals, frame) {
  const { tables, repeated } = frame;
  const states = tables.map((table) => bits.take(table.accuracy));
  let used = 0;
  for (let i = 0; i < count; i++) {
    const [literalCode, offsetCode, matchCode] = tables.map((t, k) => t.symbols[states[k]]);
    const value = 2 ** offsetCode + bits.take(offsetCode);
    const [matchBase, matchBits] = MATCH_CODES[matchCode];
    const match = matchBase + bits.take(matchBits);
    const [literalBase, literalBits] = LITERAL_CODES[literalCode];
    const length = literalBase + bits.take(literalBits);
    const offset = offsetOf(value, length, repeated);
    append(frame, piece(literals, used, length));
    used += length;
    copyMatch(frame, offset, match);
    if (i + 1 < count) {
      for (const k of [0, 2, 1]) {
        states[k] = tables[k].bases[states[k]] + bits.take(tables[k].bits[states[k]]);
      }
    }
  }
  if (bits.left !== 0) throw new RangeError("sequences of another length");
  append(frame, literals.subarray(used));
}

/** Return the offset that a value stands for, and note it among the last three. */
function offsetOf(value, length, repeated) {
  if (value > 3) {
    repeated.unshift(value - 3);
    repeated.pop();
    return value - 3;
  }
  const index = value - 1 + (length === 0 ? 1 : 0);
  const offset = index === 3 ? repeated[0] - 1 : repeated[index];
  if (index > 0) {
    repeated.splice(Math.min(index, 2), 1);
    repeated.unshift(offset);
  }
  return offset;
}

function copyMatch(frame, offset, count) {
  const { bytes, length } = frame;
  if (offset < 1 || offset > length) throw new RangeError("an offset that is too large");
  if (count > bytes.length - length) throw new RangeError("too many bytes");
  for (let i = length; i < length + count; i++) bytes[i] = bytes[i - offset];
  frame.length += count;
}
