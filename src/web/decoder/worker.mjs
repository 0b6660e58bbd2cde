// Worker that decodes: it gets { id, module, bytes, options } and answers { id, mesh, about }, or an
// error by its name, message and offset.
import { loadCore } from "./core.mjs";
import { decode, inspect } from "./decode.mjs";
import { DeltameshError } from "./errors.mjs";

/** Return what to answer to a message, and the buffers that go with it. */
export async function answered({ id, module, bytes, options }) {
  try {
    const about = inspect(bytes);
    const mesh = decode(await loadCore(module), bytes, options);
    const arrays = [mesh, ...mesh.attributes, ...mesh.parts].flatMap(Object.values);
    const buffers = arrays.filter((one) => ArrayBuffer.isView(one)).map((one) => one.buffer);
    return [{ id, mesh, about }, [...new Set(buffers)]];
  } catch (error) {
    const { name, message, offset = null } = error;
    return [{ id, error: { name, message, offset, isOurs: error instanceof DeltameshError } }, []];
  }
}

if (typeof WorkerGlobalScope !== "undefined" && globalThis instanceof WorkerGlobalScope) {
  addEventListener("message", async ({ data }) => postMessage(...(await answered(data))));
}
