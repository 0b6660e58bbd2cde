// Worker that decodes: it gets { id, module, bytes, options } and answers { id, mesh, about }, or an
// error by its name, message and offset.
import { loadCore } from "./core.mjs";
import { inspect, Opened } from "./decode.mjs";
import { DeltameshError } from "./errors.mjs";

// Sequences that stay open, so that the next frame of each costs no more than that.
const MOST = 4;
const open = [];

/** Return what to answer to a message, and the buffers that go with it. */
export async function answered({ id, module, bytes, options }) {
  try {
    const file = await opened(module, bytes, options);
    const mesh = file.mesh(options);
    const answer = { id, mesh, about: inspect(bytes) };
    if (file.frames > 1) return [answer, []]; // arrays are those of the next frame, too
    file.close();
    const arrays = [mesh, ...mesh.attributes, ...mesh.parts].flatMap(Object.values);
    const buffers = arrays.filter((one) => ArrayBuffer.isView(one)).map((one) => one.buffer);
    return [answer, [...new Set(buffers)]];
  } catch (error) {
    const { name, message, offset = null } = error;
    return [{ id, error: { name, message, offset, isOurs: error instanceof DeltameshError } }, []];
  }
}

/** Return a file of these bytes and limits, one that is open if there is; a sequence stays open. */
async function opened(module, bytes, { maxVertices, memory } = {}) {
  const at = open.findIndex(
    (one) =>
      one.limits === `${maxVertices} ${memory}` &&
      one.bytes.length === bytes.length &&
      one.bytes.every((byte, i) => byte === bytes[i]),
  );
  if (at >= 0) open.unshift(...open.splice(at, 1));
  else {
    const file = new Opened(await loadCore(module), bytes, { maxVertices, memory });
    if (file.frames < 2) return file;
    open.unshift({ file, bytes, limits: `${maxVertices} ${memory}` });
    open.splice(MOST);
  }
  return open[0].file;
}

if (typeof WorkerGlobalScope !== "undefined" && globalThis instanceof WorkerGlobalScope) {
  addEventListener("message", async ({ data }) => postMessage(...(await answered(data))));
}
