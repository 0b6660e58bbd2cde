// Table of attributes at the beginning of ATTR: their names, types and codings (SPEC.md 5.14).
import { decoded, readField, readFields, readVarint, take } from "./bytes.mjs";
import { FormatError, spelled } from "./errors.mjs";
import {
  CODINGS,
  DOMAINS,
  MAX_LIMB_BITS,
  MAX_NORMAL_BITS,
  MIN_NORMAL_BITS,
  OWN_WEDGES,
  ROLES,
  TYPES,
  WEDGES_OF,
} from "./layout.mjs";

const [NORMALIZED, PARTLY, PALETTE, MIXED, FIRST_NONE] = [1, 2, 4, 8, 64];
const INTEGER_FIELDS = [
  ["origin", "u64"],
  ["bits", "u8"],
  ["limbs", "u8"],
];

const isInteger = (type) => /^(bool|u?int)/.test(type);
const isComplex = (type) => type.startsWith("complex");

/** Return the bytes of a real number of a type. */
export const numberSize = (type) => {
  if (type === "bool") return 1;
  const bits = Number(type.replace(/^\D+/, ""));
  return (isComplex(type) ? bits / 2 : bits) / 8;
};

/** Return the attributes of a file, by its table; nothing is decoded. */
export function entriesOf({ sections }) {
  return sections.get("ATTR")?.read((payload) => readAttributeTable(payload)[0]) ?? [];
}

/** Return the entries of a table, and where the streams begin. */
export function readAttributeTable(payload) {
  let [count, at] = readVarint(payload, 0);
  const entries = [];
  if (!count) throw new FormatError("a table of 0 attributes", 0);
  for (let i = 0; i < count; i++) {
    let entry;
    [entry, at] = readEntry(payload, at, entries);
    entries.push(entry);
  }
  const total = entries.reduce((sum, entry) => sum + entry.size, 0);
  const left = payload.length - at;
  if (total !== left) {
    throw new FormatError(`streams of ${total} bytes in all, where ${left} are left`, at);
  }
  return [entries, at];
}

function readEntry(payload, start, before) {
  const refuse = (reason, at) => {
    throw new FormatError(`attribute ${before.length}: ${reason}`, at);
  };
  const [length, begin] = readVarint(payload, start);
  const [name, fault] = decoded(take(payload, begin, length), true);
  if (fault >= 0) refuse("its name is not UTF-8", begin + fault);
  let at = begin + length;
  const [what, flags] = take(payload, at, 2);
  const [domain, role, type] = [DOMAINS[what & 3], ROLES[(what >> 2) & 3], TYPES[what >> 4]];
  if (!domain) refuse(`unknown domain ${what & 3}`, at);
  if (!type) refuse(`unknown type ${what >> 4}`, at);
  if (flags >= 2 * FIRST_NONE) refuse("reserved bits of flags are set", at);
  const entry = {
    name,
    domain,
    role,
    type,
    coding: CODINGS[(flags >> 4) & 3],
    normalized: (flags & NORMALIZED) > 0,
    partly: (flags & PARTLY) > 0,
    mixed: (flags & MIXED) > 0,
    firstNone: (flags & FIRST_NONE) > 0,
    wedges: OWN_WEDGES,
    palette: null,
    limbs: 1,
    error: 0,
  };
  [entry.width, at] = readVarint(payload, at + 2);
  if (domain === "corner") [entry.wedges, at] = readVarint(payload, at);
  if (flags & PALETTE) [entry.palette, at] = readVarint(payload, at);
  at = readCoding(payload, at, entry);
  const reason = faultOf(entry) || faultOfOwners(entry, before);
  if (reason) refuse(reason, start);
  const numbers = entry.width * (isComplex(type) ? 2 : 1);
  entry.columns = entry.coding === "octahedral" ? 3 : numbers * entry.limbs;
  const own = domain === "corner" && entry.wedges === OWN_WEDGES;
  const others = [own, entry.partly, entry.palette !== null].filter((one) => one).length;
  const streams = others + Math.ceil(entry.columns / 3);
  if (streams > payload.length - at) {
    refuseTruncated(payload, `attribute ${before.length}: sizes of its streams`);
  }
  entry.sizes = [];
  for (let k = 0; k < streams; k++) [entry.sizes[k], at] = readVarint(payload, at);
  entry.size = entry.sizes.reduce((sum, size) => sum + size, 0);
  return [entry, at];
}

function refuseTruncated(payload, what) {
  throw new FormatError(`truncated: ${what}`, payload.length);
}

/** Read the fields that only some codings have; return the position after them. */
function readCoding(payload, at, entry) {
  const { coding, width } = entry;
  if (coding === "exact") return at;
  if (coding === "integer") {
    const [fields, , end] = readFields(payload, at, INTEGER_FIELDS);
    Object.assign(entry, fields);
    return end;
  }
  [entry.bits, at] = readField(payload, at, "u8");
  [[entry.error], at] = readFloats(payload, at, 1);
  if (coding === "grid") [[entry.density, ...entry.origin], at] = readFloats(payload, at, 1 + width);
  return at;
}

function readFloats(payload, at, count) {
  if (count > Math.floor((payload.length - at) / 8)) {
    refuseTruncated(payload, "the numbers of an attribute");
  }
  const found = [];
  for (let k = 0; k < count; k++) [found[k], at] = readField(payload, at, "f64");
  return [found, at];
}

function faultOf(e) {
  const fits = e.coding === "integer" ? isInteger(e.type) : !isInteger(e.type);
  const lossy = e.coding === "grid" || e.coding === "octahedral";
  if (!fits || (lossy && isComplex(e.type))) return `type ${e.type} with coding ${e.coding}`;
  const plain = e.coding === "integer" || e.coding === "grid";
  if (e.mixed && (!plain || e.width < 3 || e.limbs > 1)) {
    return `mixed columns with coding ${e.coding}, width ${e.width} and ${e.limbs} limbs`;
  }
  if (e.coding === "integer") {
    const bounded = 1 <= e.bits && e.bits <= MAX_LIMB_BITS;
    const few = 1 <= e.limbs && e.limbs <= Math.ceil(64 / e.bits);
    return bounded && few ? "" : `${e.limbs} limbs of ${e.bits} bits`;
  }
  if (e.coding === "octahedral") {
    if (e.width !== 3) return `octahedral coding with width ${e.width}`;
    if (e.palette !== null) return "octahedral coding with a palette";
    if (e.bits < MIN_NORMAL_BITS || e.bits > MAX_NORMAL_BITS) return `normals of ${e.bits} bits`;
  }
  if (!Number.isFinite(e.error) || e.error < 0) return `error ${spelled(e.error)}`;
  if (e.coding !== "grid") return "";
  if (!(e.density > 0 && Number.isFinite(e.density))) return `density ${spelled(e.density)}`;
  const wrong = e.origin.find((value) => !Number.isFinite(value));
  return wrong === undefined ? "" : `origin ${spelled(wrong)}`;
}

function faultOfOwners(e, before) {
  if (e.palette === 0) return "empty palette";
  if (e.firstNone && !e.partly) return "first_none without partly";
  if (e.domain !== "corner" || e.wedges < WEDGES_OF) return "";
  const other = e.wedges - WEDGES_OF;
  if (other >= before.length) return `wedges of attribute ${other}, which does not come before it`;
  if (before[other].domain !== "corner" || before[other].wedges !== OWN_WEDGES) {
    return `wedges of attribute ${other}, which has none of its own`;
  }
  return "";
}
