// Cells of anchors: the vertices that are nearest to each, and what is the same all over one.
import { out, room } from "./core.mjs";
import { given } from "./graph.mjs";
import { largest } from "./integers.mjs";

/**
 * Return the cells of some anchors in a graph whose vertices are of the components `labels`.
 *
 * `of` is the cell of each vertex, `sizes` how many vertices each has, `shared` are the cells of
 * components that have several.
 */
export function cellsOf(core, graph, labels, anchors) {
  const n = graph.count;
  const k = anchors.length;
  const of = new Int32Array(n);
  core.call("dm_nearest", ...given(graph), anchors, k, out(of), room(n));
  const sizes = new Float64Array(k);
  of.forEach((cell) => sizes[cell]++);
  return { of, sizes, shared: sharedCells(labels, anchors), labels, anchors };
}

/** Return the cells whose component has several, ascending. */
export function sharedCells(labels, anchors) {
  const counts = new Int32Array(largest(labels) + 1);
  anchors.forEach((v) => counts[labels[v]]++);
  return Array.from(anchors, (_, cell) => cell).filter((cell) => counts[labels[anchors[cell]]] > 1);
}

/** Return the least number of each component. */
export function leastOf(labels, numbers) {
  const least = new Float64Array(largest(labels) + 1).fill(Infinity);
  labels.forEach((label, v) => (least[label] = Math.min(least[label], numbers[v])));
  return least;
}

/** Return the mean position of the anchors of each component. */
export function centresOf(labels, anchors, positions) {
  const counts = new Float64Array(largest(labels) + 1);
  const sums = new Float64Array(3 * counts.length);
  anchors.forEach((v, i) => {
    counts[labels[v]]++;
    for (let a = 0; a < 3; a++) sums[3 * labels[v] + a] += positions[3 * i + a];
  });
  return sums.map((sum, i) => sum / counts[Math.floor(i / 3)]);
}

/**
 * Return deltas with `lost`, three numbers a cell, added over the cells, and centred.
 *
 * The Laplacian of anything sums to zero over a component.
 */
export function completed({ of, labels }, delta, lost) {
  const counts = new Float64Array(largest(labels) + 1);
  const means = new Float64Array(3 * counts.length);
  const whole = new Float64Array(delta.length);
  for (let v = 0, i = 0; i < whole.length; v++) {
    counts[labels[v]]++;
    for (let a = 0; a < 3; a++, i++) {
      whole[i] = delta[i] + lost[3 * of[v] + a];
      means[3 * labels[v] + a] += whole[i];
    }
  }
  means.forEach((_, i) => (means[i] /= counts[Math.floor(i / 3)]));
  for (let v = 0, i = 0; i < whole.length; v++) {
    for (let a = 0; a < 3; a++, i++) whole[i] -= means[3 * labels[v] + a];
  }
  return whole;
}
