// Digest of everything exact that a decoder makes (SPEC.md 5.7).
import { at, out } from "./core.mjs";

// Bytes of the state of a digest: 25 numbers, and some.
const STATE = 256;

/** Return the digest, 8 bytes, of arrays of integers, or of what are the bits of some. */
export function digestOf(core, arrays) {
  return core.withMemory((allocate) => {
    const state = at(allocate(STATE));
    core.call("dm_begin_digest", state);
    for (const array of arrays) core.call("dm_take_numbers", state, array, array.length);
    const digest = new Uint8Array(8);
    core.call("dm_end_digest", state, out(digest));
    return digest;
  });
}

/** Return the arrays of a file that its digest covers, in their order. */
export function digested({ structure, integers, order, attributes, parts, poses }) {
  const { faces, points, split, merged } = structure;
  const i = integers;
  const arrays = [faces, ...(split ? [points] : []), i.values, i.anchors, i.positions, i.isolated];
  arrays.push(i.refinements, i.corrections, i.formats, i.exponents, i.units, i.cells);
  if (order) arrays.push(order.vertices, order.polygons, order.rotations);
  if (merged.length) arrays.push(merged);
  for (const { owners, labels, codes } of attributes) {
    arrays.push(owners.ofElements, owners.has, labels, codes);
  }
  if (parts) {
    arrays.push(parts.text);
    for (const { ofFace, transforms } of parts.divisions) {
      arrays.push(ofFace);
      if (transforms) arrays.push(transforms);
    }
  }
  const encoder = new TextEncoder();
  for (const { name, step, octaves, numbers } of poses) {
    arrays.push(Int32Array.from(encoder.encode(name)), Float64Array.of(step));
    arrays.push(Int32Array.of(octaves), numbers);
  }
  return arrays;
}
