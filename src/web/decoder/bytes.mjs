// Bytes from anywhere: numbers, strings and tables, none of which reaches beyond the end.
import { FormatError } from "./errors.mjs";
import { VARINT_MAX_BYTES } from "./layout.mjs";

const SIZES = { u8: 1, u16: 2, i16: 2, u32: 4, u64: 8, f32: 4, f64: 8, bytes8: 8 };

/** Return `size` bytes from `position` on, or refuse at the byte where they run out. */
export function take(bytes, position, size) {
  const left = Math.max(bytes.length - position, 0);
  if (size > left) {
    throw new FormatError(`truncated: ${size} bytes are needed, ${left} are left`, bytes.length);
  }
  return bytes.subarray(position, position + size);
}

/** Read an unsigned LEB128 number in its shortest form; return it and the position after it. */
export function readVarint(bytes, position) {
  let value = 0;
  for (let i = 0; i < VARINT_MAX_BYTES; i++) {
    const byte = take(bytes, position + i, 1)[0];
    value += (byte & 0x7f) * 2 ** (7 * i);
    if (byte < 0x80) {
      if (byte === 0 && i > 0) {
        throw new FormatError("a varint that is longer than it needs to be", position);
      }
      return [value, position + i + 1];
    }
  }
  throw new FormatError(`a varint of more than ${VARINT_MAX_BYTES} bytes`, position);
}

/** Return how many bytes a varint takes. */
export function varintSize(value) {
  let size = 1;
  for (let left = value; left >= 128; left = Math.floor(left / 128)) size++;
  return size;
}

/** Read a number or string of a type of a byte table; return it and the position after it. */
export function readField(bytes, position, type) {
  if (type === "varint") return readVarint(bytes, position);
  if (type === "string") return readString(bytes, position);
  const size = SIZES[type];
  const taken = take(bytes, position, size);
  const view = new DataView(taken.buffer, taken.byteOffset, size);
  const values = {
    u8: () => view.getUint8(0),
    u16: () => view.getUint16(0, true),
    i16: () => view.getInt16(0, true),
    u32: () => view.getUint32(0, true),
    u64: () => view.getBigUint64(0, true),
    f32: () => view.getFloat32(0, true),
    f64: () => view.getFloat64(0, true),
    bytes8: () => taken,
  };
  return [values[type](), position + size];
}

function readString(bytes, position) {
  const start = position + 1;
  const end = start + take(bytes, position, 1)[0];
  const [text, fault] = decoded(take(bytes, start, end - start), false);
  if (fault >= 0) throw new FormatError("a string that is not UTF-8", start + fault);
  return [text, end];
}

/** Return the values of a byte table, the offset of each, and the position after the last. */
export function readFields(bytes, position, fields) {
  const values = {};
  const offsets = {};
  for (const [name, type] of fields) {
    offsets[name] = position;
    [values[name], position] = readField(bytes, position, type);
  }
  return [values, offsets, position];
}

/** Return the values and the offsets of a payload that is a byte table and nothing else. */
export function readTable(payload, fields) {
  const [values, offsets, end] = readFields(payload, 0, fields);
  if (end < payload.length) {
    throw new FormatError(`${payload.length - end} bytes follow the last field`, end);
  }
  return [values, offsets];
}

/**
 * Return the text that bytes of UTF-8 stand for, and where it is none, -1 if it is.
 *
 * With `surrogates`, these may be spelled like other code points.
 */
export function decoded(bytes, surrogates) {
  const units = [];
  for (let i = 0; i < bytes.length; ) {
    const lead = bytes[i];
    const more = lead < 0x80 ? 0 : lead < 0xc2 ? -1 : lead < 0xe0 ? 1 : lead < 0xf0 ? 2 : 3;
    if (more < 0 || lead > 0xf4) return ["", i];
    let code = more ? lead & (0x3f >> more) : lead;
    for (let k = 1; k <= more; k++) {
      if ((bytes[i + k] & 0xc0) !== 0x80) return ["", i];
      code = (code << 6) | (bytes[i + k] & 0x3f);
    }
    const isSurrogate = code >= 0xd800 && code < 0xe000;
    const least = [0, 0x80, 0x800, 0x10000][more];
    if (code < least || code > 0x10ffff || (isSurrogate && !surrogates)) return ["", i];
    units.push(code);
    i += more + 1;
  }
  let text = "";
  for (let i = 0; i < units.length; i += 4096) {
    text += String.fromCodePoint(...units.slice(i, i + 4096));
  }
  return [text, -1];
}
