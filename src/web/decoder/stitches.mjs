// Section STCH: the cuts, reversed and repeated faces that make a manifold of a complex.
import { readVarint } from "./bytes.mjs";
import { out, place, room } from "./core.mjs";
import { FormatError } from "./errors.mjs";
import { after, given, graphOfFaces } from "./graph.mjs";
import { complexOf, isTrivial, plainStructure } from "./structure.mjs";

/** Return the structure of the stitched complex, of so many faces. */
export function decodeStitches(core, payload, faceCount, { complex }) {
  const { manifold, used, isolated } = complex;
  const stitches = decode(core, payload, complex, faceCount);
  return plainStructure(core, complexOf(core, manifold, stitches, used, isolated));
}

function decode(core, payload, { manifold, used, pointCount }, faceCount) {
  let numbers = [];
  let position = 0;
  for (let i = 0; i < 4; i++) [numbers[i], position] = readVarint(payload, position);
  const [n, m, anyReversed, r] = numbers;
  if (anyReversed > 1 || r > faceCount - m) {
    throw new FormatError("the counts of faces contradict those of the header", 0);
  }
  const points = new Int32Array(n);
  const reversed = new Uint8Array(m);
  const repeats = new Int32Array(2 * m);
  const degenerate = new Int32Array(2 * (faceCount - m - r));
  const refuse = (reason) => {
    throw new FormatError(reason, position);
  };
  const run = (coder) => {
    if (codePoints(core, coder, manifold, points) !== used) {
      refuse("stitches: another number of points than in the header");
    }
    const opposite = [manifold.opposite, m];
    if (anyReversed) {
      core.call("dm_code_reversed", coder, ...opposite, out(reversed));
      if (!reversed.includes(1)) refuse("reversed faces: announced, but there are none");
    }
    if (r && !core.good("dm_code_repeats", coder, ...opposite, out(repeats), r)) {
      refuse("repeated faces: another number than announced");
    }
    if (degenerate.length) {
      const stitched = manifold.faces.map((v) => points[v]);
      const graph = given(graphOfFaces(stitched, used));
      const pairs = [out(degenerate), degenerate.length / 2, pointCount];
      if (!core.good("dm_code_degenerate", coder, ...graph, ...pairs)) {
        refuse("degenerate faces: a point out of range or out of order");
      }
    }
  };
  core.decode(core.model("stitching"), payload.subarray(position), run, position);
  const repeated = [];
  const against = [];
  repeats.forEach((times, i) => {
    for (let k = 0; k < times; k++) {
      repeated.push(i >> 1);
      against.push(i & 1);
    }
  });
  const stitches = {
    points,
    reversed,
    repeated: Int32Array.from(repeated),
    against: Uint8Array.from(against),
    degenerate,
  };
  if (isTrivial(stitches)) refuse("stitches: a manifold that needs none");
  return stitches;
}

/** Fill in the points of the vertices; return how many there are, -1 if corrupt. */
function codePoints(core, coder, { faces, opposite }, points) {
  const n = points.length;
  const boundary = new Uint8Array(n);
  opposite.forEach((g, h) => {
    if (g < 0) boundary[faces[h]] = boundary[faces[after(h)]] = 1;
  });
  const count = place();
  const graph = given(graphOfFaces(faces, n));
  const rest = [boundary, out(points), room(n), room(n), room(n), count];
  return core.good("dm_code_stitches", coder, ...graph, ...rest) ? Number(count.value) : -1;
}
