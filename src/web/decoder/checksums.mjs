// Checksums: CRC-32 as in zlib and PNG, and BLAKE2b with a digest of 8 bytes (RFC 7693).

const CRC = Uint32Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; k++) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c;
});

/** Return the CRC-32 of bytes. */
export function crc32(bytes) {
  let c = 0xffffffff;
  for (let i = 0; i < bytes.length; i++) c = CRC[(c ^ bytes[i]) & 0xff] ^ (c >>> 8);
  return (c ^ 0xffffffff) >>> 0;
}

// The initial state, those of SHA-512, as pairs of words, the low one of each first.
const START = Int32Array.of(
  0xf3bcc908, 0x6a09e667, 0x84caa73b, 0xbb67ae85, 0xfe94f82b, 0x3c6ef372, 0x5f1d36f1, 0xa54ff53a,
  0xade682d1, 0x510e527f, 0x2b3e6c1f, 0x9b05688c, 0xfb41bd6b, 0x1f83d9ab, 0x137e2179, 0x5be0cd19,
);
const ORDER = [
  [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15],
  [14, 10, 4, 8, 9, 15, 13, 6, 1, 12, 0, 2, 11, 7, 5, 3],
  [11, 8, 12, 0, 5, 2, 15, 13, 10, 14, 3, 6, 7, 1, 9, 4],
  [7, 9, 3, 1, 13, 12, 11, 14, 2, 6, 5, 10, 4, 0, 15, 8],
  [9, 0, 5, 7, 2, 4, 10, 15, 14, 1, 11, 12, 6, 8, 3, 13],
  [2, 12, 6, 10, 0, 11, 8, 3, 4, 13, 7, 5, 15, 14, 1, 9],
  [12, 5, 1, 15, 14, 13, 4, 10, 0, 7, 6, 3, 9, 2, 8, 11],
  [13, 11, 7, 14, 12, 1, 3, 9, 5, 0, 15, 4, 8, 6, 2, 10],
  [6, 15, 14, 9, 11, 3, 0, 8, 12, 2, 13, 7, 1, 4, 10, 5],
  [10, 2, 8, 4, 7, 6, 1, 5, 15, 11, 9, 14, 3, 12, 13, 0],
];
// Rows of four columns, and of four diagonals, of the state.
const MIXED = [
  [0, 4, 8, 12],
  [1, 5, 9, 13],
  [2, 6, 10, 14],
  [3, 7, 11, 15],
  [0, 5, 10, 15],
  [1, 6, 11, 12],
  [2, 7, 8, 13],
  [3, 4, 9, 14],
];
// For each round and each mixing, words of the state and of the block: twice their numbers.
const STEPS = Uint8Array.from(
  Array.from({ length: 12 }, (_, round) =>
    MIXED.map((four, k) => [
      ...four.map((word) => 2 * word),
      2 * ORDER[round % 10][2 * k],
      2 * ORDER[round % 10][2 * k + 1],
    ]),
  ).flat(2),
);
const BLOCK = 128;

/** BLAKE2b of what it is given, 8 bytes long. */
export class Blake2b {
  constructor() {
    this.state = START.slice();
    this.state[0] ^= 0x01010000 ^ 8; // no key, a digest of 8 bytes
    this.block = new Int32Array(BLOCK / 4);
    this.filled = 0;
    this.bytes = 0;
    this.v = new Int32Array(32);
  }

  /** Take words of 32 bits, the bytes of each from the lowest on. */
  update(words) {
    for (let i = 0; i < words.length; ) {
      if (this.filled === BLOCK / 4) this.#compress(false);
      const count = Math.min(BLOCK / 4 - this.filled, words.length - i);
      for (let k = 0; k < count; k++) this.block[this.filled + k] = words[i + k];
      this.filled += count;
      this.bytes += 4 * count;
      i += count;
    }
  }

  /** Return the digest; nothing may be taken then. */
  digest() {
    this.block.fill(0, this.filled);
    this.#compress(true);
    return new Uint8Array(this.state.slice(0, 2).buffer);
  }

  #compress(last) {
    const { v, state, block: m } = this;
    v.set(state);
    v.set(START, 16);
    v[24] ^= this.bytes | 0;
    v[25] ^= Math.floor(this.bytes / 2 ** 32);
    if (last) {
      v[28] = ~v[28];
      v[29] = ~v[29];
    }
    for (let s = 0; s < STEPS.length; s += 6) {
      mix(v, m, STEPS[s], STEPS[s + 1], STEPS[s + 2], STEPS[s + 3], STEPS[s + 4], STEPS[s + 5]);
    }
    for (let i = 0; i < 16; i++) state[i] ^= v[i] ^ v[i + 16];
    this.filled = 0;
  }
}

function mix(v, m, a, b, c, d, x, y) {
  let a0 = v[a], a1 = v[a + 1], b0 = v[b], b1 = v[b + 1]; // prettier-ignore
  let c0 = v[c], c1 = v[c + 1], d0 = v[d], d1 = v[d + 1]; // prettier-ignore
  let low = (a0 >>> 0) + (b0 >>> 0) + (m[x] >>> 0);
  a1 = (a1 + b1 + m[x + 1] + Math.floor(low / 4294967296)) | 0;
  a0 = low | 0;
  let t = d0 ^ a0;
  d0 = d1 ^ a1;
  d1 = t;
  low = (c0 >>> 0) + (d0 >>> 0);
  c1 = (c1 + d1 + (low > 4294967295 ? 1 : 0)) | 0;
  c0 = low | 0;
  b0 ^= c0;
  b1 ^= c1;
  t = (b0 >>> 24) | (b1 << 8);
  b1 = (b1 >>> 24) | (b0 << 8);
  b0 = t;
  low = (a0 >>> 0) + (b0 >>> 0) + (m[y] >>> 0);
  a1 = (a1 + b1 + m[y + 1] + Math.floor(low / 4294967296)) | 0;
  a0 = low | 0;
  d0 ^= a0;
  d1 ^= a1;
  t = (d0 >>> 16) | (d1 << 16);
  d1 = (d1 >>> 16) | (d0 << 16);
  d0 = t;
  low = (c0 >>> 0) + (d0 >>> 0);
  c1 = (c1 + d1 + (low > 4294967295 ? 1 : 0)) | 0;
  c0 = low | 0;
  b0 ^= c0;
  b1 ^= c1;
  t = (b0 << 1) | (b1 >>> 31);
  b1 = (b1 << 1) | (b0 >>> 31);
  b0 = t;
  v[a] = a0;
  v[a + 1] = a1;
  v[b] = b0;
  v[b + 1] = b1;
  v[c] = c0;
  v[c + 1] = c1;
  v[d] = d0;
  v[d + 1] = d1;
}
