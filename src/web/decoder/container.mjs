// Reader of the container: bytes from anywhere become sections, parameters and counts.
import { readField, readFields, readTable, readVarint, take, varintSize } from "./bytes.mjs";
import { crc32 } from "./crc32.mjs";
import { FormatError, located } from "./errors.mjs";
import {
  CRC_SIZE,
  HEADER_FIELDS,
  ID_SIZE,
  KNOWN,
  MAGIC,
  MAX_COUNT,
  MAX_SECTIONS,
  VERSION,
  required,
} from "./layout.mjs";
import { readMeta, readParameters } from "./parameters.mjs";

/** Section of a file: its id, the byte where it begins, and its payload, a view of the file. */
export class Section {
  constructor(id, offset, payload) {
    Object.assign(this, { id, offset, payload });
    this.start = offset + ID_SIZE + varintSize(payload.length);
    this.end = this.start + payload.length + CRC_SIZE;
  }

  /** Return what `run` makes of the payload; a FormatError in it gets its place in the file. */
  read(run) {
    return located(this.start, `${this.id}: `, () => run(this.payload));
  }
}

/**
 * Read a `.dmesh` file, a Uint8Array, and check all that can be checked without decoding it.
 *
 * Returns its version, counts, parameters, meta (or null), sections (a Map by id) and digest.
 */
export function readContainer(bytes) {
  const [header, start] = readHeader(bytes);
  const [sections, end] = readSections(bytes, start);
  if (end < bytes.length) {
    throw new FormatError(`${bytes.length - end} bytes follow the last section`, end);
  }
  const [first] = sections.values();
  if (first.id !== "PARM") throw new FormatError("section PARM is missing", first.offset);
  const parameters = first.read((payload) => readParameters(payload, header.vertices));
  checkOrder(sections, parameters.method);
  const meta = sections.get("meta")?.read(readMeta) ?? null;
  const [{ digest }] = sections.get("CHEK").read((p) => readTable(p, [["digest", "bytes8"]]));
  const { version, vertices, triangles } = header;
  return { version, vertices, triangles, parameters, meta, sections, digest };
}

function readHeader(bytes) {
  checkMagic(bytes);
  // Another version may order what follows differently, so this comes before the checksum.
  const [version] = readField(bytes, MAGIC.length, "u16");
  if (!version) throw new FormatError("there is no container version 0", MAGIC.length);
  if (version !== VERSION) {
    const one = version > VERSION ? "a newer" : "an older";
    const reason = `container version ${version} needs ${one} deltamesh`;
    throw new FormatError(`${reason}, this one reads ${VERSION}`, MAGIC.length);
  }
  const [values, offsets, position] = readFields(bytes, 0, HEADER_FIELDS);
  checkCrc(bytes, 0, offsets.crc, "the header");
  if (values.reserved) {
    throw new FormatError("reserved bits are set: it needs a newer deltamesh", offsets.reserved);
  }
  for (const name of ["vertices", "triangles"]) {
    if (values[name] > MAX_COUNT) {
      throw new FormatError(`${values[name]} ${name}, more than ${MAX_COUNT}`, offsets[name]);
    }
  }
  return [values, position];
}

function checkMagic(bytes) {
  const head = bytes.subarray(0, MAGIC.length);
  const same = head.every((byte, i) => byte === MAGIC[i]);
  if (same && head.length === MAGIC.length) return;
  if (!head.length) throw new FormatError("the input is empty", 0);
  if (same) {
    throw new FormatError("truncated: the file ends within its signature", head.length);
  }
  const text = String.fromCharCode(...head);
  if (text.startsWith("ply")) {
    throw new FormatError("not a .dmesh file but a mesh file (PLY)", 0);
  }
  if (text.includes("DMS")) {
    const reason = "a .dmesh file with a damaged signature: was it sent as text?";
    throw new FormatError(reason, 0);
  }
  throw new FormatError("not a .dmesh file", 0);
}

function checkCrc(bytes, start, end, name) {
  const [stored] = readField(bytes, end, "u32");
  if (stored !== crc32(bytes.subarray(start, end))) {
    throw new FormatError(`${name} is damaged: its checksum does not match`, start);
  }
}

/** Read sections up to and with CHEK; return them and the position after it. */
function readSections(bytes, position) {
  const sections = new Map();
  while (!sections.has("CHEK")) {
    if (position === bytes.length) {
      throw new FormatError("truncated: section CHEK is missing", position);
    }
    if (sections.size === MAX_SECTIONS) {
      throw new FormatError(`more than ${MAX_SECTIONS} sections`, position);
    }
    const section = readSection(bytes, position);
    if (sections.has(section.id)) {
      throw new FormatError(`section ${section.id} comes a second time`, position);
    }
    sections.set(section.id, section);
    position = section.end;
  }
  return [sections, position];
}

function readSection(bytes, offset) {
  const id = String.fromCharCode(...take(bytes, offset, ID_SIZE));
  if (!/^[A-Za-z]{4}$/.test(id)) {
    throw new FormatError(`a section cannot be called ${JSON.stringify(id)}`, offset);
  }
  const [length, start] = readVarint(bytes, offset + ID_SIZE);
  const left = bytes.length - start - CRC_SIZE;
  if (length > left) {
    const reason = `truncated: section ${id} at byte ${offset} has ${length} bytes`;
    throw new FormatError(`${reason}, ${Math.max(left, 0)} are left`, bytes.length);
  }
  checkCrc(bytes, offset, start + length, `section ${id}`);
  if (!KNOWN.has(id) && isRequired(id)) {
    throw new FormatError(`section ${id} is unknown: it needs a newer deltamesh`, offset);
  }
  return new Section(id, offset, bytes.subarray(start, start + length));
}

const isRequired = (id) => id[0] <= "Z";

/** Refuse a section that is missing or not in its place; SPEC.md 3.2 has the order. */
function checkOrder(sections, method) {
  const ids = [...sections.keys()];
  const needed = required(method, sections);
  // CHEK ends the ids and is not among those needed, so a shorter list meets it here.
  needed.forEach((id, i) => {
    if (i < ids.length && ids[i] !== id) {
      const reason = `section ${id} is missing, ${ids[i]} is in its place`;
      throw new FormatError(reason, sections.get(ids[i]).offset);
    }
  });
  ids.slice(needed.length, -1).forEach((id, i) => {
    if (isRequired(id) || (id === "meta" && i > 0)) {
      const reason = `section ${id} has no place here in a ${method.name} file`;
      throw new FormatError(reason, sections.get(id).offset);
    }
  });
}
