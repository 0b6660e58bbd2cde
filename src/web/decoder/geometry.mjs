// Integers of the geometry, by method, and the positions that they stand for.
//
// All integers are as they are digested; sections that a method has not leave theirs empty.
import { readVarint, take } from "./bytes.mjs";
import { decodeAnchors } from "./anchors.mjs";
import { sharedCells } from "./cells.mjs";
import { out } from "./core.mjs";
import { FormatError } from "./errors.mjs";
import { decodeExact } from "./exact.mjs";
import { alone, given, lowestOf } from "./graph.mjs";
import { doubled } from "./integers.mjs";
import { decodeThree, decodeVectors } from "./labels.mjs";
import { LEAST_UNIT, MOST_UNIT, POSITION_LARGEST } from "./layout.mjs";
import { vertexNormals } from "./normals.mjs";
import { greatest } from "./poisson.mjs";
import { solverOf } from "./solver.mjs";
import { decodeSteps, extraBits, ratiosOf, readGridBits } from "./steps.mjs";

// Solves that a method takes, one after the other.
const STAGES = { highpass: 1, refined: 2 };

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
  units: NONE,
  cells: NONE,
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
  const found = sections
    .get("ANCH")
    .read((payload) => decodeAnchors(core, payload, parameters, surface, exponents));
  return decodeDeltas(core, sections, parameters, surface, { ...NOTHING, ...found, exponents });
}

/** Return integers with deltas, refinements and corrections, from those that have anchors. */
function decodeDeltas(core, sections, parameters, { graph, count: n, labels }, found) {
  const vectors = (payload) => decodeVectors(core, payload, graph);
  const values = sections.get("DELT").read((payload) => {
    if (parameters.step) return vectors(payload);
    if (payload.length) throw new FormatError("deltas in a file of 0 bits", 0);
    return new Int32Array(3 * n);
  });
  const lost = sections
    .get("CELL")
    ?.read((payload) => decodeCells(core, payload, parameters, labels, found.anchors));
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
    ...found,
    ...lost,
    values,
    corrections: corrections ?? NONE,
    refinements: refinements ?? NONE,
  };
}

/**
 * Return the integers of a further frame, its grid points less those of another one.
 *
 * Anchors and exponents are those of the `first` frame.
 */
export function decodeFrame(core, sections, parameters, surface, first) {
  const { anchors, exponents } = first;
  if (!parameters.method.anchored) {
    const read = (payload) => decodeThree(core, payload, surface.elements);
    return { ...NOTHING, values: sections.get("CART").read(read), exponents };
  }
  const rows = alone(anchors.length + surface.isolated);
  const points = sections.get("ANCH").read((payload) => decodeVectors(core, payload, rows));
  const end = 3 * anchors.length;
  const [positions, isolated] = [points.slice(0, end), points.slice(end)];
  const found = { ...NOTHING, anchors, positions, isolated, exponents };
  return decodeDeltas(core, sections, parameters, surface, found);
}

/** Return what the cells of anchors have lost at each stage, and its units in octaves. */
function decodeCells(core, payload, { method, interpolated }, labels, anchors) {
  const shared = sharedCells(labels, anchors);
  const stages = STAGES[method.name];
  if (!(interpolated && shared.length)) {
    throw new FormatError("vectors of cells that have none", 0);
  }
  const units = Int32Array.from(take(payload, 0, stages), (byte) => byte + LEAST_UNIT);
  const most = units.indexOf(Math.max(...units));
  if (units[most] > MOST_UNIT) throw new FormatError(`a unit of 2^${units[most]} steps`, most);
  const rows = alone(stages * shared.length);
  const cells = decodeVectors(core, payload.subarray(stages), rows, stages);
  if (cells.every((x) => !x)) throw new FormatError("no cell has lost anything", stages);
  return { units, cells };
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
const floatsOf = (numbers) =>
  numbers instanceof BigInt64Array ? doubled(numbers) : Float64Array.from(numbers);

/** Return whether integers mean positions that a mesh may have (SPEC.md 5.8). */
export function hasScale(parameters, integers) {
  const { coarse, step, anchorStep, origin } = parameters;
  const steps = Math.max(coarse * step, anchorStep);
  const away = Math.max(...origin.map(Math.abs));
  return largestOf(integers, parameters) * steps + away <= 100 * POSITION_LARGEST;
}

function largestOf(integers, { method }) {
  if (method.exact) return 0;
  const { values, refinements, corrections, positions, isolated, anchors, exponents, units, cells } = integers;
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
  const each = cells.length / (units.length || 1);
  units.forEach((unit, stage) => {
    most = Math.max(most, greatest(cells.subarray(stage * each, (stage + 1) * each)) * 2 ** unit);
  });
  return most;
}

/**
 * Return what makes positions of integers, for all frames of a file; `free` gives its memory back.
 */
export function geometrySolver(core, { method, interpolated }, { anchors }, { graph, labels }) {
  return method.anchored ? solverOf(core, graph, labels, anchors, interpolated) : { free() {} };
}

/**
 * Return the positions of all points, Float64Array, three numbers each.
 *
 * `solver` is of `geometrySolver`; of a frame that is predicted, `expected` are its `deltas`, and
 * positions near its own.
 */
export function reconstructed(core, parameters, integers, surface, solver, expected = null) {
  const { method, step, origin } = parameters;
  if (method.exact) return new Float64Array(integers.values.buffer.slice(0));
  const ratios = ratiosOf(integers.exponents, surface.count + surface.isolated);
  if (!method.anchored) return onGrid(integers.values, origin, (v) => step * ratios[v]);
  return solved(core, parameters, integers, surface, solver, ratios, expected);
}

function onGrid(points, origin, stepOf) {
  return floatsOf(points).map((g, i) => origin[i % 3] + g * stepOf(Math.floor(i / 3)));
}

/** Return the solution of deltas and anchors, refined and corrected. */
function solved(core, parameters, integers, surface, solver, ratios, expected) {
  const { step, origin, anchorStep, coarse, interpolated } = parameters;
  const { values, anchors, positions, isolated, refinements, corrections } = integers;
  const fixed = onGrid(positions, origin, (i) => anchorStep * ratios[anchors[i]]);
  const delta = floatsOf(values);
  for (let v = 0, i = 0; i < delta.length; v++) {
    const unit = coarse * (step * ratios[v]);
    for (const end = i + 3; i < end; i++) delta[i] = delta[i] * unit + (expected?.deltas[i] ?? 0);
  }
  const steps = ratios.slice(0, surface.count).map((ratio) => step * ratio);
  const solve = (stage, isLast, start) => {
    const lost = interpolated ? lostOf(parameters, integers, solver.cells, ratios, stage) : null;
    return solver.solve(delta, fixed, { steps, lost, start, isLast });
  };
  let points = solve(0, !refinements.length, expected?.positions);
  if (refinements.length) {
    const coarser = steps.map((s) => coarse * s);
    const normals = vertexNormals(core, points, surface.faces, coarser);
    for (let v = 0, i = 0; v < steps.length; v++) {
      const along = steps[v] * refinements[v];
      for (const end = i + 3; i < end; i++) delta[i] += along * normals[i];
    }
    points = solve(1, true, points);
  }
  const all = new Float64Array(points.length + isolated.length);
  all.set(points);
  for (let i = 0; i < corrections.length; i++) {
    all[i] += steps[Math.floor(i / 3)] * corrections[i];
  }
  all.set(onGrid(isolated, origin, () => anchorStep), points.length);
  return all;
}

/** Return what is added to the deltas of each cell at a stage, three numbers each. */
function lostOf({ step }, { anchors, units, cells }, { shared, sizes }, ratios, stage) {
  const lost = new Float64Array(3 * anchors.length);
  if (!cells.length) return lost;
  const unit = step * 2 ** units[stage];
  shared.forEach((cell, i) => {
    for (let a = 0; a < 3; a++) {
      const number = cells[3 * (stage * shared.length + i) + a];
      lost[3 * cell + a] = (number * (unit * ratios[anchors[cell]])) / sizes[cell];
    }
  });
  return lost;
}
