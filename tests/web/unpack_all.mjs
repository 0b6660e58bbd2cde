// Decompression by the modules of src/web: cases come as lines of JSON, [form, base64, size]; for
// each, the bytes in base64 or the name of the error are printed.
import { createInterface } from "node:readline";
import { inflated } from "../../src/web/decoder/inflate.mjs";
import { framed } from "../../src/web/decoder/zstandard.mjs";

const unpack = { deflate: inflated, zstandard: framed };
for await (const line of createInterface({ input: process.stdin })) {
  const [form, text, size] = JSON.parse(line);
  try {
    const bytes = unpack[form](new Uint8Array(Buffer.from(text, "base64")), size);
    console.log(`=${Buffer.from(bytes).toString("base64")}`);
  } catch (error) {
    console.log(error.name);
  }
}
