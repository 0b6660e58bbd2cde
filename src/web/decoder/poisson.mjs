// Poisson problem: positions whose graph Laplacian is given, with some vertices held fixed, by
// multigrid and conjugate gradients (src/core/poisson.c).
import { at, out, place, real, room, shorts, shortsOut } from "./core.mjs";
import { given } from "./graph.mjs";

const MOST_ITERATIONS = 1000;
const ROUNDINGS = 4;
const EPSILON = 2 ** -52;

/** Return the levels of a graph without its fixed vertices, for any number of right-hand sides. */
export function hierarchyOf(core, graph, fixed) {
  const n = graph.count;
  const diagonal = new Float32Array(n);
  const inverse = new Float32Array(n);
  for (let v = 0; v < n; v++) {
    diagonal[v] = graph.indptr[v + 1] - graph.indptr[v];
    inverse[v] = diagonal[v] ? 1 / diagonal[v] : 0;
  }
  fixed.forEach((v) => (inverse[v] = 0));
  const { indptr, indices } = graph;
  const weights = new Float32Array(0);
  const levels = [{ indptr, indices, weights, diagonal, inverse, aggregate: none(n) }];
  const [most, dense] = ["DM_MAX_LEVELS", "DM_MAX_DENSE"].map((name) => core.constant(name));
  const block = blockOf(core, graph);
  const isLarge = () => levels.length === 1 || levels.at(-1).diagonal.length > dense;
  while (levels.length < most && isLarge()) {
    const level = levels.at(-1);
    const count = aggregate(core, level, levels.length === 1 ? block : level.diagonal.length);
    if (!count) break;
    levels.push(coarsened(core, level, count));
  }
  const last = levels.at(-1).diagonal.length;
  const isDense = levels.length > 1 && last > 0 && last <= dense;
  const factor = isDense ? factored(core, levels.at(-1)) : new Float64Array(0);
  const joined = (some, ...keys) =>
    Object.fromEntries(keys.map((key) => [key, concatenated(some.map((level) => level[key]))]));
  const [finest, ...others] = levels;
  const coarse = others.length ? others : [{ indptr: none(0), indices: none(0), weights }];
  const arrays = {
    ...joined(coarse, "indptr", "indices", "weights"),
    ...joined(levels, "diagonal", "inverse", "aggregate"),
  };
  const sizes = Int32Array.from(levels, (level) => level.diagonal.length);
  const entries = Int32Array.from(levels, (level) => level.indices.length);
  return { n, finest, sizes, entries, ...arrays, factor, dense: isDense ? last : 0, block, barrier: 0 };
}

const none = (count) => new Int32Array(count).fill(-1);

function concatenated(arrays) {
  const whole = new arrays[0].constructor(arrays.reduce((sum, array) => sum + array.length, 0));
  arrays.reduce((begin, array) => {
    whole.set(array, begin);
    return begin + array.length;
  }, 0);
  return whole;
}

const rowsOf = (level) => given({ count: level.diagonal.length, ...level });

/** Return the rows of a block of the finest level. */
function blockOf(core, graph) {
  const block = place();
  core.call("dm_choose_block", ...given(graph), block);
  return Number(block.value);
}

/** Fill in the aggregate of each node, within blocks of nodes; return how many there are. */
function aggregate(core, level, within) {
  const count = place();
  const own = [level.inverse, within, shortsOut(level.aggregate)];
  core.call("dm_aggregate", ...rowsOf(level), ...own, count);
  return Number(count.value);
}

/** Return the level above one with so many aggregates. */
function coarsened(core, level, count) {
  const { indices, weights, diagonal, aggregate: found } = level;
  const made = {
    indptr: new Int32Array(count + 1),
    indices: new Int32Array(indices.length),
    weights: new Float32Array(indices.length),
    diagonal: new Float32Array(count),
  };
  const end = place();
  const own = [weights.length ? weights : at(0), diagonal, shorts(found), count];
  const rows = [shortsOut(made.indptr), shortsOut(made.indices), out(made.weights)];
  const memory = [diagonal.length, count + 1, count + 1].map((size) => room(size));
  core.call("dm_coarsen", ...rowsOf(level), ...own, ...rows, out(made.diagonal), end, ...memory);
  const kept = Number(end.value);
  made.indices = made.indices.slice(0, kept);
  made.weights = made.weights.slice(0, kept);
  const inverse = made.diagonal.map((d) => 1 / d);
  return { ...made, inverse, aggregate: none(count) };
}

/** Return the lower triangle of Cholesky's factor of the matrix of a small level. */
function factored(core, { indptr, indices, weights, diagonal }) {
  const n = diagonal.length;
  const matrix = new Float64Array(n * n);
  for (let row = 0; row < n; row++) {
    matrix[row * n + row] = diagonal[row];
    for (let e = indptr[row]; e < indptr[row + 1]; e++) matrix[row * n + indices[e]] -= weights[e];
  }
  core.call("dm_factor_dense", out(matrix), n);
  return matrix;
}

/**
 * Solve L x = b in the rows of the free vertices, three numbers each, from where x starts.
 *
 * Fixed vertices keep their x. Returns x, and a bound on the error of a coordinate.
 */
export function solvePoisson(core, hierarchy, b, x, tolerance) {
  const { n, finest, sizes, entries, indptr, indices, weights } = hierarchy;
  const lanes = core.constant("DM_LANES");
  const solution = x.slice();
  const barrier = Float64Array.of(hierarchy.barrier);
  const bound = new Float64Array(1);
  const nodes = hierarchy.diagonal.length;
  const rows = [finest.indptr, finest.indices, indptr, indices].map(shorts);
  const levels = [sizes, entries, sizes.length, ...rows, weights];
  const numbers = [hierarchy.diagonal, hierarchy.inverse, shorts(hierarchy.aggregate)];
  const wanted = [b, out(solution), real(tolerance), MOST_ITERATIONS];
  const found = [out(barrier), out(bound), place()];
  const blocks = Math.ceil(n / hierarchy.block);
  const memory = [lanes * blocks, n, lanes * n, lanes * n, lanes * n].map((count) => room(count));
  const coarse = Math.ceil((lanes * (nodes - n)) / 2); // floats of 32 bits
  const dense = [hierarchy.factor, hierarchy.dense];
  core.call(
    "dm_solve_poisson",
    ...[...levels, ...numbers, ...dense, ...wanted, ...found],
    ...[hierarchy.block, at(0), ...memory],
    ...[room(coarse), room(coarse), room(Math.ceil(n / 8))],
  );
  [hierarchy.barrier] = barrier;
  return { solution, bound: bound[0] };
}

/** Return a bound on the error that solutions near x have by rounding. */
export function roundingOf({ n, diagonal, barrier }, b, x) {
  const most = greatest(x);
  let terms = 0;
  for (let v = 0; v < n; v++) {
    terms = Math.max(terms, greatest(b.subarray(3 * v, 3 * v + 3)) + 2 * diagonal[v] * most);
  }
  return barrier * ROUNDINGS * EPSILON * terms;
}

/** Return the largest magnitude. */
export function greatest(numbers) {
  let most = 0;
  for (let i = 0; i < numbers.length; i++) most = Math.max(most, Math.abs(numbers[i]));
  return most;
}
