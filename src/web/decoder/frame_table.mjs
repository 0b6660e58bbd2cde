// Section FRAM: the table of the frames beyond the first (SPEC.md 5.22).
import { readField, readFields, readVarint, take, varintSize } from "./bytes.mjs";
import { Section } from "./container.mjs";
import { crc32 } from "./crc32.mjs";
import { FormatError, located, spelled } from "./errors.mjs";
import {
  CRC_SIZE,
  FRAME_CELLS,
  FRAME_CORRECTIONS,
  FRAME_FIELDS,
  FRAME_KEY,
  ID_SIZE,
  MAP_FIELDS,
  MAX_FINER,
  MAX_MAP_UNIT,
  MAX_RUN,
  SEQUENCE_FIELDS,
} from "./layout.mjs";

// A record has that many bytes or more.
const LEAST_RECORD = 42;
const ERRORS = ["rms", "max", "normal", "dihedral"];

/**
 * Return the rate of a file, 0 if that is unknown, and its further frames.
 *
 * Of these, `sections` are the streams, a Map by name, and `offset` is where the record begins.
 */
export function framesOf(container) {
  const section = container.sections.get("FRAM");
  if (!section) return { rate: 0, frames: [] };
  return section.read((payload) => readFrames(payload, section.start, container));
}

function readFrames(payload, start, { parameters, vertices }) {
  const [{ rate, count }, offsets, end] = readFields(payload, 0, SEQUENCE_FIELDS);
  if (!(Number.isFinite(rate) && rate >= 0)) {
    throw new FormatError(`a rate of ${spelled(rate)} frames a second`, offsets.rate);
  }
  if (parameters.step === 0) throw new FormatError("frames in a file of 0 bits", 0);
  if (!(count > 0 && count <= Math.floor((payload.length - end) / LEAST_RECORD))) {
    throw new FormatError(`${count} frames in ${payload.length} bytes`, offsets.count);
  }
  const sizes = [];
  let at = end;
  let size;
  for (let i = 0; i < count; i++) {
    [size, at] = readVarint(payload, at);
    sizes.push(size);
  }
  let run = 0;
  const frames = sizes.map((bytes, i) => {
    const record = take(payload, at, bytes);
    const frame = located(at, `frame ${i + 1}: `, () => {
      const found = readFrame(record, start + at, i + 1, parameters, vertices);
      run = found.isKey ? 0 : run + 1;
      if (run > MAX_RUN) throw new FormatError(`more than ${MAX_RUN} frames since a key frame`, 0);
      return found;
    });
    at += bytes;
    return frame;
  });
  if (at < payload.length) throw new FormatError("bytes after the last frame", at);
  return { rate, frames };
}

/** Return the frame in a record that begins at byte `start` of the file. */
function readFrame(record, start, index, parameters, vertices) {
  const end = record.length - CRC_SIZE;
  take(record, Math.max(end, 0), CRC_SIZE);
  const [stored] = readField(record, end, "u32");
  const inside = record.subarray(0, end);
  if (stored !== crc32(inside)) {
    throw new FormatError("the record is damaged: its checksum does not match", 0);
  }
  let [values, offsets, at] = readFields(inside, 0, FRAME_FIELDS);
  if (values.maps) {
    const [further, where, after] = readFields(inside, at, MAP_FIELDS);
    values = { ...values, ...further };
    offsets = { ...offsets, ...where };
    at = after;
  }
  for (const [name, reason] of faults(values, index, parameters, vertices)) {
    throw new FormatError(reason, offsets[name]);
  }
  const sizes = streams(parameters.method, values).map((name) => {
    const [size, after] = readVarint(inside, at);
    at = after;
    return [name, size];
  });
  const sections = new Map();
  for (const [name, size] of sizes) {
    // As if an id and a length were before it: the section then starts where the stream does.
    const offset = start + at - ID_SIZE - varintSize(size);
    sections.set(name, new Section(name, offset, take(inside, at, size)));
    at += size;
  }
  if (at < end) throw new FormatError("bytes after the last stream", at);
  return { ...values, index, isKey: (values.flags & FRAME_KEY) > 0, sections, offset: start };
}

/** Return the names of the streams of a frame, in their order. */
function streams(method, { flags, maps }) {
  const further = [flags & FRAME_CELLS ? "CELL" : "", flags & FRAME_CORRECTIONS ? "FIXS" : ""];
  return [maps ? "MAPS" : "", ...method.geometry, ...further].filter(Boolean);
}

/** Yield [field, what is wrong with it]. */
function* faults(values, index, parameters, vertices) {
  const { method, interpolated } = parameters;
  const { flags, finer, step, coarse, maps, unit = 0 } = values;
  if (flags & ~(FRAME_KEY | FRAME_CELLS | FRAME_CORRECTIONS)) {
    yield ["flags", "reserved bits are set: it needs a newer deltamesh"];
  }
  if (flags & FRAME_KEY && index === 1) {
    yield ["flags", "a key frame after frame 0, which is before it in any case"];
  }
  if (flags & FRAME_CELLS && !interpolated) yield ["flags", "vectors of cells that have none"];
  if (flags & FRAME_CORRECTIONS && !method.corrected) {
    yield ["flags", `corrections in a ${method.title} file`];
  }
  if (finer > MAX_FINER) yield ["finer", `a grid halved ${finer} times`];
  if (!(Number.isFinite(step) && step > 0)) {
    yield ["step", `a quantization step of ${spelled(step)}`];
  }
  if (!method.anchored && step !== parameters.step / 2 ** finer) {
    yield ["step", `a step of ${spelled(step)} on a grid of another`];
  }
  if (!(coarse >= 1 && coarse < Infinity && (method.coarse || coarse === 1))) {
    yield ["coarse", `method ${method.name} with deltas ${spelled(coarse)} times as coarse`];
  }
  for (const name of ERRORS) {
    if (!(Number.isFinite(values[name]) && values[name] >= 0)) {
      yield [name, `${name} is ${spelled(values[name])}`];
    }
  }
  if (maps > (method.anchored ? vertices : 0)) yield ["maps", `${maps} maps of ${vertices} vertices`];
  if (unit > MAX_MAP_UNIT) yield ["unit", `a unit of 2^-${unit}`];
}
