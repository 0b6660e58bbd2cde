// Decoding by the package of src/web: `node decode_all.mjs PACKAGE FOLDER` gets names of files on
// standard input, one a line, and prints for each what came of it as JSON; the arrays of a mesh go
// into FOLDER, a file each.
import { readFile, writeFile } from "node:fs/promises";
import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";

const [, , place, folder] = process.argv;
const { createDecoder } = await import(pathToFileURL(`${place}/index.mjs`));
const decoder = await createDecoder();

let count = 0;
async function kept(array) {
  const name = `${folder}/${count++}`;
  await writeFile(name, new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
  return { kind: array.constructor.name, file: name };
}

async function stored(value) {
  if (ArrayBuffer.isView(value)) return kept(value);
  if (value instanceof Map) return stored(Object.fromEntries(value));
  if (Array.isArray(value)) return Promise.all(value.map(stored));
  if (typeof value === "bigint") return String(value);
  if (value === null || typeof value !== "object") return value;
  const made = {};
  for (const [key, one] of Object.entries(value)) made[key] = await stored(one);
  return made;
}

for await (const line of createInterface({ input: process.stdin })) {
  const [path, memory, wanted] = line.split("\t");
  const bytes = new Uint8Array(await readFile(path));
  let result;
  try {
    const limits = memory ? { memory: Number(memory) } : {};
    const mesh = decoder.decode(bytes, { ...limits, ...(wanted ? { frame: Number(wanted) } : {}) });
    const about = decoder.inspect(bytes);
    const poses = about.poses.map(({ name }) => decoder.decode(bytes, { pose: name }));
    const further = wanted ? [] : Array.from({ length: about.frames - 1 }, (_, i) => i + 1);
    const frames = further.map((frame) => decoder.decode(bytes, { frame }));
    const [found, told] = await Promise.all([mesh, about].map(stored));
    result = { mesh: found, about: told, poses: await stored(poses), frames: await stored(frames) };
  } catch (error) {
    const { name, message, offset = null, stack } = error;
    result = { error: { name, message, offset, stack } };
  }
  console.log(JSON.stringify(result));
}
