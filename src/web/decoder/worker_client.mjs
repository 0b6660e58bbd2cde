// Decoder in a worker, as the one who asks sees it; `worker.mjs` is the other side.

/**
 * Return a decoder: its `decode(bytes, options)` returns a promise of { mesh, about }, `close()` ends
 * the worker.
 *
 * `module` is the compiled core, a WebAssembly.Module.
 */
export function decoderIn(worker, module) {
  const waiting = new Map();
  let next = 0;
  worker.onmessage = ({ data: { id, mesh, about, error } }) => {
    const { resolve, reject } = waiting.get(id);
    waiting.delete(id);
    if (error) reject(Object.assign(new Error(error.message), error));
    else resolve({ mesh, about });
  };
  worker.onerror = (event) => {
    waiting.forEach(({ reject }) => reject(new Error(event.message)));
    waiting.clear();
  };
  const decode = (bytes, options) =>
    new Promise((resolve, reject) => {
      const id = next++;
      waiting.set(id, { resolve, reject });
      worker.postMessage({ id, module, bytes, options });
    });
  return { decode, close: () => worker.terminate() };
}
