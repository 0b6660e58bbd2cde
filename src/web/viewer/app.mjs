// The page: it decodes the files that it holds, draws them, and lets people look.
import { decoderOf, heldFiles } from "./held.mjs";
import { Viewer } from "./viewer.mjs";

/**
 * Start the page.
 *
 * `core` is the compiled core, its bytes; `program` the text of a script that is this program, for
 * a worker, empty where there is to be none.
 */
export async function start({ core, program }) {
  const viewer = new Viewer(await decoderOf(core, program));
  globalThis.deltameshViewer = viewer;
  await viewer.openAll(heldFiles());
  if (!heldFiles().length) viewer.controls.invite("Drop a .dmesh, OBJ or PLY file here.");
  document.body.dataset.state = "ready";
}
