// Calls of the compiled core, WebAssembly, on typed arrays; and its entropy decoder.
import { FormatError } from "./errors.mjs";
import { Heap } from "./heap.mjs";

const CORRUPT = 1;
const INVALID = 2;
// Bytes of `dm_coder` and of `dm_mixer`, and where the former has its position.
const CODER = 104;
const POSITION = 40;
const MIXER = 96;

/** Array that a call fills in; the call also gets what is in it. */
export const out = (array) => ({ array, isOut: true, isWide: isWide(array) });
/** Int32Array that is handed over as it is, and one that a call fills in. */
export const shorts = (array) => ({ array });
export const shortsOut = (array) => ({ array, isOut: true });
/** Number that is handed over as a double. */
export const real = (number) => ({ real: number });
/** Memory of so many numbers of 64 bits, of any value. */
export const room = (count) => ({ room: count });
/** Address of what a call made, or was given, before. */
export const at = (address) => ({ address });
/** Place for a number that a call sets. */
export const place = () => ({ value: 0n });

// Indices are of 32 bits here, and of 64 in the core.
const isWide = (array) => array instanceof Int32Array;
const asArray = (argument) =>
  ArrayBuffer.isView(argument) ? { array: argument, isWide: isWide(argument) } : argument;

/** Return a module: of its bytes, of a Response of them, of a promise of either, or itself. */
export async function compiled(source) {
  let given = await source;
  if (typeof Response !== "undefined" && given instanceof Response) given = await given.arrayBuffer();
  return given instanceof WebAssembly.Module ? given : WebAssembly.compile(given);
}

/** Return a core: an instance of its own of what `compiled` takes. */
export async function loadCore(source) {
  const { exports } = await WebAssembly.instantiate(await compiled(source));
  return new Core(exports);
}

/** The core: calls of its functions, and its models by name. */
export class Core {
  constructor(exports) {
    this.exports = exports;
    this.heap = new Heap(exports.memory, exports.__heap_base.value);
    this.models = new Map();
    this.names = new Map();
  }

  /** Bytes of the memory of the core, until something else is allocated. */
  bytes(address, size) {
    return new Uint8Array(this.exports.memory.buffer, address, size);
  }

  /** Return what `run` returns; it gets a function that allocates memory, which is freed then. */
  withMemory(run) {
    const taken = [];
    try {
      return run((size) => {
        taken.push(this.heap.allocate(size));
        return taken[taken.length - 1];
      });
    } finally {
      taken.forEach((address) => this.heap.release(address));
    }
  }

  /**
   * Call a function; return its status, 0 or that of a corrupt stream.
   *
   * An argument is a number, of 64 bits; a typed array, whose Int32s are handed over as numbers of
   * 64 bits; or what `out`, `shorts`, `shortsOut`, `real`, `room`, `at` and `place` make.
   */
  call(name, ...all) {
    return this.withMemory((allocate) => {
      const given = all.map(asArray);
      const values = given.map((argument) => this.#allocated(argument, allocate));
      given.forEach((argument, i) => this.#write(argument, values[i]));
      const status = this.exports[name](...values);
      if (status === INVALID) throw new Error(`${name}: arguments that contradict each other`);
      given.forEach((argument, i) => this.#read(argument, values[i]));
      return status;
    });
  }

  #allocated(argument, allocate) {
    if (typeof argument === "number") return BigInt(argument);
    if (typeof argument === "bigint") return argument;
    if (argument.real !== undefined) return argument.real;
    if (argument.address !== undefined) return argument.address;
    if (argument.value !== undefined) return allocate(8);
    if (argument.room !== undefined) return allocate(8 * argument.room);
    return allocate(argument.array.byteLength * (argument.isWide ? 2 : 1));
  }

  #write({ array, isWide: wide }, address) {
    if (wide) {
      const words = new Int32Array(this.exports.memory.buffer, address, 2 * array.length);
      for (let i = 0; i < array.length; i++) {
        words[2 * i] = array[i];
        words[2 * i + 1] = array[i] >> 31;
      }
    } else if (array) {
      this.bytes(address, array.byteLength).set(
        new Uint8Array(array.buffer, array.byteOffset, array.byteLength),
      );
    }
  }

  #read(argument, address) {
    const { array, isOut, isWide: wide } = argument;
    if (isOut && wide) {
      const words = new Int32Array(this.exports.memory.buffer, address, 2 * array.length);
      for (let i = 0; i < array.length; i++) array[i] = words[2 * i];
    } else if (isOut) {
      const copy = this.bytes(address, array.byteLength);
      new Uint8Array(array.buffer, array.byteOffset, array.byteLength).set(copy);
    } else if (argument.value !== undefined) {
      argument.value = new BigInt64Array(this.exports.memory.buffer, address, 1)[0];
    }
  }

  /** Return whether a call that decodes went well; the stream is corrupt if not. */
  good(name, ...given) {
    return this.call(name, ...given) !== CORRUPT;
  }

  /** Return a number of the core by its name. */
  constant(name) {
    if (!this.names.has(name)) {
      const found = place();
      this.#named("dm_find_constant", name, (address) => {
        if (this.call("dm_find_constant", at(address), found)) throw new Error(name);
      });
      this.names.set(name, Number(found.value));
    }
    return this.names.get(name);
  }

  /** Return a model of the core: its slots, and the (count, inputs, limit) of its mixers. */
  model(name) {
    if (!this.models.has(name)) {
      this.#named("dm_find_model", name, (address) => {
        const found = this.exports.dm_find_model(address);
        if (!found) throw new Error(name);
        const view = new DataView(this.exports.memory.buffer, found, 32);
        const kinds = view.getUint32(16, true);
        const count = Number(view.getBigInt64(24, true));
        this.models.set(name, {
          slots: Number(view.getBigInt64(8, true)),
          kinds: Int32Array.from(new Int32Array(this.exports.memory.buffer, kinds, 3 * count)),
        });
      });
    }
    return this.models.get(name);
  }

  #named(name, text, run) {
    this.withMemory((allocate) => {
      const address = allocate(text.length + 1);
      this.bytes(address, text.length + 1).set([...text].map((c) => c.charCodeAt(0)).concat(0));
      run(address);
    });
  }

  /**
   * Return what `run` reads with the decoder that it is given, and check that the stream ends there.
   *
   * `offset` is the position of the stream in its section.
   */
  decode(model, stream, run, offset = 0) {
    return this.withMemory((allocate) => {
      const { slots, kinds } = model;
      let mixers = 0;
      for (let i = 0; i < kinds.length; i += 3) mixers += kinds[i];
      const places = [CODER, 4 * slots, MIXER * mixers, kinds.byteLength, stream.length].map(allocate);
      const [coder, slotsAt, mixersAt, kindsAt, data] = places;
      new Int32Array(this.exports.memory.buffer, kindsAt, kinds.length).set(kinds);
      this.bytes(data, stream.length).set(stream);
      const memory = [at(slotsAt), slots, at(mixersAt), mixers, at(kindsAt), kinds.length / 3];
      this.call("dm_start", at(coder), ...memory, at(data), stream.length, 1);
      const result = run(at(coder));
      this.#checkEnd(coder, stream, offset);
      return result;
    });
  }

  #checkEnd(coder, stream, offset) {
    const size = stream.length;
    const view = new DataView(this.exports.memory.buffer, coder, CODER);
    const position = Number(view.getBigInt64(POSITION, true));
    if (size && stream[size - 1] === 0) {
      throw new FormatError("a zero byte at the end of a stream", offset + size - 1);
    }
    if (position < size || !this.exports.dm_is_finished(coder)) {
      const end = offset + Math.min(position, size);
      throw new FormatError("a stream that does not end where it should", end);
    }
  }
}
