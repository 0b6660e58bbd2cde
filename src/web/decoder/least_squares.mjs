// Least-squares solution of differential coordinates and anchors (SPEC.md 5.4).
//
// x = argmin |L x - delta|^2 + |w (S x - positions)|^2, w the weight of anchors, L the Laplacian of the graph, S the selection of
// anchors: normal equations, factored once, and refined by residuals of [L; S] as in A. Bjorck,
// "Stability analysis of the method of seminormal equations", 1987.
import { centresOf } from "./cells.mjs";
import { at, out, place, room } from "./core.mjs";
import { SolveError } from "./errors.mjs";
import { given } from "./graph.mjs";
import { largest } from "./integers.mjs";
import { normalEquations, tooLarge } from "./normal_equations.mjs";

const REFINED = 1e-7;
const MAX_REFINEMENTS = 5;
const TINY = 2 ** -1022;
// Entries of a factor that the memory of WebAssembly, 4 GiB, may hold beside all else.
const MOST_ENTRIES = 2 ** 28;
const COLUMNS = 3;
// Bytes of `dm_factor_plan`: five numbers and six pointers.
const PLAN = 64;

/**
 * Return a solver of a graph whose vertices are of the components `labels`, each with an anchor.
 *
 * `solve(delta, positions)` returns the positions of all vertices, three numbers each; `free` gives
 * its memory back.
 */
export function leastSquaresOf(core, graph, labels, anchors, weight = 1) {
  const square = weight * weight;
  const factor = graph.count
    ? factorOf(core, graph, anchors, square)
    : { solve: (b) => b, free() {} };
  return {
    solve: (delta, positions) =>
      solve(core, graph, labels, anchors, square, factor, delta, positions),
    free: factor.free,
  };
}

function solve(core, graph, labels, anchors, square, factor, delta, positions) {
  const apply = (x) => {
    const product = new Float64Array(x.length);
    core.call("dm_apply_laplacian", ...given(graph), x, COLUMNS, out(product));
    return product;
  };
  const transposed = (rows, anchored) => {
    const product = apply(rows);
    anchors.forEach((v, i) => {
      for (let a = 0; a < 3; a++) product[3 * v + a] += square * anchored[3 * i + a];
    });
    return product;
  };
  // L maps constants to zero: far from the origin of a component, digits are lost.
  const centres = centresOf(labels, anchors, positions);
  const fixed = positions.map((p, i) => p - centres[3 * labels[anchors[Math.floor(i / 3)]] + (i % 3)]);
  const x = factor.solve(transposed(delta, fixed));
  for (let round = 0; round < MAX_REFINEMENTS; round++) {
    const product = apply(x);
    const left = delta.map((d, i) => d - product[i]);
    const off = fixed.map((p, i) => p - x[3 * anchors[Math.floor(i / 3)] + (i % 3)]);
    const correction = factor.solve(transposed(left, off));
    for (let i = 0; i < x.length; i++) x[i] += correction[i];
    const sizes = sizesOf(labels, x);
    if (sizesOf(labels, correction).every((size, k) => size <= REFINED * sizes[k] + TINY)) {
      return x.map((value, i) => value + centres[3 * labels[Math.floor(i / 3)] + (i % 3)]);
    }
  }
  throw new SolveError(
    "the least-squares system has no solution in double precision",
  );
}

/** Return the largest magnitude of each component. */
function sizesOf(labels, x) {
  const sizes = new Float64Array(largest(labels) + 1);
  for (let v = 0; v < labels.length; v++) {
    for (let i = 3 * v; i < 3 * v + 3; i++) {
      // A number that is none is larger than all.
      if (!(Math.abs(x[i]) <= sizes[labels[v]])) sizes[labels[v]] = Math.abs(x[i]);
    }
  }
  return sizes;
}

/** Return the factors of the normal equations: `solve` of right-hand sides, and `free`. */
function factorOf(core, graph, anchors, square) {
  const { size, indptr, columns, values } = normalEquations(core, graph, anchors, square);
  const matrix = [indptr, size, columns, columns.length];
  const order = new Int32Array(size);
  const memory = [room(columns.length + size), room(14 * (size + 1))];
  core.call("dm_minimum_degree", ...matrix, out(order), ...memory);
  const { solve, free } = factored(core, matrix, values, planOf(core, matrix, order));
  if (size === graph.count) return { solve, free };
  const padded = (b) => {
    const whole = new Float64Array(COLUMNS * size);
    whole.set(b);
    return solve(whole).slice(0, b.length);
  };
  return { solve: padded, free };
}

/** Return the order of elimination, and the columns that are factored together. */
function planOf(core, matrix, order) {
  const n = order.length;
  const [parent, of] = [0, 0].map(() => new Int32Array(n));
  const [starts, rowBounds, panelBounds] = [0, 0, 0].map(() => new Int32Array(n + 1));
  const sizes = new Int32Array(4);
  const made = [parent, starts, of, rowBounds, panelBounds, sizes].map(out);
  const memory = [n, n, n, n].map(room);
  core.call("dm_plan", ...matrix, out(order), MOST_ENTRIES, ...made, ...memory);
  if (sizes[0] < 0) throw tooLarge();
  const [supernodes, , , tallest] = sizes;
  const [rows, entries] = [rowBounds[supernodes], panelBounds[supernodes]];
  const cut = [starts, rowBounds, panelBounds].map((all) => all.slice(0, supernodes + 1));
  return { order, parent, of, cut, supernodes, tallest, rows, entries };
}

function factored(core, matrix, values, plan) {
  const { order, parent, of, cut, supernodes: s, tallest, rows, entries } = plan;
  const n = order.length;
  const [tile, widest] = ["DM_TILE", "DM_WIDEST"].map((name) => core.constant(name));
  const taken = [];
  const free = () => taken.splice(0).forEach((address) => core.heap.release(address));
  const allocate = (size) => {
    taken.push(core.heap.allocate(size));
    return taken[taken.length - 1];
  };
  try {
    // What the factors keep: they are handed over by addresses.
    const kept = [order, ...cut].map((array) => [array, allocate(8 * array.length)]);
    const rowsAt = allocate(8 * rows);
    const panels = allocate(8 * (entries + tile));
    core.bytes(panels, 8 * (entries + tile)).fill(0);
    const planAt = allocate(PLAN);
    for (const [array, address] of kept) {
      new BigInt64Array(core.exports.memory.buffer, address, array.length).set(
        BigInt64Array.from(array, BigInt),
      );
    }
    const numbers = [n, s, rows, entries, tallest].map(BigInt);
    new BigInt64Array(core.exports.memory.buffer, planAt, 5).set(numbers);
    const pointers = [...kept.map(([, address]) => address), rowsAt, panels];
    new Uint32Array(core.exports.memory.buffer, planAt + 40, 6).set(pointers);
    const pivot = place();
    const block = [room((tallest + tile) * widest), room(widest * tile), pivot];
    const memory = [n, n, s, s, s].map(room);
    core.call("dm_factor", ...matrix, values, at(planAt), parent, of, ...memory, ...block);
    if (pivot.value >= 0n) {
      throw new SolveError(`the pivot of unknown ${order[Number(pivot.value)]} is zero`);
    }
    const solve = (b) => {
      const x = b.slice();
      const sums = [room(x.length), room(tallest * COLUMNS)];
      core.call("dm_solve_factored", at(planAt), out(x), COLUMNS, ...sums);
      return x;
    };
    return { solve, free };
  } catch (error) {
    free();
    throw error;
  }
}
