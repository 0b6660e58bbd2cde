// Files that the page holds, and their decoder.
import { answered } from "../decoder/worker.mjs";
import { decoderIn } from "../decoder/worker_client.mjs";

/** Return the files that the page holds: elements with their bytes as text. */
export const heldFiles = () => [...document.querySelectorAll("script.mesh")];

/** Return the bytes of a file that the page holds. */
export const bytesOf = (element) => globalThis.deltameshBytes(element.textContent);

/** Return a function that decodes bytes, in a worker where there can be one. */
export async function decoderOf(core, program) {
  const module = await WebAssembly.compile(core);
  if (program) {
    try {
      const script = URL.createObjectURL(new Blob([program], { type: "text/javascript" }));
      return decoderIn(new Worker(script), module).decode;
    } catch {
      // No workers here: the page waits while it decodes.
    }
  }
  return async (bytes, options) => {
    const [{ mesh, about, error }] = await answered({ id: 0, module, bytes, options });
    if (error) throw Object.assign(new Error(error.message), error);
    return { mesh, about };
  };
}
