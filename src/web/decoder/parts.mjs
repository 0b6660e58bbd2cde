// Section PART: parts, names, transforms and metadata of a mesh (SPEC.md 5.15).
import { unpacked } from "./blocks.mjs";
import { readVarint, take } from "./bytes.mjs";
import { out, room } from "./core.mjs";
import { FormatError, located } from "./errors.mjs";
import { largest } from "./integers.mjs";
import { decodeLabels } from "./labels.mjs";
import { readTexts } from "./texts.mjs";

const NUMBERS = 16;
const BYTES = 8 * NUMBERS;
const IDENTITY = Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);

/** Return the text and the divisions into parts of a file of the polygons of these domains. */
export function decodeParts(core, payload, domains) {
  let [texts, at] = readTexts(payload);
  const count = domains.polygons.offsets.length - 1;
  const divisions = [];
  for (const division of texts.divisions) {
    let [stream, start, end] = readStream(payload, at);
    let labels = new Int32Array(count); // as an empty stream has them
    if (stream.length) {
      labels = located(start, "", () => decodeLabels(core, stream, domains.faces));
    }
    [stream, start, at] = readStream(payload, end);
    const order = decodeOrder(core, stream, start, division, largest(labels) + 1);
    const ofFace = labels.map((label) => order[label]);
    let transforms = null;
    if (division.moved) {
      [transforms, at] = readTransforms(payload, at, division.names.length);
    }
    divisions.push({ kind: division.kind, names: division.names, ofFace, transforms });
  }
  if (at < payload.length) throw new FormatError("bytes after the last parts", at);
  const text = Int32Array.from(texts.raw);
  return { text, divisions, metadata: texts.metadata, lost: texts.lost };
}

function readStream(payload, at) {
  const [size, start] = readVarint(payload, at);
  return [take(payload, start, size), start, start + size];
}

/** Return the part that each label stands for, -1 for none. */
function decodeOrder(core, stream, start, { kind, names, partly }, labels) {
  const count = names.length + Number(partly);
  if (labels > count) {
    throw new FormatError(`${labels} labels for ${count} parts of kind ${kind}`, start);
  }
  const order = new Int32Array(labels);
  const run = (coder) => {
    const memory = [room(count + 1), room(count + 1)];
    if (!core.good("dm_code_choices", coder, out(order), labels, count, ...memory)) {
      throw new FormatError("non-canonical part number: the next part was skipped", start);
    }
  };
  core.decode(core.model("choices"), stream, run, start);
  if (partly && !order.includes(0)) {
    throw new FormatError("no face without a part, though some are announced", start);
  }
  return order.map((number) => number - Number(partly));
}

/** Return the numbers of the matrices of parts, row by row, and the position after them. */
function readTransforms(payload, at, count) {
  const size = Math.ceil(count / 8);
  const [data, end] = unpacked(payload, at, size + count * BYTES);
  const bit = (i) => (data[i >> 3] >> (i & 7)) & 1;
  const moved = [];
  for (let i = 0; i < 8 * Math.min(size, data.length); i++) if (bit(i)) moved.push(i);
  if (data.length !== size + moved.length * BYTES || moved.at(-1) >= count) {
    throw new FormatError("transform count differs from the part count", at);
  }
  const numbers = new Float64Array(count * NUMBERS);
  const bytes = new Uint8Array(numbers.buffer);
  const identity = new Uint8Array(IDENTITY.buffer);
  for (let i = 0; i < count; i++) bytes.set(identity, i * BYTES);
  moved.forEach((part, k) => {
    const matrix = bytes.subarray(part * BYTES, (part + 1) * BYTES);
    for (let j = 0; j < BYTES; j++) matrix[j] = data[size + j * moved.length + k];
    if (matrix.every((byte, j) => byte === identity[j])) {
      throw new FormatError("non-canonical transform: identity stored explicitly", at);
    }
  });
  return [numbers, end];
}
