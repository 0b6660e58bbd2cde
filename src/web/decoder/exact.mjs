// Columns of floats to the last bit, three to a stream: section EXAC and exact attributes.
import { readFields, readField } from "./bytes.mjs";
import { out, room } from "./core.mjs";
import { FormatError, spelled } from "./errors.mjs";
import { fromIndices } from "./exact_numbers.mjs";
import { given, predictors } from "./graph.mjs";
import { decodeVectors } from "./labels.mjs";
import { POSITION_LARGEST, RAW_WIDTHS } from "./layout.mjs";

const COLUMN_FIELDS = [
  ["flags", "u8"],
  ["grid", "i16"],
];
const OPERATION_FIELDS = [
  ["operator", "u8"],
  ["operand", "f64"],
];
const FORMAT_FIELDS = [
  ["base", "u8"],
  ["places", "i16"],
  ["digits", "u8"],
  ["usual", "u8"],
];
const OPERATORS = 3;
const [LEAST_OPERAND, MOST_OPERAND] = [2 ** -1022, 1e150];
const MOST_USUAL = 60;
// Bits of an index, and of a point on the grid.
const INDEX_BITS = 61;
const GRID_BITS = 56;

/** Return the bit patterns of the positions, and the bytes of their number formats. */
export function decodeExact(core, payload, elements) {
  const [width, columns, at] = readFormats(payload);
  const { values } = decodeNumbers(core, payload, at, elements, width, columns);
  if (!values.every((x) => Math.abs(x) <= POSITION_LARGEST)) {
    throw new FormatError("a position that no mesh has", at);
  }
  return [new BigInt64Array(values.buffer), Int32Array.from(payload.subarray(0, at))];
}

/**
 * Return the values of three columns of elements, whether each is raw, and the bits of raw ones.
 *
 * Those that are raw have in `values` what their bits are.
 */
export function decodeNumbers(core, payload, at, elements, width, columns) {
  const n = elements.count;
  const choices = new Int32Array(3 * n);
  const indices = new BigInt64Array(3 * n);
  const run = (coder) => codeNumbers(core, coder, elements, width, columns, choices, indices);
  const model = modelOf(core, columns);
  const RAW = core.constant("DM_RAW");
  let deviations = null;
  if (columns.some((column) => column.deviations)) {
    const [size, begin] = readPart(payload, at, "u32");
    const end = begin + size;
    if (end > payload.length) throw new FormatError("truncated: stream of numbers", payload.length);
    core.decode(model, payload.subarray(begin, end), run, begin);
    deviations = decodeVectors(core, payload.subarray(end), elements, end);
    if (deviations.some((d, i) => d && !(columns[i % 3].deviations && choices[i] !== RAW))) {
      throw new FormatError("deviation of a number that has none", end);
    }
  } else {
    core.decode(model, payload.subarray(at), run, at);
  }
  const names = { raw: RAW, negativeZero: core.constant("DM_NEGATIVE_ZERO") };
  const values = new Float64Array(3 * n);
  columns.forEach((column, a) => {
    fromIndices({ choices, indices, deviations, values }, a, column, width === 32, names);
  });
  return { values, indices, isRaw: Uint8Array.from(choices, (choice) => Number(choice === RAW)) };
}

/** Return a model of three axes and of so many formats. */
function modelOf(core, columns) {
  const [axis, format] = [core.model("exact_axis"), core.model("exact_format")];
  const formats = columns.reduce((sum, column) => sum + column.formats.length, 0);
  const kinds = [axis, axis, axis, ...Array(formats).fill(format)].map((model) => [...model.kinds]);
  return {
    slots: 3 * axis.slots + formats * format.slots,
    kinds: Int32Array.from(kinds.flat()),
  };
}

function codeNumbers(core, coder, elements, width, columns, choices, indices) {
  const axes = [];
  const formats = [];
  for (const { formats: own, grid, raw, zeros } of columns) {
    axes.push(formats.length / 4, own.length, Number(raw), Number(zeros));
    for (const f of own) formats.push(f.base, grid - f.places, f.digits, f.usual);
  }
  const tables = [Int32Array.from(axes), Int32Array.from(formats), formats.length / 4, width];
  const made = [out(choices), out(indices), room(choices.length), room(choices.length)];
  core.call("dm_code_exact", coder, ...given(elements), ...predictors(elements), ...tables, ...made);
}

/** Return the bits of a raw number, the formats of each column, and where the stream begins. */
export function readFormats(payload) {
  let [width, at] = readPart(payload, 0, "u8");
  if (!RAW_WIDTHS.includes(width)) throw new FormatError(`numbers of ${width} bits`, 0);
  const columns = [];
  for (let a = 0; a < 3; a++) {
    const start = at;
    let column;
    [column, at] = readColumn(payload, at);
    const fault = faultOf(column, width === 32);
    if (fault) throw new FormatError(fault, start);
    columns.push(column);
  }
  return [width, columns, at];
}

function readColumn(payload, at) {
  let fields;
  [fields, at] = readParts(payload, at, COLUMN_FIELDS);
  const { flags, grid } = fields;
  const operations = [];
  for (let k = (flags >> 4) & 3; k > 0; k--) {
    [fields, at] = readParts(payload, at, OPERATION_FIELDS);
    operations.push(fields);
  }
  const formats = [];
  for (let k = flags & 3; k > 0; k--) {
    [fields, at] = readParts(payload, at, FORMAT_FIELDS);
    formats.push(fields);
  }
  const [raw, zeros, double, deviations] = [4, 8, 0x40, 0x80].map((bit) => (flags & bit) > 0);
  return [{ formats, grid, raw, zeros, operations, double, deviations }, at];
}

function readParts(payload, at, fields) {
  return complete(payload, () => {
    const [values, , end] = readFields(payload, at, fields);
    return [values, end];
  });
}

const readPart = (payload, at, type) => complete(payload, () => readField(payload, at, type));

function complete(payload, read) {
  try {
    return read();
  } catch (error) {
    if (!(error instanceof FormatError)) throw error;
    throw new FormatError("truncated: number formats", payload.length);
  }
}

/** Return the fault of the formats of a column (SPEC.md 5.12); "" for none. */
function faultOf({ formats, grid, raw, operations, double }, single) {
  if (formats.length > 2 || !(formats.length || raw)) {
    return `${formats.length} number formats in a column`;
  }
  for (const { base, places, digits, usual } of formats) {
    const offset = grid - places;
    let fits;
    if (base === 2) {
      fits = -971 <= places && places <= 1074 && 1 <= digits && digits <= 53;
      fits = fits && -(2 ** (INDEX_BITS - digits) - GRID_BITS - 2) <= offset;
    } else {
      fits = base === 10 && 0 <= places && places <= 22 && 1 <= digits && digits <= 17;
      fits = fits && 0 <= offset && offset <= 18;
    }
    if (!fits || base !== formats[0].base || usual > MOST_USUAL) {
      return `invalid number format: base ${base}, ${places} places, ${digits} digits`;
    }
  }
  if (operations.length > 2) return `${operations.length} operations in a column`;
  if (double && !(single && operations.length === 2)) return "a conversion in binary64 that is none";
  for (const { operator, operand } of operations) {
    if (operator >= OPERATORS) return `invalid operator: ${operator}`;
    const size = Math.abs(operand);
    if (!(LEAST_OPERAND <= size && size <= MOST_OPERAND)) return `invalid operand: ${spelled(operand)}`;
  }
  return "";
}
