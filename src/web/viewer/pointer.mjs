// What is under the pointer: the face, its nearest corner, and the error there.
import { short } from "./facts.mjs";
import { FIELDS } from "./fields.mjs";
import { cross, dot, less } from "./matrices.mjs";
import { nameOf } from "./parts.mjs";

/** Return words about the triangle of a panel that a ray from the eye meets. */
export function described(panel, triangle, eye, direction, key, original) {
  const { mesh, model } = panel;
  const corner = 3 * triangle + nearestCorner(model.corners, triangle, eye, direction);
  const vertex = mesh.triangles[corner];
  const place = [0, 1, 2].map((a) => short(mesh.positions[3 * vertex + a]));
  const polygon = mesh.trianglePolygons[triangle];
  const words = [`vertex ${vertex} (${place.join(", ")})`, `face ${polygon}`];
  for (const { kind, names, ofFace } of mesh.parts) {
    words.push(`${kind} ${nameOf(names, ofFace[polygon])}`);
  }
  const field = FIELDS[key] && panel.field(key, original);
  if (field) words.push(`${FIELDS[key].title} ${short(field[corner])} ${FIELDS[key].unit}`);
  return words.join(" · ");
}

/** Return which corner of a triangle has the largest share of where a ray meets it. */
function nearestCorner(corners, triangle, eye, direction) {
  const [a, b, c] = [0, 1, 2].map((k) => {
    const at = 3 * (3 * triangle + k);
    return [corners[at], corners[at + 1], corners[at + 2]];
  });
  const [ab, ac, from] = [less(b, a), less(c, a), less(eye, a)];
  const p = cross(direction, ac);
  const size = dot(ab, p) || 1;
  const u = dot(from, p) / size;
  const v = dot(direction, cross(from, ab)) / size;
  const shares = [1 - u - v, u, v];
  return shares.indexOf(Math.max(...shares));
}
