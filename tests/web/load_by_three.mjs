// A file by the loader for three.js, and by the decoder: corner by corner they have the same.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createDecoder } from "./deltamesh/index.mjs";
import { DMESHLoader } from "./deltamesh/three/DMESHLoader.mjs";

const [, , path] = process.argv;
const geometry = await new DMESHLoader().loadAsync(path);
const decoder = await createDecoder();
const mesh = decoder.decode(new Uint8Array(await readFile(path)));

const { position } = geometry.attributes;
const count = geometry.index?.count ?? position.count;
assert.equal(count, mesh.triangles.length);
const rows = [];
for (let i = 0; i < count; i++) {
  const v = geometry.index?.array[i] ?? i;
  rows.push([...position.array.subarray(3 * v, 3 * v + 3)].join());
}
const trios = (all) => all.map((_, i) => (i % 3 ? null : all.slice(i, i + 3).join(" "))).filter(Boolean);
const own = [...mesh.triangles].map((v) =>
  [...mesh.positions.subarray(3 * v, 3 * v + 3)].map(Math.fround).join(),
);
assert.deepEqual(trios(rows).sort(), trios(own).sort());
assert.equal(
  geometry.groups.reduce((sum, group) => sum + group.count, 0),
  mesh.parts.length ? count : 0,
);
for (const attribute of Object.values(geometry.attributes)) assert.equal(attribute.count, position.count);
const hasNormals = mesh.attributes.some(({ role, has }) => role === "normal" && !has);
assert.equal(Boolean(geometry.hasComputedNormals), !hasNormals);
console.log("alike");
