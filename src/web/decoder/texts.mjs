// Text of a file: names of parts, metadata, descriptions of losses (SPEC.md 5.15).
import { unpacked } from "./blocks.mjs";
import { decoded, readVarint, take } from "./bytes.mjs";
import { FormatError } from "./errors.mjs";
import { KINDS, MAX_TEXT } from "./layout.mjs";

const [KIND, PARTLY, MOVED] = [7, 8, 16];

/** Return how many bytes of text a file says that it has. */
export function textSize({ sections }) {
  return sections.get("PART")?.read((payload) => {
    take(payload, 0, 1);
    return readVarint(payload, 1)[0];
  }) ?? 0; // prettier-ignore
}

/** Return how many parts of a file may have transforms. */
export function movedParts({ sections }) {
  const texts = sections.get("PART")?.read((payload) => readTexts(payload)[0]);
  const moved = (texts?.divisions ?? []).filter((one) => one.moved);
  return moved.reduce((count, one) => count + one.names.length, 0);
}

/** Return the text at the beginning of a payload, and the position after it. */
export function readTexts(payload) {
  const [raw, end] = unpacked(payload, 0, MAX_TEXT);
  let texts, at;
  try {
    [texts, at] = read(raw);
  } catch (error) {
    if (!(error instanceof FormatError)) throw error;
    throw new FormatError(`in the text, ${error.reason}`, 0);
  }
  if (at < raw.length) {
    throw new FormatError(`${raw.length - at} bytes follow the end of the text`, 0);
  }
  if (!texts.divisions.length && !texts.metadata.size && !texts.lost.length) {
    throw new FormatError("no parts, metadata or losses in the text", 0);
  }
  return [{ ...texts, raw }, end];
}

function read(raw) {
  let [count, at] = readVarint(raw, 0);
  const divisions = [];
  for (; count > 0; count--) {
    let one;
    [one, at] = readDivision(raw, at);
    if (divisions.some(({ kind }) => kind === one.kind)) {
      throw new FormatError(`parts of kind ${one.kind} come a second time`, at);
    }
    divisions.push(one);
  }
  [count, at] = readVarint(raw, at);
  const metadata = new Map();
  for (; count > 0; count--) {
    let key, lines;
    [key, at] = readString(raw, at);
    if (metadata.has(key)) {
      throw new FormatError(`metadata key '${key}' comes a second time`, at);
    }
    [lines, at] = readStrings(raw, at);
    metadata.set(key, lines);
  }
  const [lost, end] = readStrings(raw, at);
  return [{ divisions, metadata, lost }, end];
}

function readDivision(raw, at) {
  const [flags] = take(raw, at, 1);
  const kind = KINDS[flags & KIND];
  if (!kind) throw new FormatError(`unknown kind of parts ${flags & KIND}`, at);
  if (flags >= 2 * MOVED) throw new FormatError(`parts of kind ${kind}: reserved bits are set`, at);
  const [names, end] = readStrings(raw, at + 1);
  return [{ kind, names, partly: (flags & PARTLY) > 0, moved: (flags & MOVED) > 0 }, end];
}

function readString(raw, at) {
  const [size, start] = readVarint(raw, at);
  const [text, fault] = decoded(take(raw, start, size), true);
  if (fault >= 0) throw new FormatError("a string that is not UTF-8", at);
  return [text, start + size];
}

function readStrings(raw, position) {
  let [count, at] = readVarint(raw, position);
  const found = [];
  for (; count > 0; count--) {
    let text;
    [text, at] = readString(raw, at);
    found.push(text);
  }
  return [found, at];
}
