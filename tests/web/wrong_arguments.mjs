// Arguments that are no files, and limits that are no numbers: `node wrong_arguments.mjs PACKAGE FILE`
// prints what comes of each, a line each.
import { readFile } from "node:fs/promises";
import { pathToFileURL } from "node:url";

const [, , place, path] = process.argv;
const { createDecoder, createWorkerDecoder, inspect } = await import(
  pathToFileURL(`${place}/index.mjs`)
);
const decoder = await createDecoder();
const inWorker = await createWorkerDecoder({ worker: {} });
const bytes = new Uint8Array(await readFile(path));

const calls = {
  buffer: () => decoder.decode(bytes.buffer),
  nothing: () => decoder.decode(),
  list: () => decoder.decode([1, 2]),
  text: () => inspect("walk.dmesh"),
  frames: () => decoder.frames("walk.dmesh").next(),
  worker: () => inWorker.decode("walk.dmesh"),
  memory: () => decoder.decode(bytes, { memory: "much" }),
  maxVertices: () => decoder.decode(bytes, { maxVertices: NaN }),
};
for (const [name, call] of Object.entries(calls)) {
  try {
    await call();
    console.log(`${name}: decoded`);
  } catch (error) {
    console.log(`${name}: ${error.name}: ${error.message}`);
  }
}
