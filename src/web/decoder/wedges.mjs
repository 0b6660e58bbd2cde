// Wedges: classes of corners at a point, which are vertices there, or share a value.
import { out, place, room } from "./core.mjs";

/** Return the wedge of each corner of a complex, numbered without gaps, ascending with points. */
export function codeWedges(core, coder, corners) {
  const { opposite, bounds, ring, spoke, closing, like, kind, rank } = corners;
  const count = ring.length;
  const ranked = new Int32Array(count);
  core.call(
    "dm_code_wedges",
    ...[coder, opposite, opposite.length, bounds, bounds.length - 1],
    ...[ring, spoke, closing, like, kind, count, out(ranked), 0],
    ...[opposite.length, 0, 0, count, count].map(room),
    place(),
  );
  return rank.map((corner) => ranked[corner]);
}
