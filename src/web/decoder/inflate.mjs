// Decompression of a deflate stream (RFC 1951); whatever is wrong throws a RangeError.

/** The message where a stream stands for other bytes than it should. */
export const OTHER_SIZE = "another number of bytes";

const LENGTHS = [3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 17, 19, 23, 27, 31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258]; // prettier-ignore
const LENGTH_BITS = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0]; // prettier-ignore
const DISTANCES = [1, 2, 3, 4, 5, 7, 9, 13, 17, 25, 33, 49, 65, 97, 129, 193, 257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577]; // prettier-ignore
const ORDER = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
const LONGEST = 15;
const END = 256;

/** Return the bytes, so many and no others, that a stream stands for, which ends with its bytes. */
export function inflated(data, size) {
  const input = new Bits(data);
  const made = { bytes: new Uint8Array(size), length: 0 };
  for (let last = 0; !last; ) {
    last = input.take(1);
    const kind = input.take(2);
    if (kind === 0) copyStored(input, made);
    else if (kind === 1) copyCoded(input, made, ...FIXED);
    else if (kind === 2) copyCoded(input, made, ...readTables(input));
    else throw new RangeError("invalid block type");
  }
  if (made.length !== size || input.at !== data.length) throw new RangeError(OTHER_SIZE);
  return made.bytes;
}

/** Reader of bits, the lowest of each byte first. */
class Bits {
  constructor(data) {
    Object.assign(this, { data, at: 0, held: 0, count: 0 });
  }

  take(count) {
    while (this.count < count) {
      if (this.at === this.data.length) throw new RangeError(OTHER_SIZE);
      this.held |= this.data[this.at++] << this.count;
      this.count += 8;
    }
    const bits = this.held & ((1 << count) - 1);
    this.held >>>= count;
    this.count -= count;
    return bits;
  }

  symbol({ counts, symbols }) {
    let [code, first, index] = [0, 0, 0];
    for (let length = 1; length <= LONGEST; length++) {
      code |= this.take(1);
      if (code - first < counts[length]) return symbols[index + code - first];
      index += counts[length];
      first = (first + counts[length]) << 1;
      code <<= 1;
    }
    throw new RangeError("invalid code");
  }
}

/** Return the table of a canonical Huffman code, by the lengths of its symbols. */
function tableOf(lengths) {
  const counts = new Uint16Array(LONGEST + 1);
  lengths.forEach((length) => counts[length]++);
  counts[0] = 0;
  let left = 1;
  for (let length = 1; length <= LONGEST; length++) left = 2 * left - counts[length];
  const used = lengths.filter((length) => length).length;
  // A code of one symbol may be incomplete, as zlib has it.
  if (left < 0 || (left > 0 && used > 1)) throw new RangeError("invalid code lengths");
  const starts = new Uint16Array(LONGEST + 2);
  for (let length = 1; length <= LONGEST; length++) {
    starts[length + 1] = starts[length] + counts[length];
  }
  const symbols = new Uint16Array(used);
  lengths.forEach((length, symbol) => {
    if (length) symbols[starts[length]++] = symbol;
  });
  return { counts, symbols };
}

const FIXED = [
  tableOf(Array.from({ length: 288 }, (_, i) => (i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8))),
  tableOf(Array(32).fill(5)),
];

function readTables(input) {
  const [literals, distances, count] = [input.take(5) + 257, input.take(5) + 1, input.take(4) + 4];
  if (literals > 286 || distances > 30) throw new RangeError("too many symbols");
  const lengths = Array(19).fill(0);
  for (let i = 0; i < count; i++) lengths[ORDER[i]] = input.take(3);
  const table = tableOf(lengths);
  const all = [];
  while (all.length < literals + distances) {
    const symbol = input.symbol(table);
    if (symbol < 16) {
      all.push(symbol);
      continue;
    }
    if (symbol === 16 && !all.length) throw new RangeError("invalid repeat of code lengths");
    const length = symbol === 16 ? all.at(-1) : 0;
    const times = symbol === 16 ? 3 + input.take(2) : symbol === 17 ? 3 + input.take(3) : 11 + input.take(7); // prettier-ignore
    for (let k = 0; k < times; k++) all.push(length);
  }
  if (all.length > literals + distances || !all[END]) {
    throw new RangeError("invalid repeat of code lengths");
  }
  return [tableOf(all.slice(0, literals)), tableOf(all.slice(literals))];
}

function copyStored(input, made) {
  Object.assign(input, { held: 0, count: 0 });
  const [length, check] = [input.take(16), input.take(16)];
  if (length !== (check ^ 0xffff)) throw new RangeError("invalid stored block lengths");
  for (let k = 0; k < length; k++) write(made, input.take(8));
}

function copyCoded(input, made, literals, distances) {
  for (;;) {
    const symbol = input.symbol(literals);
    if (symbol === END) return;
    if (symbol < END) {
      write(made, symbol);
      continue;
    }
    const k = symbol - END - 1;
    if (k >= LENGTHS.length) throw new RangeError("invalid length");
    const length = LENGTHS[k] + input.take(LENGTH_BITS[k]);
    const d = input.symbol(distances);
    if (d >= DISTANCES.length) throw new RangeError("invalid distance");
    const distance = DISTANCES[d] + input.take(d < 2 ? 0 : (d >> 1) - 1);
    if (distance > made.length) throw new RangeError("invalid distance too far back");
    for (let i = 0; i < length; i++) write(made, made.bytes[made.length - distance]);
  }
}

function write(made, byte) {
  if (made.length === made.bytes.length) throw new RangeError(OTHER_SIZE);
  made.bytes[made.length++] = byte;
}
