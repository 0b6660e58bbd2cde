// Normal equations of differential coordinates and anchors: A^T A for A = [L; S].
//
// A vertex of d neighbours puts d^2 entries into L^T L. Where d is large, its row R of A becomes an
// unknown of its own: with B for the other rows, (B^T B + R^T R) x = b is the first block of
// [B^T B, R^T; R, -I] [x; R x] = [b; 0], which is quasidefinite (R. J. Vanderbei, "Symmetric
// quasidefinite matrices", 1995). A weak pin on each such vertex keeps B^T B regular, and refinement
// removes the pins.
import { out, room } from "./core.mjs";
import { LimitError } from "./errors.mjs";
import { given } from "./graph.mjs";

const LONGEST_ROW = 100;
const PIN = 1e-5;
// Entries of a matrix that the memory of WebAssembly, 4 GiB, may hold beside its factor.
const MOST_ENTRIES = 2 ** 25;

/**
 * Return the rows of the matrix, or of its stand-in: `size`, `indptr`, `columns` and `values`.
 *
 * `square` is that of the weight of the anchors.
 */
export function normalEquations(core, graph, anchors, square) {
  for (let v = 0; v < graph.count; v++) {
    if (graph.indptr[v + 1] - graph.indptr[v] >= LONGEST_ROW) return standIn(graph, anchors, square);
  }
  const size = graph.count;
  const indptr = new Int32Array(size + 1);
  core.call("dm_normal_bounds", ...given(graph), out(indptr), room(size));
  const filled = indptr[size];
  if (filled > MOST_ENTRIES) throw tooLarge();
  const columns = new Int32Array(filled);
  const values = new Float64Array(filled);
  const rows = [indptr, out(columns), out(values), filled, room(size)];
  const weights = new Float64Array(anchors.length).fill(square);
  core.call("dm_normal_matrix", ...given(graph), anchors, weights, anchors.length, ...rows);
  return { size, indptr, columns, values };
}

/** Return the error of a system that no surface has. */
export const tooLarge = () =>
  new LimitError("the edges are not those of a surface: solving for the positions takes too much");

function standIn({ count: n, indptr, indices }, anchors, square) {
  const degree = (v) => indptr[v + 1] - indptr[v];
  const extra = new Int32Array(n).fill(-1);
  let size = n;
  for (let v = 0; v < n; v++) if (degree(v) + 1 > LONGEST_ROW) extra[v] = size++;
  const isAnchor = new Uint8Array(n);
  anchors.forEach((v) => (isAnchor[v] = 1));
  const [starts, columns, values] = [[0], [], []];
  const sums = new Float64Array(n);
  const seen = new Int32Array(n).fill(-1);
  for (let v = 0; v < n; v++) {
    const own = [];
    const add = (w, value) => {
      if (seen[w] !== v) {
        seen[w] = v;
        sums[w] = 0;
        own.push(w);
      }
      sums[w] += value;
    };
    const further = [];
    // The rows of L that have a number in column v: its own, and those of its neighbours.
    const take = (row, factor) => {
      if (extra[row] >= 0) further.push([extra[row], factor]);
      else {
        add(row, factor * degree(row));
        for (let e = indptr[row]; e < indptr[row + 1]; e++) add(indices[e], -factor);
      }
    };
    take(v, degree(v));
    for (let e = indptr[v]; e < indptr[v + 1]; e++) take(indices[e], -1);
    if (isAnchor[v]) add(v, square);
    if (extra[v] >= 0) add(v, PIN);
    for (const w of own) {
      columns.push(w);
      values.push(sums[w]);
    }
    for (const [column, value] of further) {
      columns.push(column);
      values.push(value);
    }
    starts.push(columns.length);
    if (columns.length > MOST_ENTRIES) throw tooLarge();
  }
  for (let v = 0; v < n; v++) {
    if (extra[v] < 0) continue;
    columns.push(v, extra[v]);
    values.push(degree(v), -1);
    for (let e = indptr[v]; e < indptr[v + 1]; e++) {
      columns.push(indices[e]);
      values.push(-1);
    }
    starts.push(columns.length);
  }
  const rows = { indptr: Int32Array.from(starts), columns: Int32Array.from(columns) };
  return { size, ...rows, values: Float64Array.from(values) };
}
