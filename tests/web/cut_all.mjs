// Cut polygons into triangles: meshes as JSON on standard input, the corners of each on output.
import { trianglesOf } from "../../src/web/decoder/triangles.mjs";

let text = "";
for await (const piece of process.stdin) text += piece;
const made = JSON.parse(text).map(({ positions, corners, offsets }) => {
  const given = [Float64Array.from(positions), Int32Array.from(corners), Int32Array.from(offsets)];
  return Array.from(trianglesOf(...given).triangleCorners);
});
console.log(JSON.stringify(made));
