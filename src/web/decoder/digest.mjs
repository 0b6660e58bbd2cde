// Digest of everything exact that a decoder makes (SPEC.md 5.7).
import { Blake2b } from "./checksums.mjs";
import { widened, wordsOf } from "./integers.mjs";

/** Return the digest of arrays of integers. */
export function digestOf(arrays) {
  const digest = new Blake2b();
  for (const array of arrays) {
    const wide = array instanceof BigInt64Array ? array : widened(array);
    digest.update(wordsOf(wide));
  }
  return digest.digest();
}

/** Return the arrays of a file that its digest covers, in their order. */
export function digested({ structure, integers, order, attributes, parts }) {
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
      if (transforms) arrays.push(new BigInt64Array(transforms.buffer.slice(0)));
    }
  }
  return arrays;
}
