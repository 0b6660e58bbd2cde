// Structure of a mesh: everything but its positions, as CONN, STCH, COPY and POLY make it.
import { out, place, room } from "./core.mjs";
import {
  after,
  componentsOf,
  elementsOf,
  endsOf,
  graphOf,
  graphOfFaces,
  pairedHalfedges,
} from "./graph.mjs";
import { counted, sorted } from "./integers.mjs";
import { hiddenHalfedges, mergeCandidates } from "./merged.mjs";
import { mergedPolygons, plainPolygons } from "./outlines.mjs";

/** Return an object whose properties are computed once, when they are first asked for. */
function lazily(known, computed) {
  const made = { ...known };
  for (const [name, compute] of Object.entries(computed)) {
    Object.defineProperty(made, name, {
      configurable: true,
      enumerable: true,
      get() {
        const value = compute(this);
        Object.defineProperty(this, name, { value, enumerable: true });
        return value;
      },
    });
  }
  return made;
}

/** Return an oriented manifold with boundary, from its triangles. */
export function manifoldOf(core, faces, count) {
  return lazily(
    { faces, count },
    { opposite: () => pairedHalfedges(faces), isSound: (manifold) => isSound(core, manifold) },
  );
}

/** Return whether faces agree in winding across each edge, and each vertex has one fan. */
function isSound(core, { faces, count, opposite }) {
  for (let h = 0; h < opposite.length; h++) {
    const g = opposite[h];
    if (g >= 0 && (faces[g] !== faces[after(h)] || faces[after(g)] !== faces[h])) return false;
  }
  const fans = place();
  core.call("dm_label_fans", opposite, opposite.length, out(opposite.slice()), fans);
  return Number(fans.value) === count;
}

/** Return the stitches of a manifold that is the complex itself. */
export function trivialStitches(vertices, faces) {
  const none = new Int32Array(0);
  const points = counted(vertices);
  const reversed = new Uint8Array(faces);
  return { points, reversed, repeated: none, against: new Uint8Array(0), degenerate: none };
}

/** Return whether stitches leave the manifold as it is. */
export function isTrivial({ points, reversed, repeated, degenerate }) {
  const each = points.length === 0 || points[points.length - 1] === points.length - 1;
  return each && !reversed.includes(1) && !repeated.length && !degenerate.length;
}

/** Return triangles over points: a manifold that is stitched, with repeated and degenerate faces. */
export function complexOf(core, manifold, stitches, used, isolated) {
  const trivial = isTrivial(stitches);
  return lazily(
    { manifold, stitches, used, isolated, trivial, pointCount: used + isolated },
    {
      faces: () => (trivial ? manifold.faces : complexFaces(manifold.faces, stitches)),
      manifoldFaces: () =>
        trivial ? manifold.faces : manifold.faces.map((v) => stitches.points[v]),
      corners: (complex) => cornersOf(core, complex),
    },
  );
}

/** Return a face of three corners as the winding has it. */
const wound = ([a, b, c], against) => (against ? [a, c, b] : [a, b, c]);

function complexFaces(faces, { points, reversed, repeated, against, degenerate }) {
  const count = faces.length + 3 * repeated.length + (3 * degenerate.length) / 2;
  const made = new Int32Array(count);
  for (let f = 0; f < reversed.length; f++) {
    const row = faces.subarray(3 * f, 3 * f + 3).map((v) => points[v]);
    made.set(wound(row, reversed[f]), 3 * f);
  }
  repeated.forEach((f, i) => {
    made.set(wound(made.subarray(3 * f, 3 * f + 3), against[i]), faces.length + 3 * i);
  });
  const begin = faces.length + 3 * repeated.length;
  for (let i = 0; i < degenerate.length; i += 2) {
    const [a, b] = degenerate.subarray(i, i + 2);
    made.set([a, a, b], begin + (3 * i) / 2);
  }
  return made;
}

/** Return the corners of a complex in the order in which their wedges are coded. */
function cornersOf(core, { manifold, stitches, pointCount }) {
  const { faces, opposite } = manifold;
  const { points, reversed, repeated, against, degenerate } = stitches;
  const own = faces.length;
  const count = own + 3 * repeated.length + (3 * degenerate.length) / 2;
  const rank = counted(count);
  for (let f = 0; f < reversed.length; f++) {
    rank.set(wound([3 * f, 3 * f + 1, 3 * f + 2], reversed[f]), 3 * f);
  }
  const repeats = new Int32Array(3 * repeated.length);
  repeated.forEach((f, i) => {
    repeats.set(wound(rank.subarray(3 * f, 3 * f + 3), against[i]), 3 * i);
  });
  const pointOf = new Int32Array(count);
  for (let c = 0; c < own; c++) pointOf[c] = points[faces[c]];
  repeats.forEach((corner, i) => (pointOf[own + i] = pointOf[corner]));
  for (let i = 0, c = own + repeats.length; i < degenerate.length; i += 2, c += 3) {
    pointOf.set([degenerate[i], degenerate[i], degenerate[i + 1]], c);
  }
  const [rings, spokes, closings] = [0, 0, 0].map(() => new Int32Array(own));
  const byPoint = sorted(points.length, [points, pointCount]);
  core.call(
    "dm_fill_rings",
    ...[opposite, faces, own / 3, byPoint, points.length],
    ...[out(rings), out(spokes), out(closings), room(points.length)],
  );
  const ringOf = counted(count);
  ringOf.set(rings);
  const order = sorted(count, [ringOf.map((corner) => pointOf[corner]), pointCount]);
  const names = ["DM_ACROSS", "DM_FAN", "DM_REPEAT", "DM_DEGENERATE"];
  const [ACROSS, FAN, REPEAT, DEGENERATE] = names.map((name) => core.constant(name));
  const bounds = new Int32Array(pointCount + 1);
  pointOf.forEach((p) => bounds[p + 1]++);
  for (let p = 0; p < pointCount; p++) bounds[p + 1] += bounds[p];
  const [ring, spoke, closing, like, kind] = [0, 0, 0, 0, 0].map(() => new Int32Array(count));
  for (let i = 0; i < count; i++) {
    const from = order[i];
    ring[i] = ringOf[from];
    spoke[i] = from < own ? spokes[from] : -1;
    closing[i] = from < own ? closings[from] : -1;
    if (from < own) kind[i] = spoke[i] >= 0 ? ACROSS : FAN;
    else kind[i] = from < own + repeats.length ? REPEAT : DEGENERATE;
    if (kind[i] === REPEAT) like[i] = repeats[ring[i] - own];
    else like[i] = bounds[pointOf[ring[i]]] === i ? -1 : ring[i - 1];
  }
  return { opposite, rank, pointOf, bounds, ring, spoke, closing, like, kind };
}

/** Return a mesh without its positions; `merged` is of length 0 if all polygons are triangles. */
export function structureOf(core, complex, faces, points, merged) {
  const split = points.length !== complex.pointCount;
  const { manifold, stitches } = complex;
  return lazily(
    { core, complex, faces, points, merged, split },
    {
      candidates: () => mergeCandidates(faces, manifold.opposite, stitches.reversed),
      polygons: () =>
        merged.length ? mergedPolygons(core, merged) : plainPolygons(faces.length / 3),
      surface: (structure) => surfaceOf(structure),
      vertices: (structure) => verticesOf(structure),
    },
  );
}

/** Return the structure of a complex with a vertex at each point, and triangles only. */
export function plainStructure(core, complex) {
  const points = counted(complex.pointCount);
  return structureOf(core, complex, complex.faces, points, new Int32Array(0));
}

/** Return the surface over points on which geometry is coded. */
function surfaceOf(structure) {
  const { core, complex, merged } = structure;
  const { used, isolated, manifold, trivial, manifoldFaces: faces } = complex;
  let graph;
  if (merged.length) {
    const hidden = hiddenHalfedges(merged, manifold.opposite, complex.stitches.reversed);
    const seen = counted(faces.length).filter((h) => !hidden[h]);
    const ends = endsOf(faces);
    graph = graphOf(
      seen.map((h) => faces[h]),
      seen.map((h) => ends[h]),
      used,
    );
  } else {
    graph = graphOfFaces(faces, used);
  }
  return lazily(
    { faces, graph, isolated, count: used },
    {
      labels: () => componentsOf(core, graph),
      elements: () => {
        const indptr = new Int32Array(used + isolated + 1).fill(graph.indptr[used]);
        indptr.set(graph.indptr);
        const whole = { count: used + isolated, indptr, indices: graph.indices };
        return elementsOf(whole, faces, quadsOf(structure), trivial ? manifold.opposite : null);
      },
    },
  );
}

/** Return the polygons of four corners, over points. */
function quadsOf({ polygons: { corners, offsets }, points, faces }) {
  const quads = [];
  for (let p = 0; p + 1 < offsets.length; p++) {
    if (offsets[p + 1] - offsets[p] !== 4) continue;
    for (let c = offsets[p]; c < offsets[p + 1]; c++) quads.push(points[faces[corners[c]]]);
  }
  return Int32Array.from(quads);
}

/** Return the vertices as elements, isolated ones included, over the edges of all triangles. */
function verticesOf(structure) {
  const { complex, split, merged, faces, points, surface } = structure;
  const trivial = complex.trivial && !split;
  if (trivial && !merged.length) return surface.elements;
  const graph = graphOfFaces(faces, points.length);
  return elementsOf(graph, faces, undefined, trivial ? complex.manifold.opposite : null);
}
