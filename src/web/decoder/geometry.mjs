// Integers of the geometry, by method, and the positions that they stand for.
//
// All integers are as they are digested; sections that a method has not leave theirs empty.
import { readVarint, take } from "./bytes.mjs";
import { decodeAnchors } from "./anchors.mjs";
import { out } from "./core.mjs";
import { FormatError } from "./errors.mjs";
import { decodeExact } from "./exact.mjs";
import { given, lowestOf } from "./graph.mjs";
import { doubled } from "./integers.mjs";
import { decodeThree, decodeVectors } from "./labels.mjs";
import { POSITION_LARGEST } from "./layout.mjs";
import { vertexNormals } from "./normals.mjs";
import { solverOf } from "./solver.mjs";
import { decodeSteps, extraBits, ratiosOf, readGridBits } from "./steps.mjs";

const NONE = new Int32Array(0);
const NOTHING = {
  values: NONE,
  anchors: NONE,
  positions: NONE,
  isolated: NONE,
  refinements: NONE,
  corrections: NONE,
  formats: NONE,
  exponents: NONE,
};

/** Return the integers of the geometry of a file. */
export function decodeGeometry(core, container, surface) {
  const { sections, parameters } = container;
  const { name, anchored } = parameters.method;
  if (name === "lossless") {
    return sections.get("EXAC").read((payload) => {
      const [values, formats] = decodeExact(core, payload, surface.elements);
      return { ...NOTHING, values, formats };
    });
  }
  const exponents = decodeSteps(core, container, surface);
  return anchored
    ? decodeDifferences(core, container, surface, exponents)
    : { ...NOTHING, values: decodeGrid(core, container, surface, exponents), exponents };
}

/** Return anchors, deltas, refinements and corrections. */
function decodeDifferences(core, { sections, parameters }, surface, exponents) {
  const { graph, count: n } = surface;
  const found = sections
    .get("ANCH")
    .read((payload) => decodeAnchors(core, payload, parameters, surface, exponents));
  const vectors = (payload) => decodeVectors(core, payload, graph);
  const values = sections.get("DELT").read((payload) => {
    if (parameters.step) return vectors(payload);
    if (payload.length) throw new FormatError("deltas in a file of 0 bits", 0);
    return new Int32Array(3 * n);
  });
  const corrections = sections.get("FIXS")?.read((payload) => {
    if (!parameters.step) throw new FormatError("corrections in a file of 0 bits", 0);
    return vectors(payload);
  });
  const refinements = sections.get("NORM")?.read((payload) => {
    const fine = new Int32Array(n);
    core.decode(core.model("vectors"), payload, (coder) => {
      core.call("dm_code_refinements", coder, ...given(graph), values, out(fine));
    });
    return fine;
  });
  return {
    ...NOTHING,
    ...found,
    values,
    exponents,
    corrections: corrections ?? NONE,
    refinements: refinements ?? NONE,
  };
}

/** Return the grid points of a Cartesian file. */
function decodeGrid(core, { sections }, surface, exponents) {
  const roots = surfaceRoots(surface, exponents);
  if (exponents.some((e, v) => e !== exponents[roots[surface.labels[v]]])) {
    sections.get("STEP").read(() => {
      throw new FormatError("steps that differ within a component of a Cartesian file", 0);
    });
  }
  return sections.get("CART").read((payload) => {
    if (!exponents.length) return decodeThree(core, payload, surface.elements);
    const [points, at] = decodeRoots(core, payload, roots, exponents);
    const values = decodeThree(core, payload.subarray(at), surface.elements, at);
    for (const root of roots) {
      if (values.subarray(3 * root, 3 * root + 3).some((x) => x)) {
        const reason = "the first vertex of a component is not where its root is";
        throw new FormatError(reason, at);
      }
    }
    surface.labels.forEach((label, v) => {
      for (let a = 0; a < 3; a++) values[3 * v + a] += points[3 * label + a];
    });
    return values;
  });
}

const surfaceRoots = (surface, exponents) => (exponents.length ? lowestOf(surface.labels) : []);

/** Return the grid points of the roots, and where the stream of all vertices begins. */
function decodeRoots(core, payload, roots, exponents) {
  const bits = readGridBits(payload);
  const [size, at] = readVarint(payload, 3);
  const extra = Int32Array.from(roots, (v) => extraBits(exponents[v]));
  const points = new BigInt64Array(3 * roots.length);
  const stream = take(payload, at, size);
  const run = (coder) => core.call("dm_code_points", coder, out(points), roots.length, bits, extra);
  core.decode(core.model("points"), stream, run, at);
  return [points, at + size];
}

/** Return numbers as doubles, whatever holds them. */
export const floatsOf = (numbers) =>
  numbers instanceof BigInt64Array ? doubled(numbers) : Float64Array.from(numbers);

/** Refuse integers that mean positions that no mesh has (SPEC.md 5.8). */
export function checkScale({ parameters, sections }, integers) {
  const { coarse, step, anchorStep, origin } = parameters;
  const steps = Math.max(coarse * step, anchorStep);
  const away = Math.max(...origin.map(Math.abs));
  if (!(largestOf(integers, parameters) * steps + away <= 100 * POSITION_LARGEST)) {
    throw new FormatError("positions that are too large", sections.get("PARM").offset);
  }
}

function largestOf(integers, { method }) {
  if (method.exact) return 0;
  const { values, refinements, corrections, positions, isolated, anchors, exponents } = integers;
  const ratios = ratiosOf(exponents, exponents.length);
  let most = 0;
  const look = (numbers, width, vertexOf) => {
    const found = floatsOf(numbers);
    for (let i = 0; i < found.length; i++) {
      const scale = vertexOf ? (ratios[vertexOf(Math.floor(i / width))] ?? 1) : 1;
      most = Math.max(most, Math.abs(found[i]) * scale);
    }
  };
  const same = (v) => v;
  look(values, 3, same);
  look(refinements, 1, same);
  look(corrections, 3, same);
  look(positions, 3, (i) => anchors[i]);
  look(isolated, 3, null);
  return most;
}

/** Return the positions of all points, Float64Array, three numbers each. */
export function reconstructed(core, { parameters }, integers, surface) {
  const { method, step, origin } = parameters;
  if (method.exact) return new Float64Array(integers.values.buffer.slice(0));
  const ratios = ratiosOf(integers.exponents, surface.count + surface.isolated);
  if (!method.anchored) return onGrid(integers.values, origin, (v) => step * ratios[v]);
  return solved(core, parameters, integers, surface, ratios);
}

function onGrid(points, origin, stepOf) {
  return floatsOf(points).map((g, i) => origin[i % 3] + g * stepOf(Math.floor(i / 3)));
}

/** Return the least-squares solution of deltas and anchors, refined and corrected. */
function solved(core, parameters, integers, surface, ratios) {
  const { step, origin, anchorStep, coarse } = parameters;
  const { values, anchors, positions, isolated, refinements, corrections } = integers;
  const fixed = onGrid(positions, origin, (i) => anchorStep * ratios[anchors[i]]);
  const coarseStep = (v) => coarse * (step * ratios[v]);
  const delta = floatsOf(values).map((d, i) => d * coarseStep(Math.floor(i / 3)));
  const solver = solverOf(core, surface.graph, surface.labels, anchors);
  let points;
  try {
    points = solver.solve(delta, fixed);
    if (refinements.length) {
      const steps = Float64Array.from({ length: surface.count }, (_, v) => coarseStep(v));
      const normals = vertexNormals(points, surface.faces, steps);
      for (let i = 0; i < delta.length; i++) {
        const v = Math.floor(i / 3);
        delta[i] += step * ratios[v] * refinements[v] * normals[i];
      }
      points = solver.solve(delta, fixed);
    }
  } finally {
    solver.free();
  }
  const all = new Float64Array(points.length + isolated.length);
  all.set(points);
  for (let i = 0; i < corrections.length; i++) {
    all[i] += step * ratios[Math.floor(i / 3)] * corrections[i];
  }
  all.set(onGrid(isolated, origin, () => anchorStep), points.length);
  return all;
}
