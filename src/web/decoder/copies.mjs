// Section COPY: the vertices at each point of a complex, where a point is split into several.
import { readVarint } from "./bytes.mjs";
import { out } from "./core.mjs";
import { FormatError } from "./errors.mjs";
import { largest } from "./integers.mjs";
import { structureOf } from "./structure.mjs";
import { codeWedges } from "./wedges.mjs";

/** Return the structure with its vertices, of which the header has so many. */
export function decodeCopies(core, payload, vertexCount, { complex, merged }) {
  const { corners } = complex;
  const [count, begin] = readVarint(payload, 0);
  const [total, position] = readVarint(payload, begin);
  const further = new Int32Array(count);
  const run = (coder) => {
    const wedges = codeWedges(core, coder, corners);
    if (total && !core.good("dm_code_isolated", coder, out(further), count, total)) {
      const reason = "split vertices: another number of isolated vertices than announced";
      throw new FormatError(reason, position);
    }
    return wedges;
  };
  const wedges = core.decode(core.model("wedges"), payload.subarray(position), run, position);
  const { faces, points } = splitVertices(corners, wedges, further);
  if (points.length !== vertexCount) {
    const reason = "split vertices: another number of vertices than in the header";
    throw new FormatError(reason, position);
  }
  return structureOf(core, complex, faces, points, merged);
}

/** Return the faces over vertices, and the point of each: first those in faces, then the others. */
function splitVertices({ pointOf, rank }, wedges, further) {
  const owner = new Int32Array(largest(wedges) + 1);
  wedges.forEach((wedge, c) => (owner[wedge] = pointOf[rank[c]]));
  const inFaces = new Int32Array(further.length);
  owner.forEach((point) => inFaces[point]++);
  const shift = new Int32Array(further.length);
  const points = [];
  let before = 0;
  further.forEach((more, point) => {
    shift[point] = points.length - before;
    before += inFaces[point];
    for (let k = Math.max(inFaces[point], 1) + more; k > 0; k--) points.push(point);
  });
  const faces = wedges.map((wedge, c) => wedge + shift[pointOf[rank[c]]]);
  return { faces, points: Int32Array.from(points) };
}
