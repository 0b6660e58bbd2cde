// Sections PARM and meta: byte tables, and the rules that their values keep (SPEC.md 4).
import { readFields, readTable } from "./bytes.mjs";
import { FormatError, spelled } from "./errors.mjs";
import {
  ANCHOR_METHODS,
  BITS_FROM_STEP,
  FLAG_INTERPOLATED,
  FLAG_SINGLE,
  MAX_BITS,
  METHODS,
  META_FIELDS,
  META_LOSS_FIELDS,
  META_PART_FIELDS,
  PARAMETER_FIELDS,
  SEED_FIELDS,
} from "./layout.mjs";

/** Return what the payload of PARM holds, in a file of so many vertices. */
export function readParameters(payload, vertices) {
  let fields = PARAMETER_FIELDS;
  const [first] = readFields(payload, 0, fields);
  if (ANCHOR_METHODS.get(first.anchor_method) === "random") fields = [...fields, ...SEED_FIELDS];
  const [values, offsets] = readTable(payload, fields);
  const known = { method: METHODS[values.method], anchor_method: ANCHOR_METHODS.get(values.anchor_method) };
  for (const [field, value] of Object.entries(known)) {
    if (value === undefined) {
      const reason = `${field.replace("_", " ")} ${values[field]} is unknown`;
      throw new FormatError(`${reason}: it needs a newer deltamesh`, offsets[field]);
    }
  }
  const parameters = {
    method: known.method,
    anchorMethod: known.anchor_method,
    bits: values.bits === BITS_FROM_STEP ? null : values.bits,
    step: values.step,
    origin: [values.origin_x, values.origin_y, values.origin_z],
    anchorStep: values.anchor_step,
    seed: values.seed ?? 0n,
    anchorCount: values.anchor_count,
    isolated: values.isolated,
    coarse: values.coarse,
    single: (values.flags & FLAG_SINGLE) > 0,
    interpolated: (values.flags & FLAG_INTERPOLATED) > 0,
  };
  for (const [field, reason] of parameterFaults(parameters, vertices)) {
    throw new FormatError(reason, offsets[field]);
  }
  return parameters;
}

/** Yield [field, what is wrong with it]. */
function* parameterFaults(p, vertices) {
  const { method } = p;
  const stepless = Boolean(method.exact || (method.bare && p.bits === 0));
  if (Boolean(method.anchored) === (p.anchorMethod === null)) {
    yield ["anchor_method", `method ${method.name} with anchor method ${p.anchorMethod ?? "none"}`];
  }
  if (p.bits !== null && p.bits > MAX_BITS) {
    yield ["bits", `${p.bits} bits, outside 0..${MAX_BITS}`];
  }
  if (p.bits !== null && method.exact) yield ["bits", `${p.bits} bits in a ${method.title} file`];
  if (!(isSize(p.step) && (p.step === 0) === stepless)) {
    yield ["step", `a quantization step of ${spelled(p.step)}`];
  }
  for (let a = 0; a < 3; a++) {
    if (!Number.isFinite(p.origin[a]) || (method.exact && p.origin[a])) {
      yield [`origin_${"xyz"[a]}`, `an origin of ${spelled(p.origin[a])}`];
    }
  }
  if (!isSize(p.anchorStep)) yield ["anchor_step", `an anchor step of ${spelled(p.anchorStep)}`];
  if (p.anchorCount > vertices) {
    yield ["anchor_count", `${p.anchorCount} anchor vertices among ${vertices}`];
  }
  if (p.isolated > vertices) {
    yield ["isolated", `${p.isolated} isolated vertices among ${vertices}`];
  }
  if (!(p.coarse >= 1 && p.coarse < Infinity && (method.coarse || p.coarse === 1))) {
    yield ["coarse", `method ${method.name} with deltas ${spelled(p.coarse)} times as coarse`];
  }
  if (p.interpolated && (!method.anchored || stepless)) {
    yield ["flags", "interpolated anchors in a file without deltas"];
  }
  if (!method.anchored && (p.anchorStep || p.anchorCount)) {
    yield ["anchor_count", `anchors in a ${method.title} file`];
  }
}

const isSize = (value) => Number.isFinite(value) && value >= 0;

/** Return what the payload of meta holds. */
export function readMeta(payload) {
  let fields = META_FIELDS;
  const hasLosses = readFields(payload, 0, fields)[2] < payload.length;
  if (hasLosses) {
    fields = [...fields, ...META_LOSS_FIELDS];
    if (readFields(payload, 0, fields)[0].parts > 1) fields = [...fields, ...META_PART_FIELDS];
  }
  const [meta, offsets] = readTable(payload, fields);
  for (const [field, reason] of metaFaults(meta)) throw new FormatError(reason, offsets[field]);
  if (hasLosses && !(meta.lost > 0 || meta.turned > 0 || meta.parts > 1)) {
    throw new FormatError("no faces are lost or turned, and there is one part", offsets.lost);
  }
  return meta;
}

// Characters that no terminal may get from a file: control and unassigned ones, and separators.
export const UNPRINTABLE = /[\p{C}\p{Zl}\p{Zp}]|(?! )\p{Zs}/u;

function* metaFaults(meta) {
  for (const name of ["rms", "max", "normal", "dihedral", "diagonal", "part_normal", "part_rms"]) {
    if (name in meta && !isSize(meta[name])) yield [name, `${name} is ${spelled(meta[name])}`];
  }
  for (const name of ["encoder", "source", "part"]) {
    if (UNPRINTABLE.test(meta[name] ?? "")) {
      yield [name, `the ${name} name holds control characters`];
    }
  }
  if (meta.parts < 1) yield ["parts", `${meta.parts} parts`];
}
