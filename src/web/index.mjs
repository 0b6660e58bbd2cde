// Decoder of .dmesh files for JavaScript, in Node and in browsers.
import { compiled, loadCore } from "./decoder/core.mjs";
import { decode, inspect as describe, Opened } from "./decoder/decode.mjs";
import { decoderIn } from "./decoder/worker_client.mjs";

export { DeltameshError, FormatError, LimitError, SolveError } from "./decoder/errors.mjs";

/** Return what a file says of itself; nothing of its mesh is decoded. */
export const inspect = (bytes) => describe(bytesOf(bytes));

/** Return bytes as a Uint8Array, which those of a buffer become. */
function bytesOf(given) {
  if (given instanceof Uint8Array) return given;
  if (given instanceof ArrayBuffer) return new Uint8Array(given);
  throw new TypeError("a Uint8Array, or an ArrayBuffer, with the bytes of a file is needed");
}

/** Return the compiled core that is beside this module. */
async function ownModule() {
  const place = new URL("./core.wasm", import.meta.url);
  if (place.protocol !== "file:") return fetch(place);
  const { readFile } = await import("node:fs/promises");
  return readFile(place);
}

/**
 * Return a decoder: `decode(bytes, options)` returns a mesh, `frames(bytes, options)` yields those of
 * a sequence, `inspect(bytes)` returns what a file says.
 *
 * `wasm` is the compiled core: its bytes, a Response of them, or a WebAssembly.Module.
 */
export async function createDecoder({ wasm = ownModule() } = {}) {
  const core = await loadCore(wasm);
  return {
    decode: (bytes, options) => decode(core, bytesOf(bytes), options),
    frames: (bytes, options) => framesOf(core, bytesOf(bytes), options),
    inspect,
  };
}

/**
 * Return a decoder in a worker: its `decode(bytes, options)` returns a promise of { mesh, about },
 * and `close()` ends it.
 *
 * `worker` is one of the browser; without one given, that of this package.
 */
export async function createWorkerDecoder({ wasm = ownModule(), worker } = {}) {
  const place = new URL("./decoder/worker.mjs", import.meta.url);
  const own = worker ?? new Worker(place, { type: "module" });
  const { decode: ask, close } = decoderIn(own, await compiled(wasm));
  return { decode: async (bytes, options) => ask(bytesOf(bytes), options), close };
}

/** Yield the meshes of a sequence; they share all arrays but those of positions and triangles. */
function* framesOf(core, bytes, options) {
  const file = new Opened(core, bytes, options);
  try {
    for (let frame = 0; frame < file.frames; frame++) yield file.mesh({ frame });
  } finally {
    file.close();
  }
}
