// Solver of the decoder: positions from differential coordinates and anchors (SPEC.md 5.4, 5.20).
import { interpolationOf } from "./interpolation.mjs";
import { leastSquaresOf } from "./least_squares.mjs";

/**
 * Return a solver of a graph whose vertices are of the components `labels`, each with an anchor.
 *
 * Positions go through the anchors if these are `interpolated`, else deltas and anchors are weighed
 * against each other. `solve(delta, positions, options)` returns the positions of all vertices,
 * three numbers each; for the options, see `interpolationOf`. `free` gives its memory back.
 */
export function solverOf(core, graph, labels, anchors, interpolated) {
  const make = interpolated ? interpolationOf : leastSquaresOf;
  return make(core, graph, labels, anchors);
}
