// Codes of Zstandard (RFC 8878, 4): tabled asymmetric numeral systems, and Huffman codes.

const LONGEST_HUFFMAN = 11;

/** Reader of bits from the end of a stream to its beginning; beyond it there are zeros. */
export class BackwardBits {
  constructor(data) {
    const last = data[data.length - 1];
    if (!last) throw new RangeError("a stream without its end");
    this.data = data;
    this.left = 8 * data.length - 8 + 31 - Math.clz32(last);
  }

  /** Return the next bits, the highest first, without taking them. */
  look(count) {
    let bits = 0;
    for (let got = 0; got < count; ) {
      const end = this.left - got;
      if (end <= 0) return bits * 2 ** (count - got);
      const inByte = ((end - 1) & 7) + 1;
      const size = Math.min(inByte, count - got);
      const byte = this.data[(end - 1) >> 3] >> (inByte - size);
      bits = bits * 2 ** size + (byte & ((1 << size) - 1));
      got += size;
    }
    return bits;
  }

  skip(count) {
    this.left -= count;
    if (this.left < 0) throw new RangeError("a stream that ends too early");
  }

  take(count) {
    const bits = this.look(count);
    this.skip(count);
    return bits;
  }
}

/** Return the probabilities of symbols, their accuracy, and how many bytes they take. */
export function readDistribution(data, mostAccuracy, mostSymbol) {
  let position = 0;
  const take = (count) => {
    let bits = 0;
    for (let k = 0; k < count; k++, position++) {
      if (position >> 3 >= data.length) throw new RangeError("truncated");
      bits |= ((data[position >> 3] >> (position & 7)) & 1) << k;
    }
    return bits;
  };
  const accuracy = take(4) + 5;
  if (accuracy > mostAccuracy) throw new RangeError("too accurate probabilities");
  const found = [];
  let left = (1 << accuracy) + 1;
  while (left > 1 && found.length <= mostSymbol) {
    const bits = 32 - Math.clz32(left);
    const small = (1 << bits) - 1 - left;
    let value = take(bits - 1);
    if (value >= small) {
      value |= take(1) << (bits - 1);
      if (value >= 1 << (bits - 1)) value -= small;
    }
    found.push(value - 1);
    left -= Math.abs(value - 1);
    if (value !== 1) continue;
    for (let more = 3; more === 3; ) {
      more = take(2);
      for (let k = 0; k < more; k++) found.push(0);
    }
  }
  if (left !== 1 || found.length > mostSymbol + 1) throw new RangeError("invalid probabilities");
  return [found, accuracy, (position + 7) >> 3];
}

/** Return the decoding table of probabilities. */
export function tableOfDistribution(distribution, accuracy) {
  const size = 1 << accuracy;
  const symbols = new Uint8Array(size);
  const next = distribution.map((p) => (p < 0 ? 1 : p));
  let high = size;
  distribution.forEach((p, symbol) => {
    if (p < 0) symbols[--high] = symbol;
  });
  const step = (size >> 1) + (size >> 3) + 3;
  let at = 0;
  distribution.forEach((p, symbol) => {
    for (let k = 0; k < p; k++) {
      symbols[at] = symbol;
      do at = (at + step) & (size - 1);
      while (at >= high);
    }
  });
  const bits = new Uint8Array(size);
  const bases = new Uint16Array(size);
  symbols.forEach((symbol, state) => {
    const number = next[symbol]++;
    bits[state] = accuracy - (31 - Math.clz32(number));
    bases[state] = (number << bits[state]) - size;
  });
  return { accuracy, symbols, bits, bases };
}

/** Return the table of a Huffman code, and how many bytes its description takes. */
export function readHuffman(data) {
  if (!data.length) throw new RangeError("truncated");
  const [header] = data;
  let weights, used;
  if (header < 128) {
    used = 1 + header;
    if (used > data.length) throw new RangeError("truncated");
    weights = readWeights(data.subarray(1, used));
  } else {
    const count = header - 127;
    used = 1 + ((count + 1) >> 1);
    if (used > data.length) throw new RangeError("truncated");
    weights = Array.from({ length: count }, (_, i) => {
      const byte = data[1 + (i >> 1)];
      return i & 1 ? byte & 15 : byte >> 4;
    });
  }
  return [tableOfWeights(weights), used];
}

/** Return weights that two states in turn have coded. */
function readWeights(data) {
  const [distribution, accuracy, at] = readDistribution(data, 6, 255);
  const table = tableOfDistribution(distribution, accuracy);
  const bits = new BackwardBits(data.subarray(at));
  const states = [bits.take(accuracy), bits.take(accuracy)];
  const weights = [];
  for (let k = 0; weights.length < 255; k ^= 1) {
    weights.push(table.symbols[states[k]]);
    const needed = table.bits[states[k]];
    if (needed > bits.left) {
      weights.push(table.symbols[states[k ^ 1]]);
      return weights;
    }
    states[k] = table.bases[states[k]] + bits.take(needed);
  }
  throw new RangeError("too many weights");
}

function tableOfWeights(weights) {
  const total = weights.reduce((sum, weight) => sum + (weight ? 2 ** (weight - 1) : 0), 0);
  const longest = total ? Math.floor(Math.log2(total)) + 1 : 0;
  const left = 2 ** longest - total;
  if (!longest || longest > LONGEST_HUFFMAN || !Number.isInteger(Math.log2(left))) {
    throw new RangeError("invalid weights");
  }
  const all = [...weights, Math.log2(left) + 1];
  const symbols = new Uint8Array(1 << longest);
  const lengths = new Uint8Array(1 << longest);
  let at = 0;
  for (let weight = 1; weight <= longest; weight++) {
    all.forEach((own, symbol) => {
      if (own !== weight) return;
      const end = at + (1 << (weight - 1));
      symbols.fill(symbol, at, end);
      lengths.fill(longest + 1 - weight, at, end);
      at = end;
    });
  }
  return { symbols, lengths, longest };
}
