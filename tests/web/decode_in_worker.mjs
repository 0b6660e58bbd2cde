// Frames of a file by the decoder in a worker of the package, and by the one that is called: `node
// decode_in_worker.mjs PACKAGE FILE` prints how many different ones both give, and the error of the
// frame after the last.
import { readFile } from "node:fs/promises";
import { pathToFileURL } from "node:url";

const [, , place, path] = process.argv;
const { createDecoder, createWorkerDecoder } = await import(pathToFileURL(`${place}/index.mjs`));
const { answered } = await import(pathToFileURL(`${place}/decoder/worker.mjs`));

/** Worker whose messages are copied as those of a browser are. */
const worker = {
  async postMessage(message) {
    const [answer, transfer] = await answered(structuredClone(message));
    this.onmessage({ data: structuredClone(answer, { transfer }) });
  },
  terminate() {},
};

const bytes = new Uint8Array(await readFile(path));
const [direct, inWorker] = [await createDecoder(), await createWorkerDecoder({ worker })];
const seen = new Set();
for (let frame = 0; frame < direct.inspect(bytes).frames; frame++) {
  const { mesh } = await inWorker.decode(bytes, { frame });
  const text = String(mesh.positions);
  if (text !== String(direct.decode(bytes, { frame }).positions)) throw new Error(`frame ${frame}`);
  seen.add(text);
}
try {
  await inWorker.decode(bytes, { frame: seen.size });
} catch ({ name, message }) {
  console.log(seen.size, `${name}: ${message}`);
}
inWorker.close();
