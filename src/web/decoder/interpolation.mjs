// Interpolated anchors: positions whose Laplacian is given, and that go through the anchors.
import { cellsOf, centresOf, completed, leastOf } from "./cells.mjs";
import { SolveError } from "./errors.mjs";
import { greatest, hierarchyOf, roundingOf, solvePoisson } from "./poisson.mjs";

// Errors that a coordinate may have, in the least step of its component: of the positions, and of
// the surface whose normals the refinements go along.
const TOLERANCE = 1e-3;
const NORMAL_TOLERANCE = 1e-4;
// Where doubles cannot keep that, errors may be those of rounding, up to that share of the extent.
const ROUNDING = 1e-6;

/**
 * Return a solver of a graph whose vertices are of the components `labels`, each with an anchor.
 *
 * `solve(delta, positions, options)` returns the positions of all vertices; of the options, `steps`
 * are those of the deltas, `lost` what each cell adds to its deltas, `start` positions near the
 * solution or null, and `isLast` tells whether they are what the decoder returns.
 */
export function interpolationOf(core, graph, labels, anchors) {
  const cells = cellsOf(core, graph, labels, anchors);
  const hierarchy = hierarchyOf(core, graph, anchors);
  const solve = (delta, positions, { steps, lost, start, isLast }) => {
    if (!delta.length) return delta;
    const whole = completed(cells, delta, lost);
    const tolerance = isLast ? TOLERANCE : NORMAL_TOLERANCE;
    const scales = leastOf(labels, steps);
    const shifts = centresOf(labels, anchors, positions);
    const scale = (v) => scales[labels[v]];
    const shift = (i) => shifts[3 * labels[Math.floor(i / 3)] + (i % 3)];
    const at = (i) => Math.floor(i / 3);
    const b = whole.map((d, i) => d / scale(at(i)));
    const x = start ? start.map((p, i) => (p - shift(i)) / scale(at(i))) : new Float64Array(b.length);
    anchors.forEach((v, k) => {
      for (let a = 0; a < 3; a++) {
        x[3 * v + a] = (positions[3 * k + a] - shift(3 * v + a)) / scale(v);
      }
    });
    const { solution, bound } = solvePoisson(core, hierarchy, b, x, tolerance);
    if (!(bound <= tolerance || isRounding(hierarchy, bound, b, solution))) {
      throw new SolveError(
        "the Poisson problem has no solution in double precision",
      );
    }
    return solution.map((p, i) => p * scale(at(i)) + shift(i));
  };
  return { cells, solve, free() {} };
}

/** Return whether a bound is one that only more digits could better, and tolerable. */
function isRounding(hierarchy, bound, b, x) {
  return bound <= Math.min(roundingOf(hierarchy, b, x), ROUNDING * greatest(x));
}
