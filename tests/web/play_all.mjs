// Frames of a file in any order by one that is open, and by the generator: `node play_all.mjs PACKAGE
// FILE` compares each with that of `decode`, and prints as JSON how many frames the core decoded on the
// way from each frame to the next.
import { readFile } from "node:fs/promises";
import { pathToFileURL } from "node:url";

const [, , place, path] = process.argv;
const part = (name) => import(pathToFileURL(`${place}/${name}`));
const { createDecoder } = await part("index.mjs");
const { loadCore } = await part("decoder/core.mjs");
const { Opened } = await part("decoder/decode.mjs");

const bytes = new Uint8Array(await readFile(path));
const decoder = await createDecoder();
const core = await loadCore(await readFile(`${place}/core.wasm`));
let decoded = 0;
const call = core.call.bind(core);
core.call = (name, ...given) => {
  decoded += name === "dm_turned_deltas"; // once a frame
  return call(name, ...given);
};

const text = (mesh) =>
  JSON.stringify(mesh, (_, one) => (ArrayBuffer.isView(one) ? String(one) : one));
const wanted = Array.from({ length: decoder.inspect(bytes).frames }, (_, frame) =>
  text(decoder.decode(bytes, { frame })),
);
const file = new Opened(core, bytes);
const numbers = wanted.map((_, i) => i);
const done = [];
for (const frame of [...numbers, ...numbers.toReversed(), 3, 1, 3]) {
  decoded = 0;
  if (text(file.mesh({ frame })) !== wanted[frame]) throw new Error(`frame ${frame}`);
  done.push(decoded);
}
file.close();
const played = Array.from(decoder.frames(bytes), text);
if (String(played) !== String(wanted)) throw new Error("the generator yields something else");
console.log(JSON.stringify(done));
