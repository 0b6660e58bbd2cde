// Calls of the core, made again in WebAssembly: `node replay.mjs MODULE CALLS`.
//
// A line of CALLS is a list of calls of one file, which share coders. What each returns, and what is
// in its arrays afterwards, has to be what it was: the process fails otherwise.
import assert from "node:assert/strict";
import { createReadStream } from "node:fs";
import { readFile } from "node:fs/promises";
import { createInterface } from "node:readline";
import { Heap } from "../../src/web/decoder/heap.mjs";

const [, , module, calls] = process.argv;
const { instance } = await WebAssembly.instantiate(await readFile(module));
const { exports } = instance;
const heap = new Heap(exports.memory, exports.__heap_base.value);

const STRUCT = 4096; // bytes for a struct of any kind

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
        const at = heap.allocate(argument.size ?? STRUCT);
        if (argument.before) memory(at, argument.size).write(argument.before, "base64");
        kept.set(argument.kept, at);
      }
      return kept.get(argument.kept);
    }
    const before = Buffer.from(argument.before, "base64");
    const at = heap.allocate(before.length);
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
  freed.forEach((at) => heap.release(at));
}

let count = 0;
for await (const line of createInterface({ input: createReadStream(calls) })) {
  const kept = new Map();
  for (const call of JSON.parse(line)) {
    replay(call, kept);
    count += 1;
  }
  kept.forEach((at) => heap.release(at));
}
console.log(count);
