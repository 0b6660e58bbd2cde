// Heap of a memory of WebAssembly: what is free of it, in ranges, and what is taken.
import { LimitError } from "./errors.mjs";

const ALIGNED = 16;
const PAGE = 65536;

/** Heap of a memory, from an address on; it grows where it has to. */
export class Heap {
  constructor(memory, base) {
    this.memory = memory;
    const start = Math.ceil(base / ALIGNED) * ALIGNED;
    this.free = [[start, memory.buffer.byteLength]];
    this.taken = new Map();
  }

  /** Return the address of so many bytes, of any value. */
  allocate(size) {
    const wanted = Math.ceil(Math.max(size, 1) / ALIGNED) * ALIGNED;
    let k = this.free.findIndex(([start, end]) => end - start >= wanted);
    if (k < 0) k = this.#grown(wanted);
    const range = this.free[k];
    const [address, end] = range;
    if (end - address === wanted) this.free.splice(k, 1);
    else range[0] += wanted;
    this.taken.set(address, wanted);
    return address;
  }

  /** Add pages at the end until so many bytes are free there; return the last range. */
  #grown(wanted) {
    const end = this.memory.buffer.byteLength;
    const last = this.free.at(-1);
    const left = last && last[1] === end ? end - last[0] : 0;
    // A few pages more each time: growing may copy.
    const pages = Math.ceil((wanted - left) / PAGE) + 16;
    try {
      this.memory.grow(pages);
    } catch {
      throw new LimitError(`no memory for ${wanted} bytes more`);
    }
    this.#release(end, pages * PAGE);
    return this.free.length - 1;
  }

  /** Give back what `allocate` returned. */
  release(address) {
    const size = this.taken.get(address);
    this.taken.delete(address);
    this.#release(address, size);
  }

  #release(address, size) {
    const { free } = this;
    let k = free.findIndex(([start]) => start > address);
    if (k < 0) k = free.length;
    free.splice(k, 0, [address, address + size]);
    for (const i of [k, k - 1]) {
      if (i >= 0 && i + 1 < free.length && free[i][1] === free[i + 1][0]) {
        free[i][1] = free[i + 1][1];
        free.splice(i + 1, 1);
      }
    }
  }
}
