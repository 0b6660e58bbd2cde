// Half-edges across which triangles may be merged into polygons, and those across which they are.
import { endsOf, lowAndHigh } from "./graph.mjs";
import { counted, largest, sorted } from "./integers.mjs";

/** Return a half-edge of the manifold as one of the mesh, or the other way round. */
const ofMesh = (h, reversed) => (reversed[Math.floor(h / 3)] ? h - (h % 3) + 2 - (h % 3) : h);

/**
 * Return the half-edge that each half-edge of the mesh may be merged with, -1 for none.
 *
 * That is its opposite in the manifold, where it runs between the same two vertices, the other way,
 * in the mesh, too. Of the others, on each edge, the first that runs from its lower to its higher
 * vertex is with the first that runs back, the second with the second, and so on.
 */
export function mergeCandidates(faces, opposite, reversed) {
  const ends = endsOf(faces);
  const candidate = new Int32Array(faces.length).fill(-1);
  opposite.forEach((across, h) => {
    if (across < 0) return;
    const one = ofMesh(h, reversed);
    const other = ofMesh(across, reversed);
    if (faces[one] === ends[other] && ends[one] === faces[other]) candidate[one] = other;
  });
  const rest = counted(faces.length).filter((h) => candidate[h] < 0 && faces[h] !== ends[h]);
  const start = rest.map((h) => faces[h]);
  const [low, high] = lowAndHigh(
    start,
    rest.map((h) => ends[h]),
  );
  const back = start.map((v, i) => Number(v !== low[i]));
  const n = largest(faces) + 1;
  const order = sorted(rest.length, [low, n], [high, n], [back, 2]);
  for (let begin = 0, end = 0; begin < order.length; begin = end) {
    const isSame = (i) => low[i] === low[order[begin]] && high[i] === high[order[begin]];
    let middle = begin;
    for (end = begin; end < order.length && isSame(order[end]); end++) {
      if (!back[order[end]]) middle = end + 1;
    }
    for (let k = 0; k < Math.min(middle - begin, end - middle); k++) {
      const [one, other] = [rest[order[begin + k]], rest[order[middle + k]]];
      [candidate[one], candidate[other]] = [other, one];
    }
  }
  return candidate;
}

/** Return which half-edges of the manifold are merged with their opposites. */
export function hiddenHalfedges(merged, opposite, reversed) {
  return Uint8Array.from(opposite, (across, h) => {
    return Number(across >= 0 && merged[ofMesh(h, reversed)] === ofMesh(across, reversed));
  });
}
