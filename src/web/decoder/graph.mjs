// Structure that follows from faces alone: half-edges, neighbours, components, elements.
//
// Half-edge 3 f + i runs from corner i of triangle f to the next corner. A graph is { count,
// indptr, indices }: the neighbours of i are indices[indptr[i]] up to indices[indptr[i + 1]],
// ascending. Elements are a graph with parallelograms: first, corners and within.
import { out, place, room, shorts } from "./core.mjs";
import { counted, largest, sorted } from "./integers.mjs";

/** Return the half-edge after one in its triangle. */
export const after = (h) => (h % 3 === 2 ? h - 2 : h + 1);
/** Return the half-edge before one in its triangle. */
export const before = (h) => (h % 3 === 0 ? h + 2 : h - 1);

/** Return the vertex at which each half-edge of triangles ends. */
export function endsOf(faces) {
  const ends = new Int32Array(faces.length);
  for (let h = 0; h < ends.length; h++) ends[h] = faces[after(h)];
  return ends;
}

/** Return the lower ends of edges from a to b, and the higher ones. */
export function lowAndHigh(a, b) {
  const low = new Int32Array(a.length);
  const high = new Int32Array(a.length);
  for (let i = 0; i < a.length; i++) {
    low[i] = Math.min(a[i], b[i]);
    high[i] = Math.max(a[i], b[i]);
  }
  return [low, high];
}

/**
 * Return the graph of n vertices with edges between a[i] and b[i], loops left out.
 *
 * Two passes sort without comparing: in the second one, vertices come to the rows of their
 * neighbours in ascending order.
 */
export function graphOf(a, b, n) {
  const indptr = new Int32Array(n + 1);
  for (let i = 0; i < a.length; i++) {
    if (a[i] === b[i]) continue;
    indptr[a[i] + 1]++;
    indptr[b[i] + 1]++;
  }
  for (let v = 0; v < n; v++) indptr[v + 1] += indptr[v];
  let end = indptr.slice();
  const rows = new Int32Array(indptr[n]);
  for (let i = 0; i < a.length; i++) {
    if (a[i] === b[i]) continue;
    rows[end[a[i]]++] = b[i];
    rows[end[b[i]]++] = a[i];
  }
  end = indptr.slice();
  const indices = new Int32Array(rows.length);
  for (let v = 0; v < n; v++) {
    for (let i = indptr[v]; i < indptr[v + 1]; i++) {
      const w = rows[i];
      if (end[w] === indptr[w] || indices[end[w] - 1] !== v) indices[end[w]++] = v;
    }
  }
  let kept = 0;
  for (let v = 0; v < n; v++) {
    const first = indptr[v];
    indptr[v] = kept;
    for (let i = first; i < end[v]; i++) indices[kept++] = indices[i];
  }
  indptr[n] = kept;
  return { count: n, indptr, indices: indices.slice(0, kept) };
}

/** Return the graph of the vertices of triangles. */
export const graphOfFaces = (faces, n) => graphOf(faces, endsOf(faces), n);

/** Return the arguments of the core that a graph is. */
export function given({ count, indptr, indices }) {
  return [shorts(indptr), count, shorts(indices), indices.length];
}

/** Return the component of each vertex, numbered in the order of their lowest vertices. */
export function componentsOf(core, graph) {
  const labels = new Int32Array(graph.count);
  core.call("dm_label_components", ...given(graph), out(labels), room(graph.count), place());
  return labels;
}

/** Return the lowest vertex of each component. */
export function lowestOf(labels) {
  const lowest = [];
  labels.forEach((label, v) => {
    if (label === lowest.length) lowest.push(v);
  });
  return Int32Array.from(lowest);
}

/**
 * Return the opposite of each half-edge, -1 where none is.
 *
 * Of an edge with more than two half-edges, the first two are a pair.
 */
export function pairedHalfedges(faces) {
  const n = largest(faces) + 1;
  const [low, high] = lowAndHigh(faces, endsOf(faces));
  const order = sorted(faces.length, [low, n], [high, n]);
  const opposite = new Int32Array(faces.length).fill(-1);
  for (let i = 0, begin = 0; i < order.length; i++) {
    const [g, h] = [order[begin], order[i]];
    if (low[g] !== low[h] || high[g] !== high[h]) begin = i;
    else if (i === begin + 1) [opposite[g], opposite[h]] = [h, g];
  }
  return opposite;
}

/** Return the parallelograms that predict each vertex: rows (a, b, o), quads first. */
function parallelograms(faces, n, quads, opposite) {
  const sides = quads.length + faces.length;
  const first = new Int32Array(n + 1);
  const within = new Int32Array(n);
  const side = new Int32Array(4);
  const look = (s) => {
    if (s < quads.length) {
      const corner = (shift) => quads[s - (s % 4) + (((s % 4) + shift) % 4)];
      side.set([corner(3), corner(1), corner(2), corner(0)]);
    } else {
      const h = s - quads.length;
      const across = opposite[h] < 0 ? n : faces[before(opposite[h])];
      side[0] = faces[h];
      side[1] = faces[after(h)];
      side[2] = across;
      side[3] = faces[before(h)];
    }
    return side[0] < side[3] && side[1] < side[3] && side[2] < side[3];
  };
  for (let s = 0; s < sides; s++) {
    if (!look(s)) continue;
    first[side[3] + 1]++;
    if (s < quads.length) within[side[3]]++;
  }
  for (let v = 0; v < n; v++) first[v + 1] += first[v];
  const corners = new Int32Array(3 * first[n]);
  const next = first.slice();
  for (let s = 0; s < sides; s++) {
    if (look(s)) corners.set(side.subarray(0, 3), 3 * next[side[3]]++);
  }
  return { first, corners, within };
}

/** Return a graph as elements, with the parallelograms of triangles and of quads. */
export function elementsOf(graph, faces, quads = new Int32Array(0), opposite = null) {
  const pairs = opposite ?? pairedHalfedges(faces);
  return { ...graph, ...parallelograms(faces, graph.count, quads, pairs) };
}

/** Return a graph as elements without parallelograms. */
export function withoutParallelograms(graph) {
  const first = new Int32Array(graph.count + 1);
  return { ...graph, first, corners: new Int32Array(0), within: new Int32Array(graph.count) };
}

/** Return elements without neighbours. */
export function alone(count) {
  const indptr = new Int32Array(count + 1);
  return withoutParallelograms({ count, indptr, indices: new Int32Array(0) });
}

/** Return only the elements to keep, in their order, with the neighbours among these. */
export function among(elements, keep) {
  if (keep.every((kept) => kept)) return elements;
  const number = new Int32Array(keep.length).fill(-1);
  const kept = counted(keep.length).filter((i) => keep[i]);
  kept.forEach((old, i) => (number[old] = i));
  const indptr = [0];
  const first = [0];
  const indices = [];
  const corners = [];
  for (const old of kept) {
    for (let e = elements.indptr[old]; e < elements.indptr[old + 1]; e++) {
      if (number[elements.indices[e]] >= 0) indices.push(number[elements.indices[e]]);
    }
    for (let p = elements.first[old]; p < elements.first[old + 1]; p++) {
      const row = elements.corners.subarray(3 * p, 3 * p + 3).map((v) => number[v]);
      if (row.every((v) => v >= 0)) corners.push(...row);
    }
    indptr.push(indices.length);
    first.push(corners.length / 3);
  }
  return {
    count: kept.length,
    indptr: Int32Array.from(indptr),
    indices: Int32Array.from(indices),
    first: Int32Array.from(first),
    corners: Int32Array.from(corners),
    within: new Int32Array(kept.length),
  };
}

/** Return the arguments of the core that the parallelograms of elements are. */
export function predictors({ first, corners }) {
  return [shorts(first), shorts(corners), corners.length / 3];
}
