// Calls of the core, made again in WebAssembly: `node replay.mjs MODULE CALLS`.
//
// A line of CALLS is a list of calls of one file, which share coders. What each returns, and what is
// in its arrays afterwards, has to be what it was: the process fails otherwise.
import assert from "node:assert/strict";
import { createReadStream } from "node:fs";
import { readFile } from "node:fs/promises";
import { createInterface } from "node:readline";
import { WASI } from "node:wasi";

const [, , module, calls] = process.argv;
const wasi = new WASI({ version: "preview1" });
const compiled = await WebAssembly.compile(await readFile(module));
const { exports } = await WebAssembly.instantiate(compiled, wasi.getImportObject());
wasi.initialize({ exports });

const STRUCT = 4096; // bytes for a struct of any kind

function allocate(size) {
  const at = exports.malloc(Math.max(size, 8));
  assert(at, `no memory for ${size} bytes`);
  return at;
}

const memory = (at, size) => Buffer.from(exports.memory.buffer, at, size);

function replay(call, kept) {
  const freed = [];
  const checks = [];
  const values = call.arguments.map((argument) => {
    if ("integer" in argument) return BigInt(argument.integer);
    if ("float" in argument) return argument.float;
    if ("kept" in argument) {
      // Of a coder or a front: it lives as long as the file.
      if (!kept.has(argument.kept)) {
        const at = allocate(argument.size ?? STRUCT);
        if (argument.before) memory(at, argument.size).write(argument.before, "base64");
        kept.set(argument.kept, at);
      }
      return kept.get(argument.kept);
    }
    const before = Buffer.from(argument.before, "base64");
    const at = allocate(before.length);
    before.copy(memory(at, before.length));
    freed.push(at);
    checks.push([at, argument.after]);
    return at;
  });
  const result = exports[call.name](...values);
  assert.equal(String(result ?? 0), call.result, `${call.name}: what it returns`);
  for (const [at, after] of checks) {
    const size = Buffer.byteLength(after, "base64");
    assert.equal(memory(at, size).toString("base64"), after, `${call.name}: an array`);
  }
  freed.forEach((at) => exports.free(at));
}

let count = 0;
for await (const line of createInterface({ input: createReadStream(calls) })) {
  const kept = new Map();
  for (const call of JSON.parse(line)) {
    replay(call, kept);
    count += 1;
  }
  kept.forEach((at) => exports.free(at));
}
console.log(count);
