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
    const b = new Float64Array(whole.length);
    const x = new Float64Array(whole.length);
    for (let v = 0, i = 0; i < b.length; v++) {
      const [scale, shift] = [scales[labels[v]], 3 * labels[v]];
      for (let a = 0; a < 3; a++, i++) {
        b[i] = whole[i] / scale;
        if (start) x[i] = (start[i] - shifts[shift + a]) / scale;
      }
    }
    anchors.forEach((v, k) => {
      for (let a = 0; a < 3; a++) {
        x[3 * v + a] = (positions[3 * k + a] - shifts[3 * labels[v] + a]) / scales[labels[v]];
      }
    });
    const { solution, bound } = solvePoisson(core, hierarchy, b, x, tolerance);
    if (!(bound <= tolerance || isRounding(hierarchy, bound, b, solution))) {
      throw new SolveError(
        "the Poisson problem has no solution in double precision",
      );
    }
    for (let v = 0, i = 0; i < b.length; v++) {
      const [scale, shift] = [scales[labels[v]], 3 * labels[v]];
      for (let a = 0; a < 3; a++, i++) solution[i] = solution[i] * scale + shifts[shift + a];
    }
    return solution;
  };
  return { cells, solve, free() {} };
}

/** Return whether a bound is one that only more digits could better, and tolerable. */
function isRounding(hierarchy, bound, b, x) {
  return bound <= Math.min(roundingOf(hierarchy, b, x), ROUNDING * greatest(x));
}
